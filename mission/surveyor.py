"""The work in one room, stage by stage: scan, photograph, register, understand, plan, drive. Each stage is an event."""

from __future__ import annotations

from collections.abc import Generator, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from mission.colouring import colour_scan
from mission.config import MissionConfig
from mission.driving import drive
from mission.events import (
    Coloured,
    Cost,
    DoorsEvaluated,
    Drove,
    Event,
    Labelled,
    MissionFinished,
    Photographed,
    Planned,
    Registered,
    Remarked,
    Scanned,
    Structured,
)
from mission.explored_room import ExploredRoom
from mission.localisation import localise
from mission.memory import peak_memory
from mission.registration import Registration
from mission.rigid import Pose, inverted
from mission.samples import place
from mission.stopwatch import Stopwatch
from mission.structure import Structure
from mission.views import ColouredScan
from mission.voxels import VoxelModel
from sim.laser_scan import LaserScan
from sim.scan import Scan

if TYPE_CHECKING:
    from mission.mopad import Mopad

MAX_DETOURS = 3
"""So many ways in a row may end before their goal; then the room is done with what is there."""

NO_ARRIVAL = "ways end early"
"""Reason to stop, beside those of the planner."""

_COSTED = {Planned, DoorsEvaluated, MissionFinished}
"""Events that tell what the mission took so far."""


