"""How much of a door furniture hides: rays from the scan places to its panel and its frame."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import mujoco
import numpy as np
from numpy.typing import NDArray

import assets
from sim.rays import Rays

_COLUMNS, _ROWS = 25, 30
"""Rays to a panel, and to each side of a frame: within 4 % of the true share, one column."""
_FRAME = 0.03
"""Middle of the strip round the panel that counts as its frame [m]."""
_CORNER, _CORNER_STEPS = 0.15, 4
"""Length of the sides that make an upper corner [m], and steps between rays to each."""


@dataclass(frozen=True)
class Hidden:
    """Shares that no scan place sees, 0..1."""

    panel: float
    frame: float
    """Of its three sides together."""
    sides: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Of its left, upper and right side."""
    corners_seen: bool = True
    """Whether for each upper corner there is a place that sees the last 15 cm of both sides that meet in it."""


@cache
def scanner_in_base() -> tuple[float, float, float]:
    """Where the beams start, in the robot's base frame [m]."""
    robot = mujoco.MjModel.from_xml_path(str(assets.FOLDER / "mopad" / "mopad.xml"))
    data = mujoco.MjData(robot)
    mujoco.mj_kinematics(robot, data)
    x, y, z = (data.site("beam_origin").xpos - data.body("base").xpos).tolist()
    return (x, y, z)


def scanner_origins(scan_places: tuple[tuple[float, float, float], ...]) -> NDArray[np.float64]:
    """(K, 3) origins of the beams in world for bases at x, y [m] and heading [rad] on the floor z = 0."""
    ahead, left, up = scanner_in_base()
    return np.array(
        [
            (x + ahead * np.cos(yaw) - left * np.sin(yaw), y + ahead * np.sin(yaw) + left * np.cos(yaw), up)
            for x, y, yaw in scan_places
        ]
    )


def hidden_shares(rays: Rays, corners: NDArray[np.float64], origins: NDArray[np.float64]) -> Hidden:
    """Cast rays at a door.

    Args:
        rays: against the room, past what hides nothing: walls, and the doors themselves.
        corners: (4, 3) of the closed panel's face in world: bottom left, bottom right, top right, top left [m].
        origins: (K, 3) from where [m].
    """
    right, up = corners[1] - corners[0], corners[3] - corners[0]
    size = float(np.linalg.norm(right)), float(np.linalg.norm(up))
    x, z = (np.arange(_COLUMNS) + 0.5) / _COLUMNS, (np.arange(_ROWS) + 0.5) / _ROWS
    inside = np.stack(np.meshgrid(x, z), axis=-1).reshape(-1, 2)
    sides, upper_corners = _sides(size), _upper_corners(size)
    ends = np.cumsum([len(inside), *map(len, sides)])[:-1]
    axes = np.stack([right, up])
    hidden = _hidden(rays, origins, corners[0] + np.concatenate([inside, *sides]) @ axes)
    panel, left, top, right_side = np.split(hidden, ends)
    return Hidden(
        panel=float(panel.mean()),
        frame=float(hidden[len(inside) :].mean()),
        sides=(float(left.mean()), float(top.mean()), float(right_side.mean())),
        corners_seen=all(_seen_at_once(rays, origins, corners[0] + corner @ axes) for corner in upper_corners),
    )


def _sides(size: tuple[float, float]) -> list[NDArray[np.float64]]:
    """Points (N, 2) on the left, upper and right side of the frame, in parts of the panel's width and height."""
    width, height = size
    z = (np.arange(_ROWS) + 0.5) / _ROWS
    left, right = (np.column_stack([np.full(_ROWS, at), z]) for at in (-_FRAME / width, 1 + _FRAME / width))
    count = round(_ROWS * width / height)  # as dense as at the sides
    top = np.column_stack([(np.arange(count) + 0.5) / count, np.full(count, 1 + _FRAME / height)])
    return [left, top, right]


def _upper_corners(size: tuple[float, float]) -> list[NDArray[np.float64]]:
    """Likewise on the last of the sides that meet in the left and in the right upper corner."""
    width, height = size
    way = _CORNER * np.arange(_CORNER_STEPS + 1) / _CORNER_STEPS
    found = []
    for edge, inward in ((0.0, 1.0), (1.0, -1.0)):
        side = np.column_stack([np.full(len(way), edge - inward * _FRAME / width), 1 - way / height])
        top = np.column_stack([edge + inward * way / width, np.full(len(way), 1 + _FRAME / height)])
        found.append(np.concatenate([side, top]))
    return found


def _hidden(rays: Rays, origins: NDArray[np.float64], points: NDArray[np.float64]) -> NDArray[np.bool_]:
    """(N,) whether none of the places sees a point."""
    left = np.arange(len(points))
    for origin in origins:
        if len(left):
            left = left[_blocked(rays, origin, points[left])]
    return np.isin(np.arange(len(points)), left)


def _seen_at_once(rays: Rays, origins: NDArray[np.float64], points: NDArray[np.float64]) -> bool:
    """Whether one of the places sees all points."""
    return any(not _blocked(rays, origin, points).any() for origin in origins)


def _blocked(rays: Rays, origin: NDArray[np.float64], points: NDArray[np.float64]) -> NDArray[np.bool_]:
    ways = points - origin
    lengths = np.linalg.norm(ways, axis=1)
    hits = rays.cast(origin, ways / lengths[:, None], float(lengths.max()))
    return np.asarray(hits.distances < lengths - 0.005)
