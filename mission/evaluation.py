"""Estimate against truth: which true door each detected one is, and how far they differ (section 7.1)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from detector.metrics import Overlap, overlap
from detector.result import Door, Leaf, Rectangle
from detector.room import Wall
from mission.door_faces import door_name
from mission.rigid import Pose, rotated, transformed

if TYPE_CHECKING:
    from sim.door_truth import DoorTruth

SAME_DIRECTION = np.cos(np.radians(20.0))
"""A wall and a true doorway belong together if their normals are closer than this [cosine]."""
SAME_PLANE = 0.5
"""... and the middle of the doorway is closer than this to the wall's plane [m]: thick walls, deep reveals."""
SAME_DOOR = 0.2
"""A detection is a true door's if they share at least this much of their union: anything less is a false positive."""


@dataclass(frozen=True, eq=False)
class DoorEvaluation:
    """A detected door in the world frame, beside the true door that it is."""

    door_id: str
    """Room, wall and a letter: "1.2-a"."""
    wall: int
    """Number of the wall, from 1."""
    door: Door
    corners_in_world: NDArray[np.float64]
    """(4, 3) doorway: bottom left, bottom right, top right, top left seen from inside the room [m]."""
    leaf_corners_in_world: tuple[NDArray[np.float64], ...]
    """(4, 3) of each leaf as it was measured to stand, hinge edge first, like the doorway's corners [m]."""
    true_name: str | None
    """None for a false positive; so are all fields below."""
    true_angle: float | None
    """Opening angle of the joint; of the wider open leaf of a double door; 0 for a sliding door [rad]."""
    overlap: Overlap | None
    true_leaf_corners_in_world: tuple[NDArray[np.float64], ...]
    """(4, 3) of each true leaf where it stands [m]."""
    true_opened_fraction: float | None = None
    """Way of a sliding door from closed over the doorway's width; None for a hinged door, too."""

    @property
    def angle_error(self) -> float | None:
        """Estimated less true opening angle [rad]; None without truth or without an estimate."""
        if self.true_angle is None or np.isnan(self.door.opening_angle):
            return None
        return self.door.opening_angle - self.true_angle

    @property
    def opening_angle_std(self) -> float:
        """Standard deviation of the opening angle [rad]; NaN without an estimate."""
        stds = [leaf.opening_angle_std for leaf in self.door.leaves if leaf.opening_angle == self.door.opening_angle]
        return stds[0] if stds else float("nan")

    @property
    def hinge(self) -> Literal["left", "right", "both", "none"]:
        """Side of the hinge seen from inside the room."""
        sides = [leaf.hinge for leaf in self.door.leaves if leaf.hinge != "none"]
        return "both" if {"left", "right"} <= set(sides) else sides[0] if sides else "none"

    @property
    def opens(self) -> Literal["inward", "outward"] | None:
        """Where the first open leaf stands; None for closed and sliding doors."""
        return next((leaf.opens for leaf in self.door.leaves if leaf.opens), None)


class Judged(Protocol):
    """A wall and the doors that the detector found in it."""

    @property
    def wall(self) -> Wall:
        """In the world."""

    @property
    def doors(self) -> tuple[Door, ...]:
        """From left to right."""


@dataclass(frozen=True, eq=False)
class JudgedWall:
    """A wall and its doors without all that led to them."""

    wall: Wall
    doors: tuple[Door, ...]


def judged(results: Sequence[Judged]) -> tuple[JudgedWall, ...]:
    """What remains of the detector's results when its pictures are let go."""
    return tuple(JudgedWall(result.wall, result.doors) for result in results)


def placed(walls: Sequence[Judged], world_from_room: Pose) -> list[JudgedWall]:
    """Walls of a room where the room lies in the world."""
    moved = []
    for one in walls:
        u, v = rotated(np.stack([one.wall.u, one.wall.v]), world_from_room)
        origin = transformed(one.wall.origin[None], world_from_room)[0]
        moved.append(JudgedWall(replace(one.wall, origin=origin, u=u, v=v), one.doors))
    return moved


def evaluate(
    results: Sequence[Judged],
    true_doors: Sequence[DoorTruth],
    *,
    room: int,
    outline: NDArray[np.float64],
) -> tuple[tuple[DoorEvaluation, ...], tuple[str, ...]]:
    """Compare the doors of a room with the true ones.

    Each true door is given to the detection that overlaps it most, each detection gets one at most. A true door is
    this room's if it lies along the room's outline, whether or not a wall was found there.

    Args:
        results: What the detector found, wall by wall.
        true_doors: All doors of the scene.
        room: Number of the room.
        outline: (P, 2) of the room's floor, closed where walls are missing [m].

    Returns:
        One evaluation a detected door, wall by wall, and the names of this room's true doors that were not found.
    """
    found = [(wall, door) for wall, result in enumerate(results) for door in result.doors]
    pairs = sorted(
        (
            (-iou, f, t)
            for f, (wall, door) in enumerate(found)
            for t, truth in enumerate(true_doors)
            if (iou := _shared(results[wall].wall, door, truth)) >= SAME_DOOR
        ),
    )
    truth_of: dict[int, int] = {}
    for _, f, t in pairs:
        if f not in truth_of and t not in truth_of.values():
            truth_of[f] = t
    evaluations = []
    for f, (wall, door) in enumerate(found):
        matched = true_doors[truth_of[f]] if f in truth_of else None
        door_id = door_name(room, wall + 1, sum(w == wall for w, _ in found[:f]))
        evaluations.append(_evaluation(door_id, wall + 1, results[wall].wall, door=door, truth=matched))
    here = {t for t, truth in enumerate(true_doors) if _is_of_room(truth, outline)}
    missed = tuple(true_doors[t].name for t in sorted(here - set(truth_of.values())))
    return tuple(evaluations), missed


