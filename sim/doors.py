"""The truth about a scene's doors: leaves, the openings that they fill, and how far they stand open."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Literal

import mujoco
import numpy as np

from sim.errors import SimError
from sim.leaves import Leaf, find_leaves
from sim.openings import fit, stands_on_floor, wall_normal
from sim.rays import Rays

_STEP = np.radians(2.0)
_SLIDE_STEP = 0.02
_CLEARLY_OPEN = np.radians(1.0)
_ALIGNED = np.radians(0.05)
"""Drawn closed is closed, whatever the last digits of a wall's normal say [rad]."""
_SLACK = np.radians(5.0)
_MEETING = 0.15
"""Two leaves whose widths leave at most this much of the way between their hinges are one double door [m]."""
_WEDGE = 15.0
"""Friction that keeps a leaf where it was put, against springs and leaning hinges [N m or N]."""


@dataclass(frozen=True)
class LeafTruth:
    """One leaf as it stands now."""

    name: str
    """Of the body, else of the joint."""
    joint_name: str
    hinge_in_world: np.ndarray
    """(2, 3) bottom and top of the hinge's axis at the leaf's edges [m]; for a slide, its first edge."""
    opening_angle: float
    """From closed [rad], at least 0; NaN for a sliding leaf."""
    opening: float
    """Way from closed [m], at least 0; NaN for a hinged leaf."""
    swing_normal: np.ndarray
    """(3,) horizontal unit vector towards which the free edge leaves the closed leaf's plane; for a slide, the way."""
    corners_in_world: np.ndarray
    """(4, 3) mid-plane of the leaf now: hinge bottom, free bottom, free top, hinge top [m]."""
    angle_range: tuple[float, float]
    """Openings that the joint allows [rad; m for a slide]; the lower is negative if it swings to both sides."""


@dataclass(frozen=True)
class DoorTruth:
    """One doorway with its leaf or its two leaves."""

    name: str
    """The leaf's name; of a double door, both joined with `+`."""
    kind: Literal["hinged", "sliding"]
    leaf_names: tuple[str, ...]
    corners_in_world: np.ndarray
    """(4, 3) rectangle on the mid-plane that the closed leaves fill: bottom left, bottom right, top right, top left,
    seen from the side that `normal` points to [m]."""
    normal: np.ndarray
    """(3,) horizontal unit normal of the closed leaf, towards the side to which the (first) leaf opens."""
    leaves: tuple[LeafTruth, ...]


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


@dataclass(frozen=True)
class Door:
    """A doorway and what closes it; what does not change while the doors move."""

    leaves: tuple[ClosedLeaf, ...]

    @property
    def name(self) -> str:
        return "+".join(one.leaf.name for one in self.leaves)


def true_doors(model: mujoco.MjModel, data: mujoco.MjData) -> tuple[DoorTruth, ...]:
    """All doors of a scene as they stand now; see `find_doors` for what a door is."""
    return tuple(measure_door(model, data, door) for door in find_doors(model, data))


def find_doors(model: mujoco.MjModel, data: mujoco.MjData) -> tuple[Door, ...]:
    """Finds the doors of any scene from its geometry; names and joint zeros mean nothing.

    A leaf is a slab of a door's size (see `sim.leaves`). It is a door's if at some joint position it stands on the floor
    in an opening of the static geometry that is passable behind it: that position is "closed". A refrigerator's or a
    wardrobe's door closes nothing that leads anywhere. Two leaves that fill an opening only together are a double door.

    Args:
        model: the compiled scene, with or without the robot.
        data: its state, positions up to date.
    """
    moving = frozenset(np.flatnonzero(model.body_weldid != 0).tolist())
    rays = Rays(model, data, moving)
    leaves = find_leaves(model, data)
    doors: list[Door] = []
    paired: set[int] = set()
    for first, second in combinations(leaves, 2):
        if not paired & {first.joint, second.joint} and (pair := _close_pair(model, rays, first, second)):
            doors.append(Door(pair))
            paired |= {first.joint, second.joint}
    for leaf in leaves:
        if leaf.joint not in paired and (single := _close_single(model, rays, leaf)):
            doors.append(Door((single,)))
    return tuple(sorted(doors, key=lambda door: door.leaves[0].leaf.joint))


