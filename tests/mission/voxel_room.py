"""A room of 6 x 5 x 2.6 m as the table of voxels that planning takes."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from detector.room import VoxelLabel
from mission.grid import Cell, OccupancyGrid

OCCUPIED, OCCLUDED, OPENING = VoxelLabel.OCCUPIED, VoxelLabel.OCCLUDED, VoxelLabel.OPENING
WIDTH, DEPTH, HEIGHT, SCANNER = 6.0, 5.0, 2.6, 1.2
ROOM = np.array([[0.0, 0.0], [WIDTH, 0.0], [WIDTH, DEPTH], [0.0, DEPTH]])


@dataclass(frozen=True)
class Voxels:
    """The table that planning takes."""

    cells_in_world: NDArray[np.float64]
    normals: NDArray[np.float64]
    labels: NDArray[np.uint8]
    areas: NDArray[np.float64]

    def labelled(
        self, label: VoxelLabel, x: tuple[float, float], y: tuple[float, float], z: tuple[float, float]
    ) -> Voxels:
        """The cells within a box get a label."""
        low, high = np.array([x, y, z]).T
        inside = ((self.cells_in_world >= low) & (self.cells_in_world <= high)).all(axis=1)
        return replace(self, labels=np.where(inside, np.uint8(label), self.labels))


def room_voxels() -> Voxels:
    """All six sides of the room in cells of 0.2 m, all of them occupied."""
    centres, normals = [], []
    for axis, extent in enumerate((WIDTH, DEPTH, HEIGHT)):
        others = [np.arange(0.1, e, 0.2) for k, e in enumerate((WIDTH, DEPTH, HEIGHT)) if k != axis]
        flat = np.stack(np.meshgrid(*others, indexing="ij"), axis=-1).reshape(-1, 2)
        for at, inward in ((0.0, 1.0), (extent, -1.0)):
            centres.append(np.insert(flat, axis, at, axis=1))
            normals.append(np.tile(inward * np.eye(3)[axis], (len(flat), 1)))
    cells = np.concatenate(centres)
    labels = np.full(len(cells), OCCUPIED, np.uint8)
    return Voxels(cells, np.concatenate(normals), labels, np.full(len(cells), 0.04))


def box_points(x: tuple[float, float], y: tuple[float, float], z: tuple[float, float]) -> NDArray[np.float64]:
    """A box full of points, 5 cm apart."""
    axes = [np.arange(low, high + 1e-9, 0.05) for low, high in (x, y, z)]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)


def free_grid(x: tuple[float, float] = (0.0, WIDTH), y: tuple[float, float] = (0.0, DEPTH)) -> OccupancyGrid:
    """Free floor in a rectangle of the room, the rest occupied."""
    grid = OccupancyGrid(np.array([-0.5, -0.5]), 0.05, np.full((120, 140), Cell.OCCUPIED, np.uint8))
    c = grid.centres()
    free = (c[..., 0] > x[0]) & (c[..., 0] < x[1]) & (c[..., 1] > y[0]) & (c[..., 1] < y[1])
    return replace(grid, cells=np.where(free, Cell.FREE, Cell.OCCUPIED).astype(np.uint8))
