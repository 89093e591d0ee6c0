"""Wall rectangles of a room: which stretches of the lines in plan are walls, and from where to where they go."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from mission.errors import MissionError
from mission.plan_lines import Columns, LineParameters, PlanLine, columns_of, find_lines
from mission.plan_polygon import OPEN, Loop, Segment, covered_share, crossed, room_loops
from mission.roof import Roof
from mission.visibility import Visibility
from mission.wall_layers import on_one_line, set_back
from sim.parameters import Parameters

Floats = NDArray[np.float64]

_NEAR = 0.02
"""A wall that ends this near to a corner ends there [m]."""

_BEFORE = 0.3
"""Overhead is looked this far before a wall: clear of the lintels in it [m]."""


class WallParameters(Parameters):
    """What a wall is, and where it goes on unseen."""

    min_top: float = Field(default=1.8, ge=0.5, le=20, description="a wall without a ceiling is at least this high [m]")
    doorway: float = Field(default=1.5, ge=0, le=10, description="a gap in a wall up to this wide is bridged [m]")
    hidden_gap: float = Field(
        default=4.0, ge=0, le=50, description="bridged up to this if nobody looked through it [m]"
    )
    min_lintel_height: float = Field(
        default=1.8, ge=0.5, le=20, description="above the floor: lower it hangs on a wall [m]"
    )
    min_own_top: float = Field(
        default=2.0, ge=0.1, le=20, description="length of a low wall under the sky, no leaf's [m]"
    )
    min_roof_area: float = Field(
        default=1.0, gt=0, le=100, description="area of what a wall may end under, if lower [m2]"
    )
    max_lintel_width: float = Field(default=2.5, ge=0.5, le=20, description="over a doorway: wider it is a beam [m]")
    lines: LineParameters = Field(default_factory=LineParameters)


@dataclass(frozen=True, eq=False)
class WallRectangle:
    """A wall as seen by somebody who stands in the room and faces it; see `detector.room.Wall`."""

    origin: Floats
    """(3,) bottom left corner in the world [m]."""
    u: Floats
    """(3,) unit vector to the right, horizontal."""
    v: Floats
    """(3,) unit vector up; u x v points into the room."""
    width: float
    """Along u [m]."""
    height: float
    """Along v [m]."""

    @property
    def normal(self) -> Floats:
        """(3,) unit vector into the room."""
        return np.cross(self.u, self.v)


@dataclass(frozen=True, eq=False)
class Outline:
    """The room in plan."""

    walls: tuple[WallRectangle, ...]
    loops: tuple[Loop, ...]
    """The outer one first; their `lines` are indices into `walls`, OPEN where there is no wall."""


class WallFinder:
    """From points to the walls round the room, for one or another ceiling.

    Args:
        points: (N, 3) of all scans, evenly spread [m].
        normals: (N, 3) towards the scanners; NaN where the surface is not flat.
        floor: World z of the floor [m].
        visibility: What the scans looked through.
        parameters: What a wall is.
    """

    def __init__(
        self, points: Floats, normals: Floats, floor: float, visibility: Visibility, parameters: WallParameters
    ) -> None:
        self.points, self.normals, self.floor = points, normals, floor
        self.visibility, self.parameters = visibility, parameters
        self.scanners = np.array([scan.scanner_in_world[:2] for scan in visibility.scans])
        vertical = (np.abs(normals[:, 2]) < 0.15) & (points[:, 2] > floor + 0.1)
        self.roof = Roof(points, normals, lowest=floor + parameters.min_top, least_area=parameters.min_roof_area)
        plan, facing = (np.ascontiguousarray(rows[vertical, :2]) for rows in (points, normals))
        self.lines = find_lines(plan, facing, parameters.lines)

    def outline(self, ceiling: float | None) -> Outline:
        """The room under a ceiling [m], or under the sky.

        Raises:
            MissionError: Nothing is wall.
        """
        heights = (self.floor + 0.03, np.inf if ceiling is None else ceiling - 0.03)
        surfaces = [columns_of(line, self.points, self.normals, heights, self.parameters.lines) for line in self.lines]
        top = ceiling if ceiling is not None else _common_top(surfaces, self.floor + self.parameters.min_top)
        ends = [top if ceiling is not None else self._own_top(columns, top) for columns in surfaces]
        reaching = [self._reaching(line, s, t) for line, s, t in zip(self.lines, surfaces, ends, strict=True)]
        reaching = set_back(self.lines, on_one_line(self.lines, reaching, self.parameters.lines), self.parameters.lines)
        seen = self._seen_first(reaching, self._segments(reaching, top))
        segments = self._segments(seen, top)
        if not segments:
            raise MissionError("no wall found round the scanner")
        walls: list[WallRectangle] = []
        loops = []
        for loop in room_loops(self.lines, segments, self.scanners):
            pieces = [piece for k in range(len(loop.lines)) for piece in self._pieces(loop, k, segments, seen, top)]
            numbers = np.full(len(pieces), OPEN)
            for k, (line, a, b) in enumerate(pieces):
                if line != OPEN:
                    numbers[k] = len(walls)
                    height = top if ceiling is not None else _top_between(seen[line], self.lines[line], a, b, top)
                    walls.append(self._rectangle(self.lines[line], a, b, height))
            loops.append(Loop(np.array([a for _, a, _ in pieces]), numbers))
        if not walls:
            raise MissionError("no wall found round the scanner")
        return Outline(tuple(walls), tuple(loops))

    def _own_top(self, columns: Columns, usual: float) -> float:
        """Where the walls on a line end that no ceiling ends, if enough of them end there, and lower than usual [m]."""
        least = self.parameters.min_own_top / self.parameters.lines.column
        tops = columns.tops[(columns.tops > self.floor + self.parameters.min_top) & ~columns.recessed]
        common = [top for top in tops if np.count_nonzero(np.abs(tops - top) < 0.05) > least]
        return float(min(max(common, default=usual), usual))

    def _reaching(self, line: PlanLine, columns: Columns, top: float) -> Columns:
        """Columns that may be wall: up to the top or the roof over them, with nothing like them close behind, and
        nothing free under them but what may be a doorway; so a beam or a hanging cupboard is none."""
        columns = columns.chosen((columns.rows >= 2) & ~columns.recessed)
        before = line.at((columns.numbers + 0.5) * self.parameters.lines.column) + _BEFORE * line.normal
        tops = np.minimum(self.roof.height_over(before), top)
        columns = columns.chosen(columns.tops > tops - self.parameters.lines.top_band)
        hanging = self._free_below(line, columns)
        lintel = hanging & (columns.bottoms > self.floor + self.parameters.min_lintel_height)
        widest = self.parameters.max_lintel_width / self.parameters.lines.column
        between_walls = np.cumsum(~lintel)[lintel]  # a column that is missing does not hold a lintel
        for run in np.split(np.flatnonzero(lintel), np.flatnonzero(np.diff(between_walls)) + 1):
            lintel[run] = len(run) == 0 or np.ptp(columns.numbers[run]) < widest
        return columns.chosen(~hanging | lintel)

    def _free_below(self, line: PlanLine, columns: Columns) -> NDArray[np.bool_]:
        """Columns (K,) that end well above the floor, and some scan looked through under them."""
        free = columns.bottoms > self.floor + 0.6
        plan = line.at((columns.lows[free] + columns.highs[free]) / 2)
        places = np.column_stack([plan, (self.floor + columns.bottoms[free]) / 2])
        free[free] = self.visibility.looked_through(places, _upright(line, places), behind=0.04).any(axis=0)
        return free

    def _segments(self, surfaces: Sequence[Columns], top: float) -> list[Segment]:
        """Stretches of columns, with the gaps bridged that doors, windows and furniture may make."""
        least = int(round(self.parameters.lines.min_length / self.parameters.lines.column))
        found = []
        for number, columns in enumerate(surfaces):
            runs = _runs(columns, partial(self._goes_on, number, top))
            found += [
                Segment(number, columns.lows[run[0]], columns.highs[run[-1]]) for run in runs if len(run) >= least
            ]
        return found

    def _goes_on(self, number: int, top: float, start: float, end: float) -> bool:
        """Whether the wall on a line goes on unseen from one place to another: a gap that a doorway may make, or one
        that nobody looked through under the ceiling."""
        if end - start <= self.parameters.doorway:
            return True
        if end - start > self.parameters.hidden_gap:
            return False
        line = self.lines[number]
        plan = line.at(np.arange(start + 0.05, end, 0.1))
        places = np.column_stack([plan, np.full(len(plan), top - 0.15)])
        passed = self.visibility.looked_through(places, _upright(line, places), behind=0.1)
        return bool(passed.any(axis=0).mean() < 0.5)

    def _seen_first(self, surfaces: Sequence[Columns], segments: Sequence[Segment]) -> list[Columns]:
        """The columns that some scanner in front of them sees with no wall between, in plan."""
        width = self.parameters.lines.column
        barriers = np.array([self.lines[s.line].at(np.array([s.start, s.end])) for s in segments]).reshape(-1, 2, 2)
        seen = []
        for line, columns in zip(self.lines, surfaces, strict=True):
            spots = line.at((columns.numbers + 0.5) * width) + 0.05 * line.normal
            free = np.zeros(len(spots), bool)
            for scanner in self.scanners:
                if line.depth(scanner[None])[0] > 0:
                    free |= ~crossed(spots, scanner, barriers)
            seen.append(columns.chosen(free))
        return seen

    def _pieces(
        self, loop: Loop, edge: int, segments: Sequence[Segment], seen: Sequence[Columns], top: float
    ) -> list[tuple[int, Floats, Floats]]:
        """An edge of the room's polygon cut where its wall ends in the open: (line or OPEN, from, to).

        Towards a corner with another wall it goes on over what may be hidden; towards the open it ends where it ends.
        """
        edges = loop.edges()
        number, a, b = edges[edge]
        if number == OPEN:
            return [edges[edge]]
        cornered = [edges[k % len(edges)][0] != OPEN for k in (edge - 1, edge + 1)]
        line = self.lines[number]
        low, high = line.along(np.array([a, b]))  # the tangent runs along the edge: the room is on the left of both
        cuts: list[float] = []
        for s in sorted((s for s in segments if s.line == number), key=lambda s: s.start):
            start, end = max(s.start, low), min(s.end, high)
            if start < end:
                cuts += [] if not cuts and cornered[0] and self._goes_on(number, top, low, start) else [start]
                cuts += [end]
        if cuts and cornered[1] and self._goes_on(number, top, cuts[-1], high):
            cuts.pop()
        inner = [a, *line.at(np.array([c for c in cuts if low + _NEAR < c < high - _NEAR])), b]
        return [
            (number if self._is_wall(number, p, q, seen[number]) else OPEN, p, q)
            for p, q in zip(inner[:-1], inner[1:], strict=True)
        ]

    def _is_wall(self, number: int, a: Floats, b: Floats, columns: Columns) -> bool:
        """Whether enough of it was seen; the rest may be hidden."""
        pieces = [Segment(number, low, high) for low, high in zip(columns.lows, columns.highs, strict=True)]
        length, least = float(np.hypot(*(b - a))), self.parameters.lines.min_length
        return length >= least and covered_share(self.lines[number], a, b, pieces) * length > 0.5 * least

    def _rectangle(self, line: PlanLine, a: Floats, b: Floats, top: float) -> WallRectangle:
        """The wall from a to b, the room on the left: seen from inside b is its left end.

        Under a roof that is lower than the top from end to end it ends there.
        """
        length = float(np.hypot(*(b - a)))
        under = self.roof.height_over(np.linspace(a, b, 2 + int(length / 0.1)) + _BEFORE * line.normal).max()
        if under < top - self.parameters.lines.top_band:
            top = float(under)
        return WallRectangle(
            origin=np.array([b[0], b[1], self.floor]),
            u=np.array([-line.tangent[0], -line.tangent[1], 0.0]),
            v=np.array([0.0, 0.0, 1.0]),
            width=length,
            height=float(top - self.floor),
        )


def _upright(line: PlanLine, places: Floats) -> Floats:
    """The line's normal (M, 3), once for each place."""
    return np.broadcast_to([line.normal[0], line.normal[1], 0.0], places.shape)


