"""The room's polygon: which cells of the plane, as the walls' lines divide it, the walls wind round."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from mission.plan_lines import PlanLine

Floats = NDArray[np.float64]

OPEN = -1
"""On an edge of the room where no wall is."""
_MARGIN = 1.0
"""The plane ends this far beyond all walls and scanners [m]."""


@dataclass(frozen=True)
class Segment:
    """A stretch of a line that is wall."""

    line: int
    """Index of the line."""
    start: float
    """Along the line's tangent [m]."""
    end: float
    """Along the line's tangent [m]."""


@dataclass(frozen=True, eq=False)
class Loop:
    """A closed polygon with the room on its left."""

    vertices: Floats
    """(P, 2) [m]."""
    lines: NDArray[np.int_]
    """(P,) the line that the edge from vertex p to p + 1 lies on; OPEN for none."""

    @property
    def area(self) -> float:
        """Positive where it encloses the room, negative round a hole in it [m2]."""
        x, y = self.vertices.T
        return float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y)) / 2

    def edges(self) -> list[tuple[int, Floats, Floats]]:
        """Line, start and end of each edge."""
        following = np.roll(self.vertices, -1, axis=0)
        return [(int(n), a, b) for n, a, b in zip(self.lines, self.vertices, following, strict=True)]


@dataclass(frozen=True, eq=False)
class _Cell:
    """A convex piece of the plane, counter-clockwise."""

    vertices: Floats
    lines: tuple[int, ...]

    @property
    def centre(self) -> Floats:
        return self.vertices.mean(axis=0)

    def contains(self, point: Floats) -> bool:
        a, b = self.vertices, np.roll(self.vertices, -1, axis=0)
        return bool(np.all(_cross(b - a, point - a) >= -1e-9))


def within_polygon(points: NDArray[np.floating], polygon: Floats) -> NDArray[np.bool_]:
    """(N,) which points (N, 2 or 3) lie within a polygon (P, 2) in plan: a ray along +x crosses its edges an odd number
    of times."""
    inside = np.zeros(len(points), bool)
    x, y = points[:, 0], points[:, 1]
    for (ax, ay), (bx, by) in zip(polygon, np.roll(polygon, -1, axis=0), strict=True):
        if ay != by:
            inside ^= ((ay > y) != (by > y)) & (x < ax + (y - ay) * ((bx - ax) / (by - ay)))
    return inside


def room_loops(lines: Sequence[PlanLine], segments: Sequence[Segment], scanners: Floats) -> list[Loop]:
    """Find the outline of the room that the scanners (S, 2) stand in; the outer loop comes first, then its holes.

    The lines cut the plane into cells. A cell is inside if the wall segments wind round its centre by more than half a
    turn (generalised winding number, Jacobson et al., SIGGRAPH 2013): 1 in a closed room, 0 outside; where a wall is
    missing exactly 1/2 on the straight closing line between its neighbours' ends, which is tried as a further line.
    """
    ends = np.array([lines[s.line].at(np.array([s.start, s.end])) for s in segments]).reshape(-1, 2, 2)
    cuts = [(lines[k].normal, lines[k].offset, k) for k in sorted({s.line for s in segments})]
    around = np.concatenate([ends.reshape(-1, 2), scanners])
    border = _rectangle(around.min(axis=0) - _MARGIN, around.max(axis=0) + _MARGIN)
    cells, inside = _labelled(border, cuts, lines, segments, ends, scanners)
    if any(inside[k] and _BORDER in cell.lines for k, cell in enumerate(cells)):
        cuts = cuts + _closing_lines(ends)
        cells, inside = _labelled(border, cuts, lines, segments, ends, scanners)
    loops = _outlines([cell for k, cell in enumerate(cells) if inside[k]])
    return sorted(loops, key=lambda loop: -loop.area)


_BORDER = -2


def _cross(a: Floats, b: Floats) -> Floats:
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def _rectangle(low: Floats, high: Floats) -> _Cell:
    corners = np.array([[low[0], low[1]], [high[0], low[1]], [high[0], high[1]], [low[0], high[1]]])
    return _Cell(corners, (_BORDER,) * 4)


def _labelled(
    border: _Cell,
    cuts: Sequence[tuple[Floats, float, int]],
    lines: Sequence[PlanLine],
    segments: Sequence[Segment],
    ends: Floats,
    scanners: Floats,
) -> tuple[list[_Cell], list[bool]]:
    cells = [border]
    for normal, offset, line in cuts:
        cells = [piece for cell in cells for piece in _split(cell, normal, offset, line)]
    standing = [any(cell.contains(s) for s in scanners) for cell in cells]
    wound = winding_numbers(np.array([cell.centre for cell in cells]), ends) > 0.5
    candidates = [bool(w or s) for w, s in zip(wound, standing, strict=True)]
    return cells, _connected(cells, candidates, standing, lines, segments)


def winding_numbers(points: Floats, ends: Floats) -> Floats:
    """(M,) turns that segments (J, 2, 2) make round points (M, 2), counter-clockwise positive."""
    a, b = ends[None, :, 0] - points[:, None], ends[None, :, 1] - points[:, None]
    return np.sum(np.arctan2(_cross(a, b), np.sum(a * b, axis=-1)), axis=1) / (2 * np.pi)


def _split(cell: _Cell, normal: Floats, offset: float, line: int) -> list[_Cell]:
    side = cell.vertices @ normal - offset
    side[np.abs(side) < 1e-6] = 0
    if side.min() >= 0 or side.max() <= 0:
        return [cell]
    return [_clipped(cell, side, line), _clipped(cell, -side, line)]


