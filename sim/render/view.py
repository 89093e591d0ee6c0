"""A pinhole picture to be rendered."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, eq=False)
class View:
    """A pinhole picture to be rendered: where from, through which window, how many pixels."""

    world_from_view: NDArray[np.float64]
    """(4, 4) pose with OpenCV's axes: x right, y down, z forward."""
    left: float
    """Edges of the window at unit distance, so tangents; `bottom < top`, up being -y."""
    right: float
    bottom: float
    top: float
    width: int
    """[px]"""
    height: int
    """[px]"""


def looking_along(azimuth: float) -> NDArray[np.float64]:
    """(4, 4) frame-from-view pose of an upright pinhole at the origin of a frame with z up.

    Args:
        azimuth: direction of the optical axis, anticlockwise from the frame's x axis [rad].
    """
    cos, sin = np.cos(azimuth), np.sin(azimuth)
    pose = np.eye(4)
    pose[:3, :3] = [[sin, 0, cos], [-cos, 0, sin], [0, -1, 0]]  # columns in OpenCV's order: right, down, forward
    return pose