class Surveyor:
    """Does what a room needs with the robot, and tells of it in events.

    The simulator's truth (poses, joints) goes into events only: no stage reads it.
    """

    def __init__(self, mopad: Mopad, config: MissionConfig, stopwatch: Stopwatch, *, seed: int) -> None:
        self._mopad, self._config, self._stopwatch = mopad, config, stopwatch
        self._seed = seed
        self._steps = 0
        self._scans = 0
        self.room = 1
        """Number of the room that events belong to."""

    def event(self, kind: type[Any], *, room: int | None = None, **content: Any) -> Any:
        """The next event, of now, and of the room that the robot is in or of another."""
        place = {"step": self._steps, "time": self._mopad.time, "room": self.room if room is None else room}
        event = kind(**place, cost=self._cost(kind), **content)
        self._steps += 1
        return event

    def again(self, recorded: Event) -> Event:
        """A recorded event as the next one."""
        event = replace(recorded, step=self._steps, cost=self._cost(type(recorded)))
        self._steps += 1
        return event

    def _cost(self, kind: type[Event]) -> Cost | None:
        return Cost(tuple(self._stopwatch.seconds.items()), peak_memory()) if kind in _COSTED else None

    def remark(self, text: str) -> Remarked:
        """Something that a person should know."""
        remarked: Remarked = self.event(Remarked, level="warning", text=text)
        return remarked

    def survey(
        self, room: ExploredRoom, *, photograph: bool = True
    ) -> Generator[Event, None, tuple[Structure, VoxelModel]]:
        """Scan a room from place to place until there is no more to gain.

        Args:
            room: To be scanned; the robot stands in it.
            photograph: Whether to take colours, too; the plan does not depend on them.

        Raises:
            MissionError: There is no room.
        """
        while True:
            yield from self.scan_here(room, photograph=photograph)
            structure, voxels = yield from self.understand(room)
            arrived = yield from self._move_on(room, structure, voxels)
            if not arrived:
                return structure, voxels

    def scan_threshold(self, room: ExploredRoom, into: ExploredRoom) -> Generator[Event, None, bool]:
        """Scan from the doorway between two rooms; the scan is registered in the one that the robot comes from.

        Without photographs: all that the scan does is to tie the rooms together.

        Returns:
            Whether the scan found its place.
        """
        scan = yield from self._scan()
        guess = self._mopad.world_from_scanner
        with self._stopwatch("register"):
            sample, found = room.register(scan, guess)
        yield from self._registered(room, guess, found)
        if found.accepted:
            into.threshold = place(sample, found.world_from_scanner)
            into.registrar.register(sample, found.world_from_scanner)
            self._look_around(into)
        return found.accepted

    def drive(self, room: ExploredRoom, path: NDArray[np.float64], floor_height: float) -> Generator[Event, None, bool]:
        """Drive along a path (P, 2) as far as it goes, matching the Hokuyos with the room on the way.

        Returns:
            Whether the robot arrived.
        """
        leg = yield from self._leg(room, path, floor_height)
        return bool(leg.arrived)

    def _leg(self, room: ExploredRoom, path: NDArray[np.float64], floor_height: float) -> Generator[Event, None, Drove]:
        with self._stopwatch("drive"):
            drove = self._drove(room, path, floor_height)
        yield drove
        yield from self._news()
        return drove

    def scan_here(self, room: ExploredRoom, *, photograph: bool) -> Iterator[Event]:
        """Scan, photograph, register and colour at the present pose: a scan of the room."""
        scan = yield from self._scan()
        with ThreadPoolExecutor(1) as beside:  # a scan is registered while the camera turns: it needs nothing else
            guess = self._mopad.world_from_scanner
            registering = beside.submit(room.register, scan, guess)
            if photograph:
                with self._stopwatch("photograph"):
                    photos = self._mopad.photograph()
                yield self.event(Photographed, scan_number=self._scans, photos=photos)
            with self._stopwatch("register"):  # what is left of it
                sample, found = registering.result()
        yield from self._registered(room, guess, found)
        if not found.accepted:
            return
        self._look_around(room)
        room.samples.append(place(sample, found.world_from_scanner))
        if photograph:
            with self._stopwatch("colour"):
                view = colour_scan(scan, photos, found.world_from_scanner)
                room.coloured.append(ColouredScan.of(scan, view, found.world_from_scanner))
            yield self.event(Coloured, scan_number=self._scans, view=view)

    def _scan(self) -> Generator[Event, None, Scan]:
        self._scans += 1
        with self._stopwatch("scan"):
            scan = self._mopad.scan()
        truth = self._mopad.true_world_from_scanner
        yield self.event(Scanned, scan_number=self._scans, scan=scan, true_world_from_scanner=truth)
        yield from self._news()
        return scan

    def _news(self) -> Iterator[Event]:
        """What was put in the way since the last time."""
        while self._mopad.news:
            yield self.remark(self._mopad.news.pop(0))

    def _registered(self, room: ExploredRoom, guess: Pose, found: Registration) -> Iterator[Event]:
        """Believe what a registration found."""
        mopad = self._mopad
        yield self.event(
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
        if found.accepted:
            mopad.believe(found.world_from_scanner @ inverted(mopad.robot.base_from_scanner))
        else:
            room.rejected_in_world.append(guess[:3, 3])
            yield self.remark(f"scan {self._scans} is left out: {found.reason}")

    def understand(self, room: ExploredRoom) -> Generator[Event, None, tuple[Structure, VoxelModel]]:
        """Floor, ceiling, walls and voxels of the room as far as it is scanned."""
        with self._stopwatch("structure"):
            structure = room.structure()
        yield self.event(Structured, scan_number=self._scans, structure=structure)
        with self._stopwatch("voxels"):
            voxels = room.voxels(structure)
        yield self.event(Labelled, scan_number=self._scans, voxels=voxels)
        return structure, voxels

    def _move_on(self, room: ExploredRoom, structure: Structure, voxels: VoxelModel) -> Generator[Event, None, bool]:
        """Choose where to scan next and drive there; a blocked way leads to a new plan, to be stuck ends the room.

        Returns:
            Whether the robot stands where it is to scan next; if not, the room is complete.
        """
        mopad, reason = self._mopad, NO_ARRIVAL
        for _ in range(MAX_DETOURS):
            with self._stopwatch("plan"):
                grid = room.grid(structure.floor_height)
                plan = room.plan(
                    structure,
                    voxels,
                    grid,
                    world_from_base=mopad.world_from_base,
                    base_from_scanner=mopad.robot.base_from_scanner,
                    seed=(self._seed, self._steps),
                )
            yield self.event(Planned, scan_number=self._scans, plan=plan, grid=grid)
            if plan.path is None:
                return False
            leg = yield from self._leg(room, plan.path, structure.floor_height)
            if leg.arrived:
                return True
            if leg.outcome == "stuck":
                reason = f"stuck for {self._config.navigation.driving.patience:g} s"
                break
        stopped = replace(plan, chosen=None, path=None, stop_reason=reason)
        yield self.event(Planned, scan_number=self._scans, plan=stopped, grid=grid)
        return False

    def _drove(self, room: ExploredRoom, path: NDArray[np.float64], floor_height: float) -> Drove:
        mopad, navigation = self._mopad, self._config.navigation
        truth: list[Pose] = []
        angles: list[NDArray[np.float64]] = []

        def watch() -> None:
            truth.append(mopad.robot.true_world_from_base)
            angles.append(mopad.true_openings)

        def measure() -> list[LaserScan]:
            mopad.meet_obstacles(driving=True)
            return mopad.measure_lasers()

        laser_map = room.laser_map(floor_height + mopad.laser_height)
        leg = drive(
            mopad.robot,
            path,
            measure,
            world_from_odometry=mopad.world_from_odometry,
            footprint=room.footprint,
            parameters=navigation.driving,
            localise=partial(localise, laser_map, parameters=navigation.localisation),
            watch=watch,
        )
        mopad.believe(leg.world_from_base[-1])
        readings = list(zip(leg.laser_scans, leg.world_from_base_at_laser, strict=True))
        if leg.arrived:  # the next scan will tell more of what is near
            room.passing += readings
        else:  # what stopped it must be on the map
            room.lasers += readings
            self._look_around(room)
        drove: Drove = self.event(
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
        return drove

    def _look_around(self, room: ExploredRoom) -> None:
        """Note where the robot stands and what the Hokuyos see there."""
        world_from_base = self._mopad.world_from_base
        room.robot_poses.append(world_from_base)
        room.lasers += [(scan, world_from_base) for scan in self._mopad.measure_lasers()]
