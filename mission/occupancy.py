"""A map of the floor in cells that are free, occupied or unknown, and the rectangle that the robot covers on it."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from functools import cached_property

import cv2
import numpy as np
from numpy.typing import NDArray


class Cell(IntEnum):
    """State of a grid cell."""

    UNKNOWN = 0
    FREE = 1
    OCCUPIED = 2


@dataclass(frozen=True)
class Footprint:
    """The rectangle that the robot covers, its centre the origin of the base frame."""

    length: float
    """Along x [m]."""
    width: float
    """Along y [m]."""

    @property
    def half_diagonal(self) -> float:
        """Radius of the disc that the robot sweeps when it turns on the spot [m]."""
        return float(np.hypot(self.length, self.width)) / 2

    def covers(self, points: NDArray[np.floating], *, margin: float = 0.0) -> NDArray[np.bool_]:
        """(N,) which (N, >=2) points of the base frame lie within the rectangle widened by `margin` [m]."""
        return (abs(points[:, 0]) <= self.length / 2 + margin) & (abs(points[:, 1]) <= self.width / 2 + margin)


@dataclass(frozen=True, eq=False)
class OccupancyGrid:
    """A map of the floor in square cells along the world's axes."""

    origin: NDArray[np.float64]
    """(2,) lower left corner of cell (0, 0) in the world [m]."""
    resolution: float
    """Side of a cell [m]."""
    cells: NDArray[np.uint8]
    """(rows, columns) `Cell`; row 0 lies at origin y, columns run along x."""

    @cached_property
    def clearance(self) -> NDArray[np.float32]:
        """(rows, columns) distance from a cell's centre to the nearest cell that is not free [m], 0 where not free."""
        padded = np.pad((self.cells == Cell.FREE).astype(np.uint8), 1)  # beyond the edge nothing is free
        distance = cv2.distanceTransform(padded, cv2.DIST_L2, cv2.DIST_MASK_PRECISE)[1:-1, 1:-1]
        to_side = np.maximum(distance - 0.5, 0.0)  # centre to centre, less half a cell
        return to_side.astype(np.float32) * np.float32(self.resolution)

    def centres(self) -> NDArray[np.float64]:
        """(rows, columns, 2) centres of all cells in the world [m]."""
        rows, columns = self.cells.shape
        x = self.origin[0] + (np.arange(columns) + 0.5) * self.resolution
        y = self.origin[1] + (np.arange(rows) + 0.5) * self.resolution
        return np.stack(np.meshgrid(x, y), axis=-1)

    def indices(
        self, points_in_world: NDArray[np.floating]
    ) -> tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.bool_]]:
        """Row, column and whether inside the grid, each (...), of (..., >=2) points; outside, row and column are 0."""
        cell = np.floor((points_in_world[..., :2] - self.origin) / self.resolution)
        rows, columns = self.cells.shape
        inside = (cell >= 0).all(axis=-1) & (cell[..., 1] < rows) & (cell[..., 0] < columns)
        index = np.where(inside[..., None], cell, 0).astype(np.intp)
        return index[..., 1], index[..., 0], inside

    def states(self, points_in_world: NDArray[np.floating]) -> NDArray[np.uint8]:
        """(...) `Cell` at (..., >=2) points of the world; unknown outside the grid."""
        row, column, inside = self.indices(points_in_world)
        return np.where(inside, self.cells[row, column], np.uint8(Cell.UNKNOWN))

    def clearance_at(self, points_in_world: NDArray[np.floating]) -> NDArray[np.float32]:
        """(...) clearance at (..., 2) points, bilinear between the cells' centres [m]; 0 outside the grid."""
        at = ((points_in_world[..., :2] - self.origin) / self.resolution - 0.5).astype(np.float32)
        flat = at.reshape(1, -1, 2)
        looked_up = [
            cv2.remap(self.clearance, chunk[..., 0], chunk[..., 1], cv2.INTER_LINEAR, borderValue=0.0)
            for chunk in np.array_split(flat, range(_REMAP_LIMIT, flat.shape[1], _REMAP_LIMIT), axis=1)
        ]
        return np.concatenate(looked_up, axis=1, dtype=np.float32).reshape(at.shape[:-1])


_REMAP_LIMIT = 32_000
"""cv2.remap addresses its maps with 16 bit."""
