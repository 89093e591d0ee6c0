"""What the detector is given (section 3 of the paper): one completed room."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum
from functools import cached_property

import cv2
import numpy as np
from numpy.typing import NDArray

THINNED_TO = 600_000
"""Points of a view that are enough for shadows and leaves."""


class DetectorError(ValueError):
    """A room, wall or parameter that the detector cannot work with."""


class VoxelLabel(IntEnum):
    """Label of a wall voxel (section 3, figure 2)."""

    OCCUPIED = 1
    """Holds at least one scanned point."""
    OCCLUDED = 2
    """Holds no point and was seen from no scanning location."""
    OPENING = 3
    """Holds no point although at least one scanning location looked through it."""


@dataclass(frozen=True, eq=False)
class View:
    """The coloured points of one scan, in the world frame."""

    points_in_world: NDArray[np.float32]
    """(N, 3) scanned points [m]; those that are not finite are left out."""
    colours: NDArray[np.uint8]
    """(N, 3) sRGB; meaningless where `coloured` is False."""
    coloured: NDArray[np.bool_]
    """(N,) True where a photograph saw the point."""
    scanner_in_world: NDArray[np.float64]
    """(3,) origin of the laser beams [m]."""
    camera_in_world: NDArray[np.float64]
    """(3,) centre of the camera, the same for all photographs of the scan [m]."""

    @cached_property
    def thinned_points(self) -> NDArray[np.float32]:
        """(M, 3) some of the points, in the world frame, enough for shadows and leaves [m]."""
        return np.ascontiguousarray(self.points_in_world[:: 1 + 2 * (len(self.points_in_world) // (2 * THINNED_TO))])

    def __post_init__(self) -> None:
        n = len(self.points_in_world)
        for name, array, shape in (
            ("points_in_world", self.points_in_world, (n, 3)),
            ("colours", self.colours, (n, 3)),
            ("coloured", self.coloured, (n,)),
            ("scanner_in_world", self.scanner_in_world, (3,)),
            ("camera_in_world", self.camera_in_world, (3,)),
        ):
            if np.shape(array) != shape:
                raise DetectorError(f"View.{name}: expected shape {shape}, got {np.shape(array)}")
        for name, array, kinds in (
            ("points_in_world", self.points_in_world, (np.float32, np.float64)),
            ("colours", self.colours, (np.uint8,)),
            ("coloured", self.coloured, (np.bool_,)),
        ):
            if not isinstance(array, np.ndarray) or array.dtype not in kinds:
                expected = " or ".join(kind.__name__ for kind in kinds)
                raise DetectorError(f"View.{name}: expected an array of {expected}, got {np.asarray(array).dtype}")
        for name, place in (("scanner_in_world", self.scanner_in_world), ("camera_in_world", self.camera_in_world)):
            if not np.isfinite(place).all():
                raise DetectorError(f"View.{name}: expected three finite coordinates, got {place}")


@dataclass(frozen=True, eq=False)
class Wall:
    """A wall rectangle, as seen by somebody who stands in the room and faces it."""

    origin: NDArray[np.float64]
    """(3,) bottom left corner in the world frame [m]."""
    u: NDArray[np.float64]
    """(3,) unit vector to the right, horizontal."""
    v: NDArray[np.float64]
    """(3,) unit vector up; u x v is the wall's normal and points into the room."""
    width: float
    """Extent along u [m]."""
    height: float
    """Extent along v [m]."""
    voxel_labels: NDArray[np.uint8]
    """(rows, columns) `VoxelLabel` of the wall's voxels; row 0 is the top, column 0 the left, and the
    last row and column may stick out beyond the rectangle."""
    voxel_size: float = 0.2
    """Side of a voxel [m]."""

    @cached_property
    def normal(self) -> NDArray[np.float64]:
        """(3,) unit vector into the room."""
        return np.cross(self.u, self.v)

    def wall_from_world(self, points: NDArray[np.floating]) -> NDArray[np.floating]:
        """(N, 3) coordinates along u, along v and depth into the room [m], of points in the world frame."""
        return self._along(np.stack([self.u, self.v, self.normal]), points)

    def depths(self, points: NDArray[np.floating]) -> NDArray[np.floating]:
        """(N,) depth into the room [m], of points in the world frame."""
        return self._along(self.normal[None], points)[:, 0]

    def _along(self, axes: NDArray[np.float64], points: NDArray[np.floating]) -> NDArray[np.floating]:
        """(N, K) coordinates from the wall's origin along axes (K, 3), in the points' own precision."""
        if len(points) == 0:
            return np.zeros((0, len(axes)), points.dtype)
        matrix = np.column_stack([axes, -(axes @ self.origin)]).astype(points.dtype)
        # one pass, several times as fast as products of (N, 3) rows
        return np.asarray(cv2.transform(points[None], matrix), points.dtype).reshape(-1, len(axes))

    def world_from_wall(self, points: NDArray[np.floating]) -> NDArray[np.float64]:
        """(N, 3) points in the world frame [m], from coordinates along u, along v and depth."""
        return self.origin + points @ np.stack([self.u, self.v, self.normal])


@dataclass(frozen=True, eq=False)
class Room:
    """A room whose scanning is completed."""

    views: Sequence[View]
    """One view a scanning location; the detector reads each once, one after another."""
    walls: tuple[Wall, ...]
    """Wall rectangles, counter-clockwise seen from above where the room closes."""
    floor_height: float
    """World z of the floor [m]."""
    ceiling_height: float | None
    """World z of the ceiling [m]; None where there is none."""
