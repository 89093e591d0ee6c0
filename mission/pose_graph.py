"""The pose graph: where each room lies in the world, from what links it to others."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mission.rigid import Pose, inverted

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Link:
    """A measurement of one room's frame in another's: where a place lies in both, and how they are turned.

    Floors are level, so rooms turn about the vertical only.
    """

    first: int
    """Number of a room."""
    second: int
    in_first: Floats
    """(3,) the place in the first room's frame [m]."""
    in_second: Floats
    """(3,) and in the second's [m]."""
    turn: float
    """Of the second frame in the first, about z [rad]."""
    axes: Floats
    """(3, 3) rows: unit vectors in the first room's frame along which the place is known differently well."""
    deviations: Floats
    """(3,) 1 sigma along these axes [m]."""
    turn_deviation: float
    """1 sigma [rad]."""
    doors: tuple[str, str] | None = None
    """The two faces of the door that it was measured by; None for one that comes from scans."""


@dataclass(frozen=True, eq=False)
class Anchor:
    """What is known of a room's place without any link: where the robot was said to stand."""

    place: Floats
    """(3,) in the room's frame, about which the frame turns [m]."""
    deviation: float
    """1 sigma in plan [m]; 0 for the room in whose frame the map is made."""
    turn_deviation: float
    """1 sigma about z [rad]."""


LEVEL = 0.002
"""How well the height of a room's frame is known without any link: the robot stands on its floor, 1 sigma [m]."""


def solve(anchors: Mapping[int, Anchor], links: Sequence[Link]) -> dict[int, Pose]:
    """world_from_room (4, 4) of each room, by least squares over anchors and links.

    Args:
        anchors: By the number of the room; one of them at least has no deviation.
        links: Between these rooms.
    """
    from scipy.optimize import least_squares

    free = [room for room, anchor in anchors.items() if anchor.deviation > 0]
    fixed = {room: np.eye(4) for room in anchors if room not in free}
    if not free:
        return fixed

    def poses(motion: Floats) -> dict[int, Pose]:
        moved = {room: _moved(anchors[room].place, *m) for room, m in zip(free, motion.reshape(-1, 4), strict=True)}
        return fixed | moved

    def residuals(motion: Floats) -> Floats:
        where = poses(motion)
        deviations = np.array(
            [[anchors[r].deviation, anchors[r].deviation, LEVEL, anchors[r].turn_deviation] for r in free]
        )
        pulls = [(motion.reshape(-1, 4) / deviations).ravel()]
        pulls += [residual(link, where[link.first], where[link.second]) for link in links]
        return np.concatenate(pulls)

    found = least_squares(residuals, np.zeros(4 * len(free)), method="lm")
    return {room: poses(found.x)[room] for room in anchors}


def turn_of(pose: Pose) -> float:
    """Rotation about z [rad]."""
    return float(np.arctan2(pose[1, 0], pose[0, 0]))


def _moved(place: Floats, x: float, y: float, z: float, turn: float) -> Pose:
    """The pose that turns about a place and then shifts."""
    pose = np.eye(4)
    pose[:2, :2] = [[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]]
    pose[:3, 3] = place - pose[:3, :3] @ place + [x, y, z]
    return pose


def residual(link: Link, world_from_first: Pose, world_from_second: Pose) -> Floats:
    """(4,) what the link says otherwise, in its own deviations."""
    first_from_second = inverted(world_from_first) @ world_from_second
    off = first_from_second[:3, :3] @ link.in_second + first_from_second[:3, 3] - link.in_first
    turn = (turn_of(first_from_second) - link.turn + np.pi) % (2 * np.pi) - np.pi
    return np.append(link.axes @ off / link.deviations, turn / link.turn_deviation)
