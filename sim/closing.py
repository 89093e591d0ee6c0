"""At which joint position is a leaf closed? Where it fills an opening of the building, in the plane of its wall."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np

from sim.leaves import Leaf
from sim.openings import fit, stands_on_floor, wall_normal
from sim.rays import Rays

_STEP = np.radians(6.0)
"""Of the search for "closed"; 3 deg beside it a leaf's edge is 5 cm out of its plane, well within the wall [rad]."""
_SLIDE_STEP = 0.02
_ALIGNED = np.radians(0.05)
"""Drawn closed is closed, whatever the last digits of a wall's normal say [rad]."""
_SLACK = np.radians(5.0)
_MEETING = 0.15
"""Two leaves whose widths leave at most this much of the way between their hinges are one double door [m]."""


@dataclass(frozen=True)
class ClosedLeaf:
    """A leaf with the joint position that closes it."""

    leaf: Leaf
    closed: float
    """Joint position [rad or m] at which the leaf fills its opening."""
    sign: float
    """+1 if growing joint positions open it, else -1."""
    reach: tuple[float, float]
    """Openings that the joint allows, counted along `sign` [rad or m]."""

    @property
    def corners(self) -> np.ndarray:
        """(4, 3) of the closed leaf in world [m]."""
        return self.leaf.corners_at(self.closed)