def _is_of_room(truth: DoorTruth, outline: NDArray[np.float64]) -> bool:
    """Whether a true doorway lies along an edge of the room, be it a wall that was found or a gap."""
    middle = truth.corners_in_world[:, :2].mean(axis=0)
    for start, end in zip(outline, np.roll(outline, -1, axis=0), strict=True):
        length = float(np.hypot(*(end - start)))
        along = (end - start) / max(length, 1e-9)
        x, y = middle - start
        place, away = x * along[0] + y * along[1], abs(y * along[0] - x * along[1])
        across = abs(float(truth.normal[:2] @ along)) < np.sqrt(1 - SAME_DIRECTION**2)
        if across and away < SAME_PLANE and 0 < place < length:
            return True
    return False


def _evaluation(door_id: str, number: int, wall: Wall, *, door: Door, truth: DoorTruth | None) -> DoorEvaluation:
    r = door.rectangle
    n = len(door.leaves)
    leaves = tuple(_leaf_corners(wall, r, leaf, number=i, count=n) for i, leaf in enumerate(door.leaves))
    rectangle = doorway_on(wall, truth) if truth else None
    angles = [leaf.opening_angle for leaf in truth.leaves if not np.isnan(leaf.opening_angle)] if truth else []
    return DoorEvaluation(
        door_id=door_id,
        wall=number,
        door=door,
        corners_in_world=wall.world_from_wall(
            np.array([[r.left, r.bottom, 0], [r.right, r.bottom, 0], [r.right, r.top, 0], [r.left, r.top, 0]])
        ),
        leaf_corners_in_world=leaves,
        true_name=truth.name if truth else None,
        true_angle=max(angles, default=0.0) if truth else None,
        overlap=overlap(r, rectangle) if rectangle else None,
        true_leaf_corners_in_world=tuple(leaf.corners_in_world for leaf in truth.leaves) if truth else (),
        true_opened_fraction=true_opened_fraction(truth) if truth else None,
    )


def true_opened_fraction(truth: DoorTruth) -> float | None:
    """Way of a sliding door from closed over the doorway's width; None for a hinged door."""
    if truth.kind == "hinged":
        return None
    width = float(np.linalg.norm(truth.corners_in_world[1] - truth.corners_in_world[0]))
    return sum(leaf.opening for leaf in truth.leaves) / width


def doorway_on(wall: Wall, truth: DoorTruth) -> Rectangle | None:
    """The true doorway in wall coordinates, as it shows on this side, or None if it is not in this wall."""
    facing = float(np.dot(truth.normal, wall.normal))
    if abs(facing) < SAME_DIRECTION:
        return None
    corners = wall.wall_from_world(truth.outlines_in_world[0 if facing > 0 else 1])
    (left, bottom), (right, top) = corners[:, :2].min(axis=0), corners[:, :2].max(axis=0)
    middle = (left + right) / 2
    if abs(float(corners[:, 2].mean())) > SAME_PLANE or not 0 < middle < wall.width:
        return None
    return Rectangle(float(left), float(bottom), float(right), float(top))


def _shared(wall: Wall, door: Door, truth: DoorTruth) -> float:
    """Intersection over union of a detected and a true doorway."""
    rectangle = doorway_on(wall, truth)
    if rectangle is None:
        return 0.0
    return overlap(door.rectangle, rectangle).iou


def _leaf_corners(wall: Wall, doorway: Rectangle, leaf: Leaf, *, number: int, count: int) -> NDArray[np.float64]:
    """(4, 3) corners of a leaf at its measured angle or where it has slid to, hinge edge first [m]."""
    width = doorway.width / count
    left = doorway.left + number * width + leaf.slid
    hinge, along = (left + width, -1.0) if leaf.hinge == "right" else (left, 1.0)
    angle = 0.0 if np.isnan(leaf.opening_angle) else leaf.opening_angle
    depth = np.sin(angle) * (-1.0 if leaf.opens == "outward" else 1.0)
    free = np.array([hinge + along * width * np.cos(angle), width * depth])
    lo, hi = doorway.bottom, doorway.top
    return wall.world_from_wall(
        np.array([[hinge, lo, 0.0], [free[0], lo, free[1]], [free[0], hi, free[1]], [hinge, hi, 0.0]])
    )
