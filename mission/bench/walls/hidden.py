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


@dataclass(frozen=True)
class Hidden:
    """Shares that no scan place sees, 0..1."""

    panel: float
    frame: float


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
    width, height = np.linalg.norm(right), np.linalg.norm(up)
    x, z = (np.arange(_COLUMNS) + 0.5) / _COLUMNS, (np.arange(_ROWS) + 0.5) / _ROWS
    inside = np.stack(np.meshgrid(x, z), axis=-1).reshape(-1, 2)
    sides = [np.column_stack([np.full(_ROWS, at), z]) for at in (-_FRAME / width, 1 + _FRAME / width)]
    count = round(_ROWS * width / height)  # as dense as at the sides
    head = np.column_stack([(np.arange(count) + 0.5) / count, np.full(count, 1 + _FRAME / height)])
    around = np.concatenate([*sides, head])
    points = corners[0] + np.concatenate([inside, around]) @ np.stack([right, up])
    hidden = np.all([_blocked(rays, origin, points) for origin in origins], axis=0)
    return Hidden(float(hidden[: len(inside)].mean()), float(hidden[len(inside) :].mean()))


def _blocked(rays: Rays, origin: NDArray[np.float64], points: NDArray[np.float64]) -> NDArray[np.bool_]:
    ways = points - origin
    lengths = np.linalg.norm(ways, axis=1)
    hits = rays.cast(origin, ways / lengths[:, None])
    return np.asarray(hits.distances < lengths - 0.005)