def close_single(model: mujoco.MjModel, rays: Rays, leaf: Leaf) -> ClosedLeaf | None:
    """The leaf at the joint position at which it alone fills an opening, if there is one."""
    natural = _natural_positions(model, leaf)
    good = _closing(rays, leaf, natural) or _closing(rays, leaf, _grid(model, leaf))
    if not good:
        return None
    closed = good[0] if good[0] in natural else good[len(good) // 2]
    if leaf.kind == "hinged":
        closed = _aligned(rays, leaf, closed)
    return _oriented(model, leaf, closed)


def _closing(rays: Rays, leaf: Leaf, values: Sequence[float]) -> list[float]:
    """Those of the joint positions at which the leaf fills an opening best, in their order."""
    scores: dict[float, float] = {}
    for value in values:
        corners = leaf.corners_at(value)
        found = fit(rays, corners)
        if found.closes and stands_on_floor(rays, corners):
            scores[value] = found.score
    return [value for value, score in scores.items() if score >= max(scores.values()) - 0.25]


def _aligned(rays: Rays, leaf: Leaf, value: float) -> float:
    """The joint position near a closing one at which the leaf is parallel to its wall [rad]."""
    corners = leaf.corners_at(value)
    normal = wall_normal(rays, corners)
    turn = _turn(rectangle_normal(corners), normal) * np.sign(leaf.axis[2]) if normal is not None else 0.0
    return value + float(turn) if abs(turn) > _ALIGNED else value


def close_pair(model: mujoco.MjModel, rays: Rays, first: Leaf, second: Leaf) -> tuple[ClosedLeaf, ClosedLeaf] | None:
    """Both leaves at the positions at which together they fill one opening, if they do."""
    if first.kind != second.kind:
        return None
    if first.kind == "sliding":
        return _close_sliding_pair(model, rays, first, second)
    between = (second.anchor - first.anchor) * [1, 1, 0]
    widths = _width(first.slab.corners_in_world) + _width(second.slab.corners_in_world)
    bottoms = abs(first.slab.corners_in_world[0, 2] - second.slab.corners_in_world[0, 2])
    if abs(np.linalg.norm(between) - widths) > _MEETING or bottoms > 0.1:
        return None
    pair = []
    for leaf, towards in ((first, between), (second, -between)):
        now = (leaf.slab.corners_in_world[1] - leaf.slab.corners_in_world[0]) * [1, 1, 0]
        pair.append(leaf.value + _turn(now, towards, half=False) * np.sign(leaf.axis[2]))
    corners = joined(first.corners_at(pair[0]), second.corners_at(pair[1]))
    if not (fit(rays, corners).closes and stands_on_floor(rays, corners)):
        return None
    normal = wall_normal(rays, corners)
    turn = _turn(rectangle_normal(corners), normal) if normal is not None else 0.0
    closed = [value + turn * np.sign(leaf.axis[2]) for value, leaf in zip(pair, (first, second), strict=True)]
    return _oriented(model, first, closed[0]), _oriented(model, second, closed[1])


def _close_sliding_pair(
    model: mujoco.MjModel, rays: Rays, first: Leaf, second: Leaf
) -> tuple[ClosedLeaf, ClosedLeaf] | None:
    for a in _natural_positions(model, first):
        for b in _natural_positions(model, second):
            one, other = first.corners_at(a), second.corners_at(b)
            meeting = min(np.linalg.norm(one[i, :2] - other[j, :2]) for i in (0, 1) for j in (0, 1))
            corners = joined(one, other)
            if meeting < _MEETING and fit(rays, corners).closes and stands_on_floor(rays, corners):
                return _oriented(model, first, a), _oriented(model, second, b)
    return None


def _natural_positions(model: mujoco.MjModel, leaf: Leaf) -> list[float]:
    """Where a user would put "closed": as drawn, at an end of the range, as it stands."""
    drawn = float(model.qpos0[model.jnt_qposadr[leaf.joint]])
    ends = model.jnt_range[leaf.joint].tolist() if model.jnt_limited[leaf.joint] else []
    return [drawn, *ends, leaf.value]


def _grid(model: mujoco.MjModel, leaf: Leaf) -> list[float]:
    """Joint positions all over the range, for leaves that nobody drew closed."""
    full, step, slack = (np.pi, _STEP, _SLACK) if leaf.kind == "hinged" else (2.0, _SLIDE_STEP, 0.0)
    low, high = leaf.value - full, leaf.value + full
    if model.jnt_limited[leaf.joint] and np.ptp(model.jnt_range[leaf.joint]) < 2 * full:
        low, high = model.jnt_range[leaf.joint] + [-slack, slack]
    return np.arange(low, high, step).tolist()


def _oriented(model: mujoco.MjModel, leaf: Leaf, closed: float) -> ClosedLeaf:
    """Add which way the leaf opens, and how far, from the joint's range."""
    full = np.pi if leaf.kind == "hinged" else 2.0
    low, high = (-full, full)
    if model.jnt_limited[leaf.joint]:
        low, high = np.clip(model.jnt_range[leaf.joint] - closed, -full, full)
    slack = _SLACK if leaf.kind == "hinged" else 0.05
    if high <= slack and -low > high:
        return ClosedLeaf(leaf, closed, -1.0, (max(float(-high), 0.0), float(-low)))
    return ClosedLeaf(leaf, closed, 1.0, (float(low) if low < -slack else max(float(low), 0.0), float(high)))


def joined(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """The upright rectangle (4, 3) over two leaves in one plane, from the first one's outer edge to the other's."""
    ends = max(((one[i], other[j]) for i in (0, 1) for j in (0, 1)), key=lambda pair: np.linalg.norm(pair[0] - pair[1]))
    bottom, top = min(one[0, 2], other[0, 2]), max(one[3, 2], other[3, 2])
    return np.array([[*ends[k][:2], z] for k, z in ((0, bottom), (1, bottom), (1, top), (0, top))])


def rectangle_normal(corners: np.ndarray) -> np.ndarray:
    normal = np.cross(corners[1] - corners[0], corners[3] - corners[0]) * [1, 1, 0]
    return normal / np.linalg.norm(normal)


def _turn(start: np.ndarray, end: np.ndarray, *, half: bool = True) -> float:
    """Signed angle about the vertical from one direction to another [rad]; `half` takes opposite normals as one."""
    angle = np.arctan2(start[0] * end[1] - start[1] * end[0], start[0] * end[0] + start[1] * end[1])
    return float((angle + np.pi / 2) % np.pi - np.pi / 2) if half else float(angle)


def _width(corners: np.ndarray) -> float:
    return float(np.linalg.norm(corners[1] - corners[0]))
