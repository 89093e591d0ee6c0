"""Does a rectangle fill an opening of the building? Asked of the static geometry alone, with rays."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim.rays import Rays

_PASSAGE = 0.75
"""Free way needed on both sides of a doorway; the back of a wardrobe is nearer to any turn of its door [m]."""
_WALL_DEPTH = 0.35
"""A leaf lies at most this far from the faces of its wall [m]."""
_BESIDE = (0.03, 0.08, 0.15)
"""Where beside a closed leaf to look for frame or wall [m]."""
_SHARES = (0.2, 0.5, 0.8)
_SILL = 0.3
"""The floor is at most this far below a door; below a tall window it is farther [m]."""
_APPROACH = 0.45
"""Where in front of a door to look for the floor: clear of the sill of a window [m]."""


@dataclass(frozen=True)
class Fit:
    """How well a rectangle fills an opening."""

    passage: float
    """Share of the rays through the rectangle that are free on both sides."""
    sides: tuple[float, float]
    """Shares of the heights at which something solid stands beside the rectangle's first and second edge."""
    lintel: float
    """Share of the width over which something solid is above."""

    @property
    def closes(self) -> bool:
        """Whether the rectangle is a door's leaf in its doorway."""
        return self.passage >= 0.5 and min(self.sides) >= 0.5

    @property
    def score(self) -> float:
        """Grows with the fit; for comparing rectangles that close something."""
        return self.passage + sum(self.sides) + self.lintel


def fit(rays: Rays, corners: np.ndarray) -> Fit:
    """Judge a rectangle (4, 3) in world (first edge bottom, second edge bottom, second top, first top)."""
    along, up, normal = _axes(corners)
    width, height = _size(corners)
    sides = [0.0, 0.0]
    for side, outward in ((1, along), (0, -along)):
        edge = [_solid_beside(rays, corners[side] + share * height * up, outward, normal) for share in _SHARES]
        sides[side] = float(np.mean(edge))
        if sides[side] < 0.5:
            return Fit(0.0, (sides[0], sides[1]), 0.0)
    top = [_solid_beside(rays, corners[3] + share * width * along, up, normal) for share in _SHARES]
    through = [
        _passable(rays, corners[0] + a * width * along + b * height * up, normal) for a in _SHARES for b in _SHARES
    ]
    return Fit(float(np.mean(through)), (sides[0], sides[1]), float(np.mean(top)))


def stands_on_floor(rays: Rays, corners: np.ndarray) -> bool:
    """Whether a floor lies little below a rectangle (4, 3) in world on either side of it, as none does at a window."""
    middle = (corners[0] + corners[1]) / 2 + [0, 0, 0.02]
    normal = _axes(corners)[2]
    return any(rays.floor_below(middle + way * normal, _SILL) is not None for way in (_APPROACH, -_APPROACH))


def wall_normal(rays: Rays, corners: np.ndarray) -> np.ndarray | None:
    """Horizontal unit normal (3,) of the wall that a rectangle (4, 3) lies in roughly; None if no wall face is met."""
    along, up, normal = _axes(corners)
    found = []
    for start, sign in ((0, -1), (1, 1)):
        for beside in (0.12, 0.2, 0.3):
            for share in _SHARES:
                point = corners[start] + sign * beside * along + share * (corners[3] - corners[0])
                found += _face_normals(rays, point, normal)
    if not found:
        return None
    mean = np.median(found, axis=0) * [1, 1, 0]
    return mean / np.linalg.norm(mean)


def _axes(corners: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    along = (corners[1] - corners[0]) / np.linalg.norm(corners[1] - corners[0])
    up = (corners[3] - corners[0]) / np.linalg.norm(corners[3] - corners[0])
    return along, up, np.cross(along, up)


def _size(corners: np.ndarray) -> tuple[float, float]:
    return float(np.linalg.norm(corners[1] - corners[0])), float(np.linalg.norm(corners[3] - corners[0]))


def _solid_beside(rays: Rays, point: np.ndarray, outward: np.ndarray, normal: np.ndarray) -> bool:
    """Whether frame or wall crosses the rectangle's plane just outside a point of its edge."""
    return any(bool(_face_normals(rays, point + beside * outward, normal)) for beside in _BESIDE)


def _face_normals(rays: Rays, point: np.ndarray, normal: np.ndarray) -> list[np.ndarray]:
    """Normals, turned towards `normal`, of the faces met when passing a point of the plane from both sides."""
    found = []
    for sign in (1.0, -1.0):
        hits = rays.cast(point + sign * _WALL_DEPTH * normal, -sign * normal[None], 2 * _WALL_DEPTH)
        facing = float(hits.normals[0] @ normal)
        if np.isfinite(hits.distances[0]) and abs(facing) > 0.7:
            found.append(hits.normals[0] * np.sign(facing))
    return found


def _passable(rays: Rays, point: np.ndarray, normal: np.ndarray) -> bool:
    return not np.isfinite(rays.cast(point, np.array([normal, -normal]), _PASSAGE).distances).any()