def measure_door(model: mujoco.MjModel, data: mujoco.MjData, door: Door) -> DoorTruth:
    """The truth about one door from the joints' present positions."""
    leaves = tuple(_measure_leaf(model, data, one) for one in door.leaves)
    first = door.leaves[0]
    normal = _opening_direction(first) if first.leaf.kind == "hinged" else _normal(first.corners)
    corners = first.corners if len(door.leaves) == 1 else _joined(first.corners, door.leaves[1].corners)
    right = np.cross([0, 0, 1.0], normal)
    if (corners[1] - corners[0]) @ right < 0:
        corners = corners[[1, 0, 3, 2]]
    return DoorTruth(door.name, first.leaf.kind, tuple(leaf.name for leaf in leaves), corners, normal, leaves)


def put_doors(model: mujoco.MjModel, data: mujoco.MjData, doors: Sequence[Door], openings: Mapping[str, float]) -> None:
    """Opens doors as asked and wedges all of them where they then stand.

    A wedge is friction in the joint, a spring at rest and a servo that holds: a scan takes a minute, and what it saw must
    still be so in the next one. The robot can push a wedged leaf aside.

    Args:
        model: friction and springs of the leaves' joints are changed in it.
        data: positions are set in it, and what follows from them is updated.
        doors: as found by `find_doors`.
        openings: opening from closed [rad], by the name of a leaf's body or joint, or of a double door for both leaves.

    Raises:
        SimError: there is no such door, it slides, or its joint does not go that far.
    """
    for name, opening in openings.items():
        for one in _named(doors, name):
            _require_reach(one, name, opening)
            data.qpos[model.jnt_qposadr[one.leaf.joint]] = one.closed + one.sign * opening
    data.qvel[:] = 0.0
    for door in doors:
        for one in door.leaves:
            _wedge(model, data, one.leaf.joint)
    mujoco.mj_forward(model, data)


def _named(doors: Sequence[Door], name: str) -> list[ClosedLeaf]:
    leaves = [one for door in doors for one in door.leaves if name in (door.name, one.leaf.name, one.leaf.joint_name)]
    if not leaves:
        have = ", ".join(one.leaf.name for door in doors for one in door.leaves) or "none"
        raise SimError(f"no door {name!r} in the scene; it has: {have}")
    return leaves


def _require_reach(one: ClosedLeaf, name: str, opening: float) -> None:
    if one.leaf.kind == "sliding":
        raise SimError(f"door {name!r} slides and has no angle; set it with a keyframe")
    low, high = one.reach
    if not low - 1e-6 <= opening <= high + 1e-6:
        raise SimError(
            f"door {name!r}: {np.degrees(opening):g} deg is outside its range"
            f" of {np.degrees(low):.4g} to {np.degrees(high):.4g} deg"
        )


def _wedge(model: mujoco.MjModel, data: mujoco.MjData, joint: int) -> None:
    position, speed = int(model.jnt_qposadr[joint]), int(model.jnt_dofadr[joint])
    model.qpos_spring[position] = data.qpos[position]
    model.dof_frictionloss[speed] = max(float(model.dof_frictionloss[speed]), _WEDGE)
    drives = (model.actuator_trntype == mujoco.mjtTrn.mjTRN_JOINT) & (model.actuator_trnid[:, 0] == joint)
    for actuator in np.flatnonzero(drives & (model.actuator_biasprm[:, 1] < 0)):
        data.ctrl[actuator] = data.qpos[position] * model.actuator_gear[actuator, 0]


def _close_single(model: mujoco.MjModel, rays: Rays, leaf: Leaf) -> ClosedLeaf | None:
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
    turn = _turn(_normal(corners), normal) * np.sign(leaf.axis[2]) if normal is not None else 0.0
    return value + float(turn) if abs(turn) > _ALIGNED else value


