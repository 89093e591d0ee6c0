"""What the stages of a room are told."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import mission.explored_room
from mission.colouring import colour_scan
from mission.config import MissionConfig
from mission.explored_room import ExploredRoom
from mission.registration import Registrar
from mission.samples import place, sample_scan
from mission.views import ColouredScan
from sim.scan import ScannerParameters
from tests.mission import boxroom
from tests.mission.driving_world import FOOTPRINT, pose
from tests.mission.test_visibility import scan


def test_every_stage_believes_in_the_scanner_that_scans(monkeypatch: pytest.MonkeyPatch) -> None:
    believed: dict[str, ScannerParameters] = {}
    for stage in ("find_structure", "label_voxels", "occupancy_grid", "plan_next_scan"):

        def noted(*_: Any, stage: str = stage, scanner: ScannerParameters, **__: Any) -> Any:
            believed[stage] = scanner
            return _Anything()

        monkeypatch.setattr(mission.explored_room, stage, noted)
    scanner = ScannerParameters(min_range=0.7)
    samples = [scan((1.0, 0.0, 0.0))]
    room = ExploredRoom(1, FOOTPRINT, MissionConfig(scanner=scanner), Registrar(), samples=samples)
    structure = room.structure()
    voxels, grid = room.voxels(structure), room.grid(structure.floor_height)
    room.plan(structure, voxels, grid, world_from_base=pose(0, 0), base_from_scanner=np.eye(4))
    assert len(believed) == 4 and all(told is scanner for told in believed.values())


class _Anything:
    """A structure, voxels or grid of which nobody asks more than its floor and outline."""

    floor_height, polygon = 0.0, None


def test_a_closed_room_keeps_what_one_finds_ones_way_by_and_no_image() -> None:
    place_of_scan = boxroom.pose(3, 2)
    taken = boxroom.scan(boxroom.plain_room(), place_of_scan)
    coloured = ColouredScan.of(taken, colour_scan(taken, [], place_of_scan), place_of_scan)
    sample = place(sample_scan(taken), place_of_scan)
    room = ExploredRoom(1, FOOTPRINT, MissionConfig(), Registrar(), samples=[sample], coloured=[coloured])
    room.close()

    assert room.coloured == [] and room.samples[0].sample.ranges.size == 0
    assert np.array_equal(room.points, sample.points_in_world)
    assert np.array_equal(room.samples[0].sample.points, sample.sample.points)


def test_a_settled_room_has_the_maps_of_its_scans_and_not_the_scans() -> None:
    place_of_scan = boxroom.pose(3, 2)
    sample = place(sample_scan(boxroom.scan(boxroom.plain_room(), place_of_scan)), place_of_scan)
    room = ExploredRoom(1, FOOTPRINT, MissionConfig(), Registrar(), samples=[sample], robot_poses=[place_of_scan])
    grid, lasers = room.grid(0.0), room.laser_map(0.5)
    room.settle(floor_height=0.0, laser_height=0.5)

    assert room.samples == []
    assert np.array_equal(room.grid(0.0).cells, grid.cells) and np.array_equal(room.grid(0.0).origin, grid.origin)
    assert len(lasers.points) > 100 and np.array_equal(room.laser_map(0.5).points, lasers.points)
    assert np.array_equal(room.laser_map(0.5).normals, lasers.normals)
