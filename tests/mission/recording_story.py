"""A small mission made by hand, with every kind of event: what the recordings' tests tell and read back."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mission import events
from mission.occupancy import Footprint
from sim.door_truth import DoorTruth
from sim.guardian import RobotShape
from sim.laser_scan import LaserScan
from sim.scan import Scan
from tests.mission import recording_room as made

SECOND = 1_000_000_000


class Story(list[events.Event]):
    """Events in the order they are told."""

    def tell(self, kind: type[events.Event], seconds: float, **fields: Any) -> None:
        """Add an event at a mission time."""
        self.append(kind(step=len(self), time=int(seconds * SECOND), **fields))


def story(count: int = 2000) -> Story:
    """Two scans of `count` points, a drive between them, detection, evaluation, the end."""
    rng = np.random.default_rng(5)
    told = Story()
    walls = made.walls()
    tell_start(told)
    tell_scan(told, 1, made.pose(2, 2, 1.2), seconds=80, view=made.view(rng, count))
    tell_plan(told, 1, seconds=90)
    tell_drive(told)
    tell_scan(told, 2, made.pose(4, 2, 1.2), seconds=160, view=made.view(rng, count))
    tell_plan(told, 2, seconds=170)
    told.tell(events.Remarked, 171, level="warning", text='the store\'s door is "shut"')
    doors = ((), (made.door(angle=made.ESTIMATE),), (made.door(angle=0.0),), ())
    results = tuple(made.wall_result(wall, found) for wall, found in zip(walls, doors, strict=True))
    told.tell(events.DoorsDetected, 172, results=results, floor_height=0.0, ceiling_height=2.7)
    judged = (
        made.evaluation(walls[1], 2, doors[1][0], name="hall/door 1", angle=made.JOINT),
        made.evaluation(walls[2], 3, doors[2][0], name="store", angle=0.0),
    )
    told.tell(
        events.RoomsTied,
        172,
        world_from_room={1: np.eye(4), 2: made.pose(0.1, 0)},
        links=(made.link(),),
        faces=made.faces(walls[1], doors[1][0]),
        exits=("1.2-a",),
        refused=(("1.3-a", "open by 0.00 m, 0.71 m needed"),),
    )
    told.tell(events.DoorsEvaluated, 172, doors=judged, missed=("lift",), true_doors=true_doors())
    told.tell(events.MissionFinished, 172, outcome="completed", reason="one room")
    return told


def tell_start(told: Story) -> None:
    """A robot of four triangles, at (2, 2)."""
    corners = np.array([[0.3, 0, 0.2], [-0.3, 0.3, 0.2], [-0.3, -0.3, 0.2], [0, 0, 1.2]], np.float32)
    faces = np.array([[0, 1, 2], [0, 1, 3], [1, 2, 3], [2, 0, 3]], np.int32)
    told.tell(
        events.MissionStarted,
        0,
        scene="made_up.xml",
        scene_xml="<mujoco/>",
        seed=3,
        config={"scanner": {"noise": True}},
        versions={"numpy": "2.0"},
        world_from_base=made.pose(2, 2),
        robot=RobotShape(corners, faces, np.full((4, 3), 90, np.uint8)),
        footprint=Footprint(1.0, 0.6),
        base_from_scanner=made.pose(0, 0, 1.2),
        true_doors=true_doors(),
    )
    here = made.pose(2, 2)
    told.tell(
        events.RoomEntered,
        0,
        how="start",
        door=None,
        before=None,
        world_from_room=np.eye(4),
        world_from_base=here,
        true_world_from_base=here,
    )


def true_doors() -> tuple[DoorTruth, ...]:
    """A hinged door in each of two walls, one that slides in the last."""
    _, hall, store, lift = made.walls()
    return (
        made.true_door("hall/door 1", hall, angle=made.JOINT),
        made.true_door("store", store, angle=0.0),
        made.true_door("lift", lift, way=0.5),
    )


def tell_scan(told: Story, number: int, place: NDArray[np.float64], *, seconds: float, view: made.View) -> None:
    """Scan, photographs, registration, colours."""
    ranges = np.full((20, 30), 3.0, np.float32)
    ranges[3, 4] = np.nan
    scan = Scan(np.linspace(0.5, -0.5, 20), np.linspace(0, 6.2, 30), ranges, ranges - 8, duration=80.0)
    told.tell(events.Scanned, seconds, scan_number=number, scan=scan, true_world_from_scanner=place)
    told.tell(events.Photographed, seconds + 5, scan_number=number, photos=(made.photo(), made.photo()))
    told.tell(
        events.Registered,
        seconds + 5,
        scan_number=number,
        guess_world_from_scanner=place @ made.pose(0.01, 0),
        world_from_scanner=place,
        fitness=0.97,
        rmse=0.004,
        accepted=True,
        reason="fits",
        true_world_from_scanner=place,
    )
    told.tell(events.Coloured, seconds + 5, scan_number=number, view=view)


def tell_plan(told: Story, number: int, *, seconds: float) -> None:
    """Structure, voxels, plan; the second scan is the last."""
    told.tell(events.Structured, seconds, scan_number=number, structure=made.structure())
    told.tell(events.Labelled, seconds, scan_number=number, voxels=made.voxels())
    told.tell(events.Planned, seconds, scan_number=number, plan=made.plan(last=number == 2), grid=made.grid())


def tell_drive(told: Story) -> None:
    """Two metres ahead in five seconds; the wheels believe a centimetre more."""
    seconds = np.linspace(95, 100, 26)
    true = np.array([made.pose(2 + 0.4 * (t - 95), 2) for t in seconds])
    ranges = np.full(682, 1.5, np.float32)
    ranges[::7] = np.nan
    laser = LaserScan(made.pose(0.4, 0, 0.3), np.linspace(-2, 2, 682), ranges, int(seconds[-1] * SECOND))
    told.tell(
        events.Drove,
        100,
        planned_path=np.array([[2, 2], [4, 2]], float),
        times=(seconds * SECOND).astype(np.int64),
        world_from_base=true + made.pose(0.01, 0) - np.eye(4),
        laser_scans=(laser,),
        outcome="arrived",
        reason="reached the end of the path",
        true_world_from_base=true,
        true_door_angles=np.tile([made.JOINT, 0.0, 0.5], (26, 1)),
    )


def bare_story() -> Story:
    """A mission in which there is next to nothing: no true doors, no photographs, no way, no candidates, no walls."""
    told = story()
    structure = replace(made.structure(), walls=(), ceiling_height=None)
    nothing = np.zeros(0)
    changes: dict[type[events.Event], dict[str, Any]] = {
        events.MissionStarted: {"true_doors": ()},
        events.Photographed: {"photos": ()},
        events.Coloured: {"view": made.view(np.random.default_rng(0), 0)},
        events.Structured: {"structure": structure},
        events.Planned: {"plan": replace(made.plan(last=True), candidates=())},
        events.Drove: {
            "times": nothing.astype(np.int64),
            "world_from_base": np.zeros((0, 4, 4)),
            "true_world_from_base": np.zeros((0, 4, 4)),
            "true_door_angles": np.zeros((0, 0)),
            "laser_scans": (),
            "planned_path": np.zeros((0, 2)),
        },
        events.DoorsDetected: {"results": (), "ceiling_height": None},
        events.DoorsEvaluated: {"doors": (), "missed": ()},
    }
    return Story(replace(event, **changes.get(type(event), {})) for event in told)