def _close_pair(model: mujoco.MjModel, rays: Rays, first: Leaf, second: Leaf) -> tuple[ClosedLeaf, ClosedLeaf] | None:
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
    corners = _joined(first.corners_at(pair[0]), second.corners_at(pair[1]))
    if not (fit(rays, corners).closes and stands_on_floor(rays, corners)):
        return None
    normal = wall_normal(rays, corners)
    turn = _turn(_normal(corners), normal) if normal is not None else 0.0
    closed = [value + turn * np.sign(leaf.axis[2]) for value, leaf in zip(pair, (first, second), strict=True)]
    return _oriented(model, first, closed[0]), _oriented(model, second, closed[1])


def _close_sliding_pair(
    model: mujoco.MjModel, rays: Rays, first: Leaf, second: Leaf
) -> tuple[ClosedLeaf, ClosedLeaf] | None:
    for a in _natural_positions(model, first):
        for b in _natural_positions(model, second):
            one, other = first.corners_at(a), second.corners_at(b)
            meeting = min(np.linalg.norm(one[i, :2] - other[j, :2]) for i in (0, 1) for j in (0, 1))
            corners = _joined(one, other)
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
    """Adds which way the leaf opens, and how far, from the joint's range."""
    full = np.pi if leaf.kind == "hinged" else 2.0
    low, high = (-full, full)
    if model.jnt_limited[leaf.joint]:
        low, high = np.clip(model.jnt_range[leaf.joint] - closed, -full, full)
    slack = _SLACK if leaf.kind == "hinged" else 0.05
    if high <= slack and -low > high:
        return ClosedLeaf(leaf, closed, -1.0, (max(float(-high), 0.0), float(-low)))
    return ClosedLeaf(leaf, closed, 1.0, (float(low) if low < -slack else max(float(low), 0.0), float(high)))


def _measure_leaf(model: mujoco.MjModel, data: mujoco.MjData, one: ClosedLeaf) -> LeafTruth:
    leaf = one.leaf
    value = float(data.qpos[model.jnt_qposadr[leaf.joint]])
    corners = leaf.corners_at(value)
    change = value - one.closed
    if leaf.kind == "sliding":
        way = leaf.axis * one.sign
        return LeafTruth(*(leaf.name, leaf.joint_name, corners[[0, 3]], np.nan, abs(change), way, corners, one.reach))
    change = (change + np.pi) % (2 * np.pi) - np.pi
    swing = _opening_direction(one) * (-1.0 if change * one.sign < -_CLEARLY_OPEN else 1.0)
    heights = corners[[0, 3], 2]
    hinge = leaf.anchor + ((heights - leaf.anchor[2]) / leaf.axis[2])[:, None] * leaf.axis
    return LeafTruth(leaf.name, leaf.joint_name, hinge, abs(change), np.nan, swing, corners, one.reach)


def _opening_direction(one: ClosedLeaf) -> np.ndarray:
    """Horizontal unit vector (3,) along which the free edge of the closed leaf starts when it opens."""
    along = (one.corners[1] - one.corners[0]) * [1, 1, 0]
    direction = np.cross(one.sign * one.leaf.axis * [0, 0, 1], along)
    return direction / np.linalg.norm(direction)


def _joined(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """The upright rectangle (4, 3) over two leaves in one plane, from the first one's outer edge to the other's."""
    ends = max(((one[i], other[j]) for i in (0, 1) for j in (0, 1)), key=lambda pair: np.linalg.norm(pair[0] - pair[1]))
    bottom, top = min(one[0, 2], other[0, 2]), max(one[3, 2], other[3, 2])
    return np.array([[*ends[k][:2], z] for k, z in ((0, bottom), (1, bottom), (1, top), (0, top))])


def _normal(corners: np.ndarray) -> np.ndarray:
    normal = np.cross(corners[1] - corners[0], corners[3] - corners[0]) * [1, 1, 0]
    return normal / np.linalg.norm(normal)


def _turn(start: np.ndarray, end: np.ndarray, *, half: bool = True) -> float:
    """Signed angle about the vertical from one direction to another [rad]; `half` takes opposite normals as one."""
    angle = np.arctan2(start[0] * end[1] - start[1] * end[0], start[0] * end[0] + start[1] * end[1])
    return float((angle + np.pi / 2) % np.pi - np.pi / 2) if half else float(angle)


def _width(corners: np.ndarray) -> float:
    return float(np.linalg.norm(corners[1] - corners[0]))
