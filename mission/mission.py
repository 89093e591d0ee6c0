"""The mission: scan, photograph, register, plan, drive, until the room is complete; then find its doors."""

from __future__ import annotations

from collections.abc import Generator, Iterator
from dataclasses import replace
from functools import partial
from types import TracebackType
from typing import Any, Literal, Self

import numpy as np
from numpy.typing import NDArray

from detector.detect import detect_doors
from mission.colouring import colour_scan
from mission.config import MissionConfig
from mission.driving import drive
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
    Registered,
    Remarked,
    Scanned,
    Structured,
)
from mission.explored_room import ExploredRoom
from mission.grid import Footprint
from mission.joints import opening
from mission.localisation import localise
from mission.mopad import Mopad
from mission.registration import Registrar
from mission.rigid import Pose, inverted
from mission.samples import place, sample_scan
from mission.stopwatch import Stopwatch
from mission.structure import Structure
from mission.versions import versions
from mission.voxels import VoxelModel, room_from
from sim.scene import Scene

MAX_DETOURS = 3
"""So many ways in a row may end before their goal; then the room is done with what is there."""

NO_ARRIVAL = "ways end early"
"""Reason to stop, beside those of the planner."""


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
        self._mopad = Mopad(scene, config, seed=seed)
        self._registrar = Registrar(config.registration)
        self._room = ExploredRoom(1, Footprint(*self._mopad.robot.footprint), config)
        self._steps = 0
        self._scans = 0

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._mopad.__exit__(kind, error, trace)

    def run(self) -> Iterator[Event]:
        """Carry the mission out, stage by stage.

        Raises:
            MissionError: It cannot go on.
        """
        yield self._started()
        while True:
            yield from self._scan_here()
            structure, voxels = yield from self._understand()
            arrived = yield from self._move_on(structure, voxels)
            if not arrived:
                break
        yield from self._find_doors(structure, voxels)
        yield self.finished("completed", "the room is scanned and its doors are judged")

    def finished(self, outcome: Literal["completed", "interrupted", "failed"], reason: str) -> MissionFinished:
        """The last event, also of a mission that was stopped from outside."""
        return self._event(MissionFinished, outcome=outcome, reason=reason)

    def _started(self) -> MissionStarted:
        robot = self._mopad.robot
        return self._event(
            MissionStarted,
            scene=self._scene.name,
            scene_xml=self._scene.xml,
            seed=self._seed,
            config=self._config.model_dump(mode="json"),
            versions=versions(),
            world_from_base=self._mopad.world_from_base,
            robot=robot.shape(),
            base_from_scanner=robot.base_from_scanner,
            true_doors=self._scene.true_doors(),
        )

    def _scan_here(self) -> Iterator[Event]:
        """Scan, photograph, register and colour at the present pose."""
        self._scans += 1
        mopad, room = self._mopad, self._room
        with self._stopwatch("scan"):
            scan = mopad.scan()
        yield self._event(
            Scanned, scan_number=self._scans, scan=scan, true_world_from_scanner=mopad.true_world_from_scanner
        )
        with self._stopwatch("photograph"):
            photos = mopad.photograph()
        yield self._event(Photographed, scan_number=self._scans, photos=photos)

        guess = mopad.world_from_base @ mopad.robot.base_from_scanner
        with self._stopwatch("register"):
            sample = sample_scan(scan, self._config.samples)
            found = self._registrar.register(sample, guess)
        yield self._event(
            Registered,
            scan_number=self._scans,
            guess_world_from_scanner=guess,
            world_from_scanner=found.world_from_scanner,
            fitness=found.fitness,
            rmse=found.rmse,
            accepted=found.accepted,
            reason=found.reason,
            true_world_from_scanner=mopad.true_world_from_scanner,
        )
        if not found.accepted:
            room.rejected_in_world.append(guess[:3, 3])
            yield self._event(Remarked, level="warning", text=f"scan {self._scans} is left out: {found.reason}")
            return
        mopad.believe(found.world_from_scanner @ inverted(mopad.robot.base_from_scanner))
        self._look_around()
        room.samples.append(place(sample, found.world_from_scanner))
        with self._stopwatch("colour"):
            room.views.append(colour_scan(scan, photos, found.world_from_scanner))
        yield self._event(Coloured, scan_number=self._scans, view=room.views[-1])

    def _understand(self) -> Generator[Event, None, tuple[Structure, VoxelModel]]:
        """Floor, ceiling, walls and voxels of the room as far as it is scanned."""
        with self._stopwatch("structure"):
            structure = self._room.structure()
        yield self._event(Structured, scan_number=self._scans, structure=structure)
        with self._stopwatch("voxels"):
            voxels = self._room.voxels(structure)
        yield self._event(Labelled, scan_number=self._scans, voxels=voxels)
        return structure, voxels

    def _move_on(self, structure: Structure, voxels: VoxelModel) -> Generator[Event, None, bool]:
        """Choose the next best scan and drive there; a way that ends early leads to a new plan.

        Returns:
            Whether the robot stands where it is to scan next; if not, the room is complete.
        """
        mopad = self._mopad
        for _ in range(MAX_DETOURS):
            with self._stopwatch("plan"):
                grid = self._room.grid(structure)
                plan = self._room.plan(
                    structure,
                    voxels,
                    grid,
                    world_from_base=mopad.world_from_base,
                    base_from_scanner=mopad.robot.base_from_scanner,
                    seed=(self._seed, self._steps),
                )
            yield self._event(Planned, scan_number=self._scans, plan=plan, grid=grid)
            if plan.path is None:
                return False
            with self._stopwatch("drive"):
                drove = self._drive(plan.path, structure.floor_height)
            yield drove
            if drove.arrived:
                return True
        stopped = replace(plan, chosen=None, path=None, stop_reason=NO_ARRIVAL)
        yield self._event(Planned, scan_number=self._scans, plan=stopped, grid=grid)
        return False

    def _drive(self, path: NDArray[np.float64], floor_height: float) -> Drove:
        """Drive along a path as far as it goes, matching the Hokuyos with the room on the way."""
        mopad, navigation = self._mopad, self._config.navigation
        truth: list[Pose] = []
        angles: list[list[float]] = []

        def watch() -> None:
            truth.append(mopad.robot.true_world_from_base)
            angles.append([opening(door) for door in self._scene.true_doors()])

        laser_height = mopad.robot.base_from_lasers[0][2, 3]
        laser_map = self._room.laser_map(floor_height + laser_height)
        leg = drive(
            mopad.robot,
            path,
            mopad.measure_lasers,
            world_from_odometry=mopad.world_from_odometry,
            footprint=self._room.footprint,
            parameters=navigation.driving,
            localise=partial(localise, laser_map, parameters=navigation.localisation),
            watch=watch,
        )
        mopad.believe(leg.world_from_base[-1])
        if not leg.arrived:  # what stopped it must be on the map; after an arrival the next scan tells more
            self._room.lasers += zip(leg.laser_scans, leg.world_from_base_at_laser, strict=True)
            self._look_around()
        return self._event(
            Drove,
            planned_path=path,
            times=leg.times,
            world_from_base=leg.world_from_base,
            laser_scans=leg.laser_scans,
            outcome=leg.outcome,
            reason=leg.reason,
            true_world_from_base=np.array(truth),
            true_door_angles=np.array(angles),
        )

    def _look_around(self) -> None:
        """Note where the robot stands and what the Hokuyos see there."""
        world_from_base = self._mopad.world_from_base
        self._room.robot_poses.append(world_from_base)
        self._room.lasers += [(scan, world_from_base) for scan in self._mopad.measure_lasers()]

    def _find_doors(self, structure: Structure, voxels: VoxelModel) -> Iterator[Event]:
        """Hand the completed room to the detector; compare what it found with the joints."""
        room = self._room
        with self._stopwatch("detect"):
            results = tuple(detect_doors(room_from(structure, voxels, room.views), self._config.detector))
        yield self._event(
            DoorsDetected,
            results=results,
            floor_height=structure.floor_height,
            ceiling_height=structure.ceiling_height,
        )
        with self._stopwatch("evaluate"):
            doors, missed = evaluate(results, self._scene.true_doors(), room=room.number, outline=structure.polygon)
        yield self._event(DoorsEvaluated, doors=doors, missed=missed)

    def _event(self, kind: type[Any], **content: Any) -> Any:
        event = kind(step=self._steps, time=self._mopad.time, room=self._room.number, **content)
        self._steps += 1
        return event