def _runs(columns: Columns, goes_on: Callable[[float, float], bool]) -> list[NDArray[np.int_]]:
    """Runs of indices of columns, across the gaps where the wall goes on."""
    if len(columns.numbers) == 0:
        return []
    gaps = np.flatnonzero(np.diff(columns.numbers) > 1)
    ends = [k + 1 for k in gaps if not goes_on(columns.highs[k], columns.lows[k + 1])]
    return np.split(np.arange(len(columns.numbers)), ends)


def _common_top(surfaces: Sequence[Columns], least: float) -> float:
    """Where walls without a ceiling end: the highest level at which a fair share of all columns ends [m]."""
    tops = np.sort(np.concatenate([columns.tops for columns in surfaces] or [np.zeros(0)]))
    tops = tops[tops > least]
    if len(tops) == 0:
        return least
    share = np.array([np.count_nonzero(np.abs(tops - top) < 0.05) for top in tops]) / len(tops)
    return float(tops[share >= 0.25][-1]) if np.any(share >= 0.25) else float(np.median(tops))


def _top_between(columns: Columns, line: PlanLine, a: Floats, b: Floats, usual: float) -> float:
    """Upper edge of a wall from a to b that no ceiling ends [m]."""
    low, high = sorted(line.along(np.array([a, b])))
    tops = columns.tops[(columns.highs > low) & (columns.lows < high)]
    return float(np.percentile(tops, 90)) if len(tops) else usual
