"""What the robot knows of a room: estimates only, in the room's own frame.

That frame is the world as the robot knew it when it entered. Names that end in `in_world` mean it: where it lies in
the true map, links to other rooms tell later.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from mission.config import MissionConfig
from mission.grid import Footprint, OccupancyGrid, ScannedFloor, occupancy_grid, scanned_floor
from mission.localisation import LaserMap, laser_map
from mission.planning import Plan, plan_next_scan
from mission.registration import Registrar, Registration
from mission.rigid import Pose
from mission.samples import PosedSample, ScanSample, sample_scan
from mission.structure import Structure, find_structure
from mission.views import ColouredScan
from mission.voxels import VoxelModel, label_voxels
from sim.laser_scan import LaserScan
from sim.scan import Scan


@dataclass(frozen=True, eq=False)
class RoomMaps:
    """What one drives by in a room that is done: some hundred kilobytes, where its scans were megabytes each."""

    floor: ScannedFloor
    """What the scans told of it."""
    lasers: LaserMap
    """At the height of the Hokuyos."""


@dataclass
class ExploredRoom:
    """Scans of a room, and what follows from them."""

    number: int
    footprint: Footprint
    config: MissionConfig
    registrar: Registrar
    """With the map of what was scanned here; through a doorway it begins with a scan from the threshold."""
    threshold: PosedSample | None = None
    """The scan from the doorway, for driving in: no scan of this room, for it saw the one before as well."""
    coloured: list[ColouredScan] = field(default_factory=list)
    """The scans as the detector takes them; none without photographs, and none when the detector has seen them."""
    samples: list[PosedSample] = field(default_factory=list)
    """The scans as registration, structure, voxels and plans take them; none when the room is linked to the others."""
    maps: RoomMaps | None = None
    """Of a room whose scans are gone."""
    rejected_in_world: list[NDArray[np.float64]] = field(default_factory=list)
    """(3,) where scans were taken that could not be registered [m]."""
    lasers: list[tuple[LaserScan, Pose]] = field(default_factory=list)
    """Hokuyo scans with the pose of the base."""
    passing: list[tuple[LaserScan, Pose]] = field(default_factory=list)
    """Those taken under way on legs that ended as planned."""
    robot_poses: list[Pose] = field(default_factory=list)
    """Where the robot has stood."""

    def register(self, scan: Scan, guess_world_from_scanner: Pose) -> tuple[ScanSample, Registration]:
        """Thin a scan out and find where it was taken; the map grows by it if that is found."""
        sample = sample_scan(scan, self.config.samples)
        return sample, self.registrar.register(sample, guess_world_from_scanner)

    def close(self) -> None:
        """Let go of what only a room that is scanned needs: what remains is to link it, and to drive through it.

        The detector, which takes most memory of all, comes next.
        """
        self.coloured.clear()
        self.threshold = None
        self.samples = [replace(sample, sample=sample.sample.without_image()) for sample in self.samples]

    def settle(self, floor_height: float, laser_height: float) -> None:
        """Keep maps in the place of the scans, once the room is linked to the others: what remains is to drive.

        Args:
            floor_height: World z of the floor [m].
            laser_height: World z of the Hokuyos' plane [m].
        """
        self.maps = RoomMaps(self._scanned_floor(floor_height), self.laser_map(laser_height))
        self.samples.clear()

    def structure(self) -> Structure:
        """Floor, ceiling and walls as far as they are scanned.

        Raises:
            MissionError: There is no floor or no wall.
        """
        return find_structure(self.samples, self.config.structure, scanner=self.config.scanner)

    def voxels(self, structure: Structure) -> VoxelModel:
        """The labelled voxels of the structure."""
        return label_voxels(structure, self.samples, self.config.voxels, scanner=self.config.scanner)

    @property
    def scanned(self) -> Sequence[PosedSample]:
        """What there is to find one's way by: the scans of the room, before the first the one from its threshold.

        None in a settled room, which has `maps`.
        """
        return self.samples or [sample for sample in [self.threshold] if sample is not None]

    def laser_map(self, height: float) -> LaserMap:
        """What the Hokuyos should see in their plane, at a world z [m]; of a settled room, the one that it keeps."""
        if self.maps:
            return self.maps.lasers
        normals = np.concatenate([sample.normals_in_world for sample in self.scanned])
        return laser_map(self.points, normals, height=height, parameters=self.config.navigation.localisation)

    def grid(self, floor_height: float) -> OccupancyGrid:
        """Where the robot can stand and drive; a settled room keeps to the floor that it was settled with [m]."""
        return occupancy_grid(
            self.maps.floor if self.maps else self._scanned_floor(floor_height),
            lasers=self.lasers,
            passing=self.passing,
            robot_poses=self.robot_poses,
            footprint=self.footprint,
            scanner=self.config.scanner,
            parameters=self.config.navigation.grid,
        )

    def plan(
        self,
        structure: Structure,
        voxels: VoxelModel,
        grid: OccupancyGrid,
        *,
        world_from_base: Pose,
        base_from_scanner: Pose,
        seed: Sequence[int] = (0,),
    ) -> Plan:
        """Where to scan next, or why the room is done; the seed is for a choice by chance."""
        return plan_next_scan(
            voxels,
            self.points,
            grid,
            world_from_base=world_from_base,
            base_from_scanner=base_from_scanner,
            scanners_in_world=self._scanners_in_world,
            failed_in_world=np.array(self.rejected_in_world).reshape(-1, 3),
            floor_height=structure.floor_height,
            room=structure.polygon,
            footprint=self.footprint,
            scanner=self.config.scanner,
            navigation=self.config.navigation,
            parameters=self.config.planning,
            seed=seed,
        )

    def _scanned_floor(self, floor_height: float) -> ScannedFloor:
        parameters = self.config.navigation.grid
        return scanned_floor(self.points, self._scanners_in_world, floor_height=floor_height, parameters=parameters)

    @property
    def _scanners_in_world(self) -> NDArray[np.float64]:
        return np.array([sample.scanner_in_world for sample in self.scanned])

    @property
    def points(self) -> NDArray[np.float32]:
        """(N, 3) of all scans, thinned, in the room's frame [m]."""
        return np.concatenate([sample.points_in_world for sample in self.scanned])
