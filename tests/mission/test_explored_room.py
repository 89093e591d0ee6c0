"""What the stages of a room are told."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import mission.explored_room
from mission.config import MissionConfig
from mission.explored_room import ExploredRoom
from mission.registration import Registrar
from sim.scan import ScannerParameters
from tests.mission.driving_world import FOOTPRINT, pose
from tests.mission.test_visibility import scan


def test_every_stage_believes_in_the_scanner_that_scans(monkeypatch: pytest.MonkeyPatch) -> None:
    believed: dict[str, ScannerParameters] = {}
    for stage in ("find_structure", "label_voxels", "grid_from_scans", "plan_next_scan"):

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
