"""The mission: scan, photograph, register, plan, drive, until the room is complete; then find its doors."""

from __future__ import annotations

from collections.abc import Generator, Iterator
from dataclasses import dataclass, field
from functools import partial
from types import TracebackType
from typing import Any, Literal, Self

import numpy as np
from numpy.typing import NDArray

from detector.detect import detect_doors
from detector.room import View
from mission.colouring import colour_scan
from mission.config import MissionConfig
from mission.driving import Drive, drive
from mission.evaluation import evaluate
from mission.events import (
    Coloured,
    DoorsDetected,
    DoorsEvaluated,
    Drove,
    Event,
    Labelled,
    MissionFinished,
    MissionStarted,
    Photographed,
    Planned,
    Pose,
    Registered,
    Remarked,
    Scanned,
    Structured,
)
from mission.grid import Footprint, OccupancyGrid, grid_from_scans
from mission.planning import Plan, plan_next_scan
from mission.registration import Registrar
from mission.samples import PosedSample, place, sample_scan
from mission.stopwatch import Stopwatch
from mission.structure import Structure, find_structure
from mission.versions import versions
from mission.voxels import VoxelModel, label_voxels, room_from
from sim.camera import Camera
from sim.hokuyo import Hokuyo, LaserScan
from sim.render import Renderer
from sim.robot import Robot
from sim.scanner import Scanner
from sim.scene import Scene

SECONDS_PER_PHOTO = 4.0
"""Turning on and charging the flash: our assumption; Riegl and Nikon give no figure [s]."""

MAX_DETOURS = 3
"""So many ways in a row may end before their goal; then the room is done with what is there."""


@dataclass
class Room:
    """What the robot knows of the room that it is in: estimates only."""

    number: int
    views: list[View] = field(default_factory=list)
    samples: list[PosedSample] = field(default_factory=list)
    lasers: list[tuple[LaserScan, Pose]] = field(default_factory=list)
    robot_poses: list[Pose] = field(default_factory=list)
    structure: Structure | None = None
    voxels: VoxelModel | None = None

    @property
    def scanners_in_world(self) -> NDArray[np.float64]:
        """(S, 3) where was scanned [m]."""
        return np.array([sample.scanner_in_world for sample in self.samples])

    @property
    def points_in_world(self) -> NDArray[np.float32]:
        """(N, 3) thinned points of all scans [m]."""
        return np.concatenate([sample.points_in_world for sample in self.samples])


