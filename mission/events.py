"""The mission as a stream of events: one frozen dataclass a stage; every sink reads these and nothing else.

Fields named `true_...` come from the simulator. They ride beside the estimates for evaluation and review; no stage
of the mission reads them back.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray

from mission.rigid import Pose

if TYPE_CHECKING:  # events are plain data: making one must not import mujoco, open3d or sklearn
    from detector.result import WallResult
    from detector.room import View
    from mission.door_faces import DoorFace
    from mission.evaluation import DoorEvaluation
    from mission.occupancy import Footprint, OccupancyGrid
    from mission.planning import Plan
    from mission.pose_graph import Link
    from mission.structure import Structure
    from mission.voxels import VoxelModel
    from sim.door_truth import DoorTruth
    from sim.guardian import RobotShape
    from sim.laser_scan import LaserScan
    from sim.photo import Photo
    from sim.scan import Scan


@dataclass(frozen=True)
class Cost:
    """What the mission took of this machine so far: for people, not part of any result."""

    stage_seconds: tuple[tuple[str, float], ...]
    """Wall clock time of each stage [s]."""
    peak_memory: int
    """Largest resident set of the process [bytes]."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Event:
    """Something that happened in the mission."""

    step: int
    """Counts events from 0."""
    time: int
    """Mission time: simulated time since the start [ns]."""
    room: int = 1
    """Room that the robot is in, from 1."""
    cost: Cost | None = None
    """Told at the end of each scan, when doors were compared, and at the end of the mission; not in the MCAP."""


@dataclass(frozen=True, kw_only=True, eq=False)
class MissionStarted(Event):
    """The robot stands at its start pose."""

    scene: str
    """File name of the scene."""
    scene_xml: str
    """The scene file as it was read."""
    seed: int
    config: dict[str, object]
    """Every parameter of the mission, JSON-compatible."""
    versions: dict[str, str]
    """Version of each package that the result depends on."""
    world_from_base: Pose
    """Start pose, known."""
    robot: RobotShape
    footprint: Footprint
    base_from_scanner: Pose
    true_doors: tuple[DoorTruth, ...]


@dataclass(frozen=True, kw_only=True, eq=False)
class RoomEntered(Event):
    """The robot stands where it is to scan a room for the first time.

    Everything that is measured in a room is in the room's own frame, which is the map's as the robot believed it here.
    """

    how: Literal["start", "door", "set down"]
    door: str | None
    """The door that it came through, as the room before has it: "1.2-a"."""
    before: int | None
    """Number of the room before; None if it was set down."""
    world_from_room: Pose
    """Where the room's frame lies in the map, as far as is known."""
    world_from_base: Pose
    """Where the robot believes to be, in the room's frame."""
    true_world_from_base: Pose


@dataclass(frozen=True, kw_only=True, eq=False)
class RoomsTied(Event):
    """A completed room was linked to the others: the graph of rooms and doors, and where every room lies."""

    world_from_room: dict[int, Pose]
    """(4, 4) of each room that was entered."""
    links: tuple[Link, ...]
    """All links so far, those by doors and those by scans."""
    faces: tuple[DoorFace, ...]
    """All doors so far, from each side from which they were seen, in the frames of their rooms."""
    exits: tuple[str, ...]
    """Doors of the room that the robot can drive through."""
    refused: tuple[tuple[str, str], ...]
    """The others, and why not."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Scanned(Event):
    """The scanner delivered a panorama."""

    scan_number: int
    """Counts scans of the mission from 1."""
    scan: Scan
    true_world_from_scanner: Pose


@dataclass(frozen=True, kw_only=True, eq=False)
class Photographed(Event):
    """The camera turned once round and delivered its photographs."""

    scan_number: int
    photos: tuple[Photo, ...]


@dataclass(frozen=True, kw_only=True, eq=False)
class Registered(Event):
    """The scan found its place in the map."""

    scan_number: int
    guess_world_from_scanner: Pose
    """From odometry."""
    world_from_scanner: Pose
    """After registration."""
    fitness: float
    """Share of the sampled points with a partner in the map; 1 for the first scan."""
    rmse: float
    """Point-to-plane residual of the partners [m]; 0 for the first scan."""
    accepted: bool
    reason: str
    """Why the registration was taken or rejected."""
    true_world_from_scanner: Pose


@dataclass(frozen=True, kw_only=True, eq=False)
class Coloured(Event):
    """The scan's points took their colours from the photographs."""

    scan_number: int
    view: View


@dataclass(frozen=True, kw_only=True, eq=False)
class Structured(Event):
    """Floor, ceiling and walls of the room as far as it is scanned."""

    scan_number: int
    structure: Structure


@dataclass(frozen=True, kw_only=True, eq=False)
class Labelled(Event):
    """The voxels of the room have their labels."""

    scan_number: int
    voxels: VoxelModel


@dataclass(frozen=True, kw_only=True, eq=False)
class Planned(Event):
    """The next best scan was chosen, or the room found complete."""

    scan_number: int
    """Scan that the plan follows on."""
    plan: Plan
    grid: OccupancyGrid


@dataclass(frozen=True, kw_only=True, eq=False)
class Drove(Event):
    """The robot drove a leg of its way; an event comes at its end."""

    planned_path: NDArray[np.float64]
    """(P, 2) way points in the world [m]."""
    times: NDArray[np.int64]
    """(T,) mission time of each pose [ns]."""
    world_from_base: NDArray[np.float64]
    """(T, 4, 4) poses as odometry has them."""
    laser_scans: tuple[LaserScan, ...]
    """Some of the Hokuyo scans of the leg."""
    outcome: Literal["arrived", "blocked", "stuck", "contact"]
    reason: str
    """The outcome in words."""
    true_world_from_base: NDArray[np.float64]
    """(T, 4, 4)."""
    true_door_angles: NDArray[np.float64]
    """(T, D) joint state of each door of `MissionStarted.true_doors` against closed [rad or m]."""

    @property
    def arrived(self) -> bool:
        """Whether the robot stands at the end of its path."""
        return self.outcome == "arrived"


@dataclass(frozen=True, kw_only=True, eq=False)
class DoorsDetected(Event):
    """The detector judged the completed room."""

    results: tuple[WallResult, ...]
    """One a wall, in the order of the structure's walls."""
    floor_height: float
    ceiling_height: float | None


@dataclass(frozen=True, kw_only=True, eq=False)
class DoorsEvaluated(Event):
    """The detected doors were compared with the true ones."""

    doors: tuple[DoorEvaluation, ...]
    """One a detected door."""
    missed: tuple[str, ...]
    """Names of the doors of this room that were not found."""
    true_doors: tuple[DoorTruth, ...]
    """All doors of the scene, as they stood."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Remarked(Event):
    """Something worth telling a person."""

    level: Literal["info", "warning"]
    text: str


@dataclass(frozen=True, kw_only=True, eq=False)
class MissionFinished(Event):
    """The mission ended, one way or another."""

    outcome: Literal["completed", "interrupted", "failed"]
    reason: str
