"""The truth about a scene's doors: leaves, the openings that they fill, and how far they stand open."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

import mujoco
import numpy as np

from sim.closing import ClosedLeaf, close_pair, close_single, joined, rectangle_normal
from sim.covering import uncovered
from sim.door_truth import DoorTruth, LeafTruth
from sim.errors import SimError
from sim.leaves import find_leaves
from sim.rays import Rays

_CLEARLY_OPEN = np.radians(1.0)
_WEDGE = 15.0
"""Friction that keeps a leaf where it was put, against springs and leaning hinges [N m or N]."""

_STIFF = (0.9999, 0.9999, 0.001, 0.5, 2.0)
"""Impedance of that friction: with MuJoCo's own, a leaf on a leaning hinge creeps by a degree in a minute."""


@dataclass(frozen=True)
class Door:
    """A doorway and what closes it; what does not change while the doors move."""

    leaves: tuple[ClosedLeaf, ...]
    corners: np.ndarray
    """As `DoorTruth.corners_in_world`."""
    normal: np.ndarray
    """As in `DoorTruth`."""
    outlines: tuple[np.ndarray, np.ndarray]
    """As `DoorTruth.outlines_in_world`."""

    @property
    def name(self) -> str:
        return "+".join(one.leaf.name for one in self.leaves)


def true_doors(model: mujoco.MjModel, data: mujoco.MjData) -> tuple[DoorTruth, ...]:
    """All doors of a scene as they stand now; see `find_doors` for what a door is."""
    return tuple(measure_door(model, data, door) for door in find_doors(model, data))


def find_doors(model: mujoco.MjModel, data: mujoco.MjData) -> tuple[Door, ...]:
    """Find the doors of any scene from its geometry; names and joint zeros mean nothing.

    A leaf is a slab of a door's size (see `sim.leaves`). It is a door's if at some joint position it stands on the
    floor in an opening of the static geometry that is passable behind it: that position is "closed". A refrigerator's
    or a wardrobe's door closes nothing that leads anywhere. Two leaves that fill an opening only together are one
    double door; one of them may be narrower than a door.

    Args:
        model: the compiled scene, with or without the robot.
        data: its state, positions up to date.
    """
    moving = frozenset(np.flatnonzero(model.body_weldid != 0).tolist())
    rays = Rays(model, data, moving)
    leaves = find_leaves(model, data)
    singles = [(leaf, close_single(model, rays, leaf) if leaf.is_door_wide else None) for leaf in leaves]
    doors = [_door(rays, (single,)) for _, single in singles if single]
    paired: set[int] = set()
    for first, second in combinations([leaf for leaf, single in singles if not single], 2):
        if not (first.is_door_wide or second.is_door_wide):
            continue
        if not paired & {first.joint, second.joint} and (pair := close_pair(model, rays, first, second)):
            doors.append(_door(rays, pair))
            paired |= {first.joint, second.joint}
    return tuple(sorted(doors, key=lambda door: door.leaves[0].leaf.joint))


def measure_door(model: mujoco.MjModel, data: mujoco.MjData, door: Door) -> DoorTruth:
    """The truth about one door from the joints' present positions."""
    leaves = tuple(_measure_leaf(model, data, one) for one in door.leaves)
    names = tuple(leaf.name for leaf in leaves)
    kind = door.leaves[0].leaf.kind
    return DoorTruth(door.name, kind, names, door.corners, door.normal, door.outlines, leaves)


def measure_opening(model: mujoco.MjModel, data: mujoco.MjData, door: Door) -> float:
    """How far a door stands open: its wider leaf [rad], or its way along the slide [m]."""
    return max(abs(_change(model, data, one)) for one in door.leaves)


def put_doors(model: mujoco.MjModel, data: mujoco.MjData, doors: Sequence[Door], openings: Mapping[str, float]) -> None:
    """Open doors as asked and wedge all of them where they then stand.

    A wedge is friction in the joint, a spring at rest and a servo that holds: a scan takes a minute, and what it saw
    must still be so in the next one. The robot can push a wedged leaf aside.

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


def _door(rays: Rays, leaves: tuple[ClosedLeaf, ...]) -> Door:
    first = leaves[0]
    normal = _opening_direction(first) if first.leaf.kind == "hinged" else rectangle_normal(first.corners)
    corners = first.corners if len(leaves) == 1 else joined(first.corners, leaves[1].corners)
    right = np.cross([0, 0, 1.0], normal)
    if (corners[1] - corners[0]) @ right < 0:
        corners = corners[[1, 0, 3, 2]]
    outlines = corners, corners
    if first.leaf.kind == "sliding":
        outlines = uncovered(rays, corners, normal), uncovered(rays, corners, -normal)
    return Door(leaves, corners, normal, outlines)


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
    model.dof_solimp[speed] = _STIFF
    drives = (model.actuator_trntype == mujoco.mjtTrn.mjTRN_JOINT) & (model.actuator_trnid[:, 0] == joint)
    for actuator in np.flatnonzero(drives & (model.actuator_biasprm[:, 1] < 0)):
        data.ctrl[actuator] = data.qpos[position] * model.actuator_gear[actuator, 0]


def _measure_leaf(model: mujoco.MjModel, data: mujoco.MjData, one: ClosedLeaf) -> LeafTruth:
    leaf = one.leaf
    corners = leaf.corners_at(_value(model, data, one))
    change = _change(model, data, one)
    if leaf.kind == "sliding":
        return LeafTruth(leaf.name, np.nan, abs(change), leaf.axis * one.sign, corners)
    swing = _opening_direction(one) * (-1.0 if change * one.sign < -_CLEARLY_OPEN else 1.0)
    return LeafTruth(leaf.name, abs(change), np.nan, swing, corners)


def _value(model: mujoco.MjModel, data: mujoco.MjData, one: ClosedLeaf) -> float:
    """The position of a leaf's joint [rad or m]."""
    return float(data.qpos[model.jnt_qposadr[one.leaf.joint]])


def _change(model: mujoco.MjModel, data: mujoco.MjData, one: ClosedLeaf) -> float:
    """The way of a leaf's joint from where it is closed [rad, within half a turn, or m]."""
    change = _value(model, data, one) - one.closed
    return change if one.leaf.kind == "sliding" else (change + np.pi) % (2 * np.pi) - np.pi


def _opening_direction(one: ClosedLeaf) -> np.ndarray:
    """Horizontal unit vector (3,) along which the free edge of the closed leaf starts when it opens."""
    along = (one.corners[1] - one.corners[0]) * [1, 1, 0]
    direction = np.cross(one.sign * one.leaf.axis * [0, 0, 1], along)
    return direction / np.linalg.norm(direction)