class Mission:
    """One mission in a scene; `run` yields its events.

    The simulator's truth (poses, joints) goes into events only: no stage reads it.
    """

    def __init__(self, scene: Scene, config: MissionConfig, *, seed: int, stopwatch: Stopwatch | None = None) -> None:
        """Set the robot up in the scene.

        Args:
            scene: With the robot at its start.
            config: Parameters of all stages.
            seed: Of all noise.
            stopwatch: Counts the time of each stage.
        """
        self._scene, self._config, self._seed = scene, config, seed
        self._stopwatch = stopwatch or Stopwatch()
        scanner, camera, hokuyo, robot = (np.random.default_rng(s) for s in np.random.SeedSequence(seed).spawn(4))
        self._renderer = Renderer(scene.model, hidden_bodies=scene.robot_bodies)
        self._scan = partial(Scanner(self._renderer, config.scanner).scan, scene.data, rng=scanner)
        self._photograph = partial(Camera(self._renderer, config.camera).photograph, scene.data, rng=camera)
        self._hokuyo, self._hokuyo_rng = Hokuyo(scene.model, scene.robot_bodies, config.hokuyo), hokuyo
        self._robot = Robot(scene, config.robot, robot)
        self._footprint = Footprint(*self._robot.footprint)
        self._registrar = Registrar(config.registration)
        self._world_from_odometry: Pose = np.eye(4)
        self._room = Room(1)
        self._steps = 0
        self._scans = 0

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._renderer.close()

    def run(self) -> Iterator[Event]:
        """Carry the mission out, stage by stage.

        Raises:
            MissionError: It cannot go on.
        """
        yield self._started()
        complete = False
        while not complete:
            yield from self._scan_here()
            yield from self._understand()
            complete = yield from self._move_on()
        yield from self._find_doors()
        yield self.finished("completed", "the room is scanned and its doors are judged")

    def finished(self, outcome: Literal["completed", "interrupted", "failed"], reason: str) -> MissionFinished:
        """The last event, also of a mission that was stopped from outside."""
        return self._event(MissionFinished, outcome=outcome, reason=reason)

    def _started(self) -> MissionStarted:
        robot = self._robot
        self._look_around(self._base())
        return self._event(
            MissionStarted,
            scene=self._scene.name,
            scene_xml=self._scene.xml,
            seed=self._seed,
            config=self._config.model_dump(mode="json"),
            versions=versions(),
            world_from_base=self._base(),
            robot=robot.shape(),
            base_from_scanner=robot.base_from_scanner,
            true_doors=self._scene.true_doors(),
        )

    def _scan_here(self) -> Iterator[Event]:
        """Scan, photograph, register and colour at the present pose."""
        self._scans += 1
        number, truth = self._scans, self._robot.true_world_from_base @ self._robot.base_from_scanner
        with self._stopwatch("scan"):
            scan = self._scan(world_from_scanner=truth)
        self._robot.wait(scan.duration)
        yield self._event(Scanned, scan_number=number, scan=scan, true_world_from_scanner=truth)

        with self._stopwatch("photograph"):
            photos = self._photograph(world_from_scanner=truth)
        self._robot.wait(SECONDS_PER_PHOTO * len(photos))
        yield self._event(Photographed, scan_number=number, photos=photos)

        guess = self._base() @ self._robot.base_from_scanner
        with self._stopwatch("register"):
            sample = sample_scan(scan, self._config.samples)
            found = self._registrar.register(sample, guess)
        yield self._event(
            Registered,
            scan_number=number,
            guess_world_from_scanner=guess,
            world_from_scanner=found.world_from_scanner,
            fitness=found.fitness,
            rmse=found.rmse,
            accepted=found.accepted,
            reason=found.reason,
            true_world_from_scanner=truth,
        )
        if not found.accepted:
            yield self._event(Remarked, level="warning", text=f"scan {number} is left out: {found.reason}")
            return
        self._correct(found.world_from_scanner)
        self._room.samples.append(place(sample, found.world_from_scanner))

        with self._stopwatch("colour"):
            self._room.views.append(colour_scan(scan, photos, found.world_from_scanner))
        yield self._event(Coloured, scan_number=number, view=self._room.views[-1])

    def _understand(self) -> Iterator[Event]:
        """Floor, ceiling, walls and voxels of the room as far as it is scanned."""
        room = self._room
        with self._stopwatch("structure"):
            room.structure = find_structure(room.samples, self._config.structure)
        yield self._event(Structured, scan_number=self._scans, structure=room.structure)
        with self._stopwatch("voxels"):
            room.voxels = label_voxels(room.structure, room.samples, self._config.voxels)
        yield self._event(Labelled, scan_number=self._scans, voxels=room.voxels)

    def _move_on(self) -> Generator[Event, None, bool]:
        """Choose the next best scan and drive there; a way that ends early leads to a new plan.

        Returns:
            Whether the room is complete.
        """
        for _ in range(MAX_DETOURS):
            with self._stopwatch("plan"):
                grid, plan = self._plan()
            yield self._event(Planned, scan_number=self._scans, plan=plan, grid=grid)
            if plan.path is None:
                return True
            with self._stopwatch("drive"):
                drove = self._drive(plan.path)
            yield drove
            if drove.arrived:
                return False
        yield self._event(Remarked, level="warning", text=f"gave up after {MAX_DETOURS} ways that ended early")
        return True

    def _plan(self) -> tuple[OccupancyGrid, Plan]:
        room, config = self._room, self._config
        assert room.structure is not None and room.voxels is not None
        grid = grid_from_scans(
            room.points_in_world,
            room.scanners_in_world,
            floor_height=room.structure.floor_height,
            lasers=room.lasers,
            robot_poses=room.robot_poses,
            footprint=self._footprint,
            parameters=config.navigation.grid,
        )
        plan = plan_next_scan(
            room.voxels,
            room.points_in_world,
            grid,
            world_from_base=self._base(),
            base_from_scanner=self._robot.base_from_scanner,
            scanners_in_world=room.scanners_in_world,
            floor_height=room.structure.floor_height,
            room=room.structure.polygon,
            footprint=self._footprint,
            navigation=config.navigation,
            parameters=config.planning,
        )
        return grid, plan

    def _drive(self, path: NDArray[np.float64]) -> Drove:
        """Drive along a path as far as it goes."""
        truth: list[Pose] = []
        angles: list[list[float]] = []

        def watch() -> None:
            truth.append(self._robot.true_world_from_base)
            angles.append([_opening(door) for door in self._scene.true_doors()])

        leg: Drive = drive(
            self._robot,
            path,
            self._measure_lasers,
            world_from_odometry=self._world_from_odometry,
            footprint=self._footprint,
            parameters=self._config.navigation.driving,
            watch=watch,
        )
        self._room.lasers += zip(leg.laser_scans, leg.world_from_base_at_laser, strict=True)
        self._look_around(self._base())
        return self._event(
            Drove,
            planned_path=path,
            times=leg.times,
            world_from_base=leg.world_from_base,
            laser_scans=leg.laser_scans,
            arrived=leg.arrived,
            reason=leg.reason,
            true_world_from_base=np.array(truth),
            true_door_angles=np.array(angles),
        )

    def _find_doors(self) -> Iterator[Event]:
        """Hand the completed room to the detector; compare what it found with the joints."""
        room = self._room
        assert room.structure is not None and room.voxels is not None
        with self._stopwatch("detect"):
            results = tuple(detect_doors(room_from(room.structure, room.voxels, room.views), self._config.detector))
        yield self._event(
            DoorsDetected,
            results=results,
            floor_height=room.structure.floor_height,
            ceiling_height=room.structure.ceiling_height,
        )
        with self._stopwatch("evaluate"):
            doors, missed = evaluate(results, self._scene.true_doors(), room=room.number)
        yield self._event(DoorsEvaluated, doors=doors, missed=missed)

    def _base(self) -> Pose:
        """Where the robot believes to be, world_from_base."""
        return self._world_from_odometry @ self._robot.odometry

    def _correct(self, world_from_scanner: Pose) -> None:
        """Take the pose of a registered scan over into the odometry."""
        world_from_base = world_from_scanner @ np.linalg.inv(self._robot.base_from_scanner)
        self._world_from_odometry = world_from_base @ np.linalg.inv(self._robot.odometry)

    def _look_around(self, world_from_base: Pose) -> None:
        """Note where the robot stands and what the Hokuyos see there."""
        self._room.robot_poses.append(world_from_base)
        self._room.lasers += [(scan, world_from_base) for scan in self._measure_lasers()]

    def _measure_lasers(self) -> list[LaserScan]:
        return [
            self._hokuyo.measure(
                self._scene.data,
                self._robot.true_world_from_base @ base_from_laser,
                base_from_laser=base_from_laser,
                rng=self._hokuyo_rng,
                time=self._now(),
            )
            for base_from_laser in self._robot.base_from_lasers
        ]

    def _now(self) -> int:
        """Mission time [ns]."""
        return round(self._robot.time * 1e9)

    def _event(self, kind: type[Any], **content: Any) -> Any:
        event = kind(step=self._steps, time=self._now(), room=self._room.number, **content)
        self._steps += 1
        return event


def _opening(door: Any) -> float:
    """Opening of the wider leaf, as an angle [rad], or of a sliding one [m]."""
    openings = [leaf.opening if np.isnan(leaf.opening_angle) else leaf.opening_angle for leaf in door.leaves]
    return float(max(openings))
