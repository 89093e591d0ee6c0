"""What the scans so far have seen of a room's structure, and what one from another place would add."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from detector.room import VoxelLabel
from mission.by_columns import gathered
from mission.prediction import Cells, Prospect, ScannerView, find_obstacles, prospect
from sim.parameters import Parameters
from sim.scan import ScannerParameters


class SurveyParameters(Parameters):
    """What counts as seen, and as seen well."""

    oblique_incidence: float = Field(
        default=math.radians(65), gt=0.0, lt=math.pi / 2, description="Beyond it a view is poor [rad]"
    )
    aside_bearing: float = Field(
        default=math.radians(20), ge=0.0, lt=math.pi / 2, description="From here on a doorway's side is seen [rad]"
    )
    same_view_angle: float = Field(
        default=math.radians(25),
        ge=0.0,
        le=math.pi / 2,
        description="What a scan failed to see is not expected from so near its direction [rad]",
    )
    view: ScannerView = ScannerView()


class StructuralVoxels(Protocol):
    """The voxels of walls, floor and ceiling as one table."""

    @property
    def cells_in_world(self) -> NDArray[np.floating]:
        """(M, 3) centres on the surface [m]."""

    @property
    def normals(self) -> NDArray[np.floating]:
        """(M, 3) unit normals into the room."""

    @property
    def labels(self) -> NDArray[np.uint8]:
        """(M,) `VoxelLabel`."""

    @property
    def areas(self) -> NDArray[np.floating]:
        """(M,) area of the surface in the voxel [m2]."""


@dataclass(frozen=True, kw_only=True)
class Preview:
    """What a scan would bring; the fields are those of `ScanCandidate`."""

    gain: float
    quality: float
    doorway: float
    overlap: float


NOTHING = Preview(gain=0.0, quality=0.0, doorway=0.0, overlap=0.0)


class Survey:
    """What the scans so far have seen of the structure, against which candidates are judged."""

    def __init__(
        self,
        voxels: StructuralVoxels,
        points_in_world: NDArray[np.floating],
        scanners_in_world: NDArray[np.float64],
        *,
        floor_height: float,
        room: NDArray[np.float64] | None,
        scanner: ScannerParameters,
        parameters: SurveyParameters,
    ) -> None:
        self._cells = Cells(gathered([voxels.cells_in_world]), gathered([voxels.normals]))
        self._areas = np.asarray(voxels.areas, np.float64)
        self._scanner, self._parameters, self._floor_height = scanner, parameters, floor_height
        self._obstacles = find_obstacles(points_in_world, self._cells, walls=room, view=parameters.view)
        self._occluded = voxels.labels == VoxelLabel.OCCLUDED
        self._occupied = voxels.labels == VoxelLabel.OCCUPIED
        self._walls = abs(self._cells.normals[:, 2]) < 0.5
        self._doorways, self._column = self._find_doorways((voxels.labels == VoxelLabel.OPENING) & self._walls)
        self._columns = np.bincount(self._column, self._areas[self._doorways])
        self._earlier = [self._prospect(origin) for origin in np.asarray(scanners_in_world, np.float64)]
        self._well_seen = self._any(self._well(view) for view in self._earlier)
        self._new_columns = {
            side: ~np.logical_or.reduce([self._columns_seen(view, side) for view in self._earlier]) for side in (1, -1)
        }
        self.coverage = 1.0 - self._area(self._occluded) / max(float(self._areas.sum()), 1e-9)

    def preview(self, scanner_in_world: NDArray[np.float64]) -> Preview:
        """What a scan from a (3,) place would bring."""
        view = self._prospect(scanner_in_world)
        known = self._area(view.seen & self._occupied)
        gain = self._area(self._promising(view))
        well = self._well(view) & ~self._well_seen & self._occupied & self._walls
        new_side = [self._columns_seen(view, side) & self._new_columns[side] for side in (1, -1)]
        return Preview(
            gain=gain,
            quality=self._area(well),
            doorway=float(self._columns[new_side[0] | new_side[1]].sum()),
            overlap=known / max(known + gain, 1e-9),
        )

    def _prospect(self, origin: NDArray[np.float64]) -> Prospect:
        return prospect(origin, self._cells, self._obstacles, scanner=self._scanner, view=self._parameters.view)

    def _area(self, chosen: NDArray[np.bool_]) -> float:
        return float(self._areas[chosen].sum())

    def _any(self, masks: Iterable[NDArray[np.bool_]]) -> NDArray[np.bool_]:
        return np.logical_or.reduce([np.zeros(len(self._areas), dtype=np.bool_), *masks])

    def _well(self, view: Prospect) -> NDArray[np.bool_]:
        """(M,) cells seen at a good angle."""
        return view.seen & (view.cosine >= np.cos(self._parameters.oblique_incidence))

    def _columns_seen(self, view: Prospect, side: int) -> NDArray[np.bool_]:
        """(C,) doorway columns half seen from well to one side: 1 is anticlockwise of the normal, -1 clockwise."""
        normal, towards = self._cells.normals[self._doorways], view.towards[self._doorways]
        across = normal[:, 0] * towards[:, 1] - normal[:, 1] * towards[:, 0]
        bearing = np.arctan2(across, normal[:, 0] * towards[:, 0] + normal[:, 1] * towards[:, 1])
        seen = view.seen[self._doorways] & (side * bearing > self._parameters.aside_bearing)
        return (
            np.bincount(self._column[seen], self._areas[self._doorways][seen], len(self._columns)) >= self._columns / 2
        )

    def _promising(self, view: Prospect) -> NDArray[np.bool_]:
        """(M,) occluded cells in view, but those that a scan from much the same direction should have seen already.

        They are behind something that the points do not show, such as the back of a cabinet against the wall.
        """
        same = np.cos(self._parameters.same_view_angle)
        promising = view.seen & self._occluded
        for earlier in self._earlier:
            again = np.flatnonzero(promising & earlier.seen)
            promising[again[(earlier.towards[again] * view.towards[again]).sum(axis=1) > same]] = False
        return promising

    def _find_doorways(self, openings: NDArray[np.bool_]) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Indices (D,) of opening cells above an open spot near the floor, and the column (D,) that each is in.

        The lowest voxel may hold points of the floor, so the spot is looked for in the lowest half metre.
        """
        from scipy.spatial import cKDTree

        centres = self._cells.centres
        feet = np.flatnonzero(openings & (centres[:, 2] < self._floor_height + 0.5))
        above = np.flatnonzero(openings)
        if len(feet) == 0:
            return feet, feet
        distance, foot = cKDTree(centres[feet, :2]).query(centres[above, :2])
        above, foot = above[distance < 0.02], foot[distance < 0.02]
        _, column = np.unique(foot, return_inverse=True)
        return above, column