def _clipped(cell: _Cell, side: Floats, line: int) -> _Cell:
    vertices, lines = [], []
    for k, (vertex, here) in enumerate(zip(cell.vertices, side, strict=True)):
        following = (k + 1) % len(side)
        there = side[following]
        if here >= 0:
            vertices.append(vertex)
            lines.append(line if here == 0 and there < 0 else cell.lines[k])
        if here * there < 0:
            vertices.append(vertex + (cell.vertices[following] - vertex) * (here / (here - there)))
            lines.append(line if here > 0 else cell.lines[k])
    return _Cell(np.array(vertices), tuple(lines))


def _key(point: Floats) -> tuple[int, int]:
    return int(round(point[0] * 1e4)), int(round(point[1] * 1e4))


def _edges(cell: _Cell) -> list[tuple[Floats, Floats, int]]:
    following = np.roll(cell.vertices, -1, axis=0)
    return list(zip(cell.vertices, following, cell.lines, strict=True))


def _connected(
    cells: Sequence[_Cell],
    candidates: Sequence[bool],
    seeds: Sequence[bool],
    lines: Sequence[PlanLine],
    segments: Sequence[Segment],
) -> list[bool]:
    """Candidates that can be reached from the seeds without passing a wall."""
    sharing: dict[tuple[int, int], list[int]] = {}
    for k, cell in enumerate(cells):
        for a, b, _ in _edges(cell):
            sharing.setdefault(_key((a + b) / 2), []).append(k)
    reached = list(seeds)
    queue = [k for k, seed in enumerate(seeds) if seed]
    while queue:
        k = queue.pop()
        for a, b, line in _edges(cells[k]):
            if line >= 0 and covered_share(lines[line], a, b, [s for s in segments if s.line == line]) > 0.5:
                continue
            for other in sharing[_key((a + b) / 2)]:
                if candidates[other] and not reached[other]:
                    reached[other] = True
                    queue.append(other)
    return reached


def covered_share(line: PlanLine, a: Floats, b: Floats, segments: Sequence[Segment]) -> float:
    """Share of the stretch of a line from point a to b that segments of it cover."""
    low, high = sorted(line.along(np.array([a, b])))
    covered = sum(max(0.0, min(high, s.end) - max(low, s.start)) for s in segments)
    return covered / max(high - low, 1e-9)


def _closing_lines(ends: Floats) -> list[tuple[Floats, float, int]]:
    """Lines through pairs of wall ends at which no other wall begins."""
    tips = []
    for k, segment in enumerate(ends):
        others = np.delete(ends, k, axis=0)
        tips += [tip for tip in segment if len(others) == 0 or _distances(tip, others).min() > 0.7]
    cuts = []
    for a, b in combinations(tips[:8], 2):
        along = b - a
        length = float(np.hypot(*along))
        if length > 0.1:
            normal = np.array([-along[1], along[0]]) / length
            cuts.append((normal, float(normal @ a), OPEN))
    return cuts


def _distances(point: Floats, ends: Floats) -> Floats:
    """(J,) distance of a point from segments (J, 2, 2) [m]."""
    along = ends[:, 1] - ends[:, 0]
    share = np.sum((point - ends[:, 0]) * along, axis=1) / np.maximum(np.sum(along**2, axis=1), 1e-12)
    nearest = ends[:, 0] + np.clip(share, 0, 1)[:, None] * along
    return np.hypot(*(point - nearest).T)


def crossed(points: Floats, origin: Floats, barriers: Floats) -> NDArray[np.bool_]:
    """(M,) True where the way from an origin (2,) to a point (M, 2) crosses one of the segments (J, 2, 2)."""
    a, along = barriers[None, :, 0], barriers[None, :, 1] - barriers[None, :, 0]
    way = (points - origin)[:, None]
    on_sides = _cross(way, a - origin) * _cross(way, a + along - origin) < 0
    about = _cross(along, origin - a) * _cross(along, points[:, None] - a) < 0
    return np.any(on_sides & about, axis=1)


def _outlines(cells: Sequence[_Cell]) -> list[Loop]:
    """Loops of the edges that only one of the cells has."""
    count: dict[tuple[int, int], int] = {}
    for cell in cells:
        for a, b, _ in _edges(cell):
            count[_key((a + b) / 2)] = count.get(_key((a + b) / 2), 0) + 1
    following: dict[tuple[int, int], list[tuple[Floats, Floats, int]]] = {}
    for cell in cells:
        for a, b, line in _edges(cell):
            if count[_key((a + b) / 2)] == 1:
                following.setdefault(_key(a), []).append((a, b, line))
    loops = []
    while following:
        at = start = min(following, key=lambda k: (10 * k[0] + k[1], k))  # the same corner from scan to scan
        edges = []
        while at in following:
            edges.append(following[at].pop())
            if not following[at]:
                del following[at]
            at = _key(edges[-1][1])
            if at == start:
                break
        loops.append(_merged(edges))
    return loops


def _merged(edges: Sequence[tuple[Floats, Floats, int]]) -> Loop:
    """A loop whose neighbouring edges on the same line are one."""
    corners = []
    for k, (a, b, line) in enumerate(edges):
        before_a, before_b, before = edges[k - 1]
        straight = abs(_cross((before_b - before_a), (b - a))) < 1e-4 * np.hypot(*(b - a)) * np.hypot(
            *(before_b - before_a)
        )
        same = before == line or (before < 0 and line < 0)
        if not (same and straight):
            corners.append((a, max(line, OPEN)))
    return Loop(np.array([a for a, _ in corners]), np.array([line for _, line in corners]))
