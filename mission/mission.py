"""The mission: room after room until no way leads on; of every completed room the doors, the exits, and its place."""

from __future__ import annotations

from collections.abc import Iterator
from types import TracebackType
from typing import Literal, Self

from mission.completion import Completion
from mission.config import MissionConfig
from mission.errors import MissionError
from mission.events import (
    Event,
    MissionFinished,
    MissionStarted,
    RoomEntered,
)
from mission.exits import Exit
from mission.explored_building import ExploredBuilding
from mission.explored_room import ExploredRoom
from mission.grid import Footprint
from mission.mopad import Mopad
from mission.registration import Registrar
from mission.resumption import Earlier
from mission.rigid import Pose
from mission.stopwatch import Stopwatch
from mission.surveyor import Surveyor
from mission.travelling import Traveller
from mission.versions import versions
from sim.scene import Scene


class Mission:
    """One mission in a scene; `run` yields its events.

    The simulator's truth (poses, joints) goes into events only: no stage reads it.
    """

    def __init__(
        self,
        scene: Scene,
        config: MissionConfig,
        *,
        seed: int,
        stopwatch: Stopwatch | None = None,
        earlier: Earlier | None = None,
    ) -> None:
        """Set the robot up in the scene.

        Args:
            scene: With the robot at its start.
            config: Parameters of all stages.
            seed: Of all noise.
            stopwatch: Counts the time of each stage.
            earlier: What the same mission measured before it was interrupted.
        """
        self._scene, self._config, self._seed = scene, config, seed
        self._stopwatch = stopwatch or Stopwatch()
        self._mopad = Mopad(scene, config, seed=seed, earlier=earlier)
        self._footprint = Footprint(*self._mopad.robot.footprint)
        self._surveyor = Surveyor(self._mopad, config, self._stopwatch, seed=seed)
        self._building = ExploredBuilding(config.links)
        self._traveller = Traveller(self._mopad, self._building, self._surveyor, self._footprint, config.navigation)
        self._completion = Completion(
            self._building,
            self._footprint,
            config,
            self._stopwatch,
            event=self._surveyor.event,
            true_doors=scene.true_doors,
        )
        self._rooms = 0

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
        room, entered = self._begin("start")
        yield entered
        yield from self._explore(room)
        for site, pose in self._scene.set_downs.items():
            if not self._may_go_on():
                break
            if self._building.room_at(pose[:3, 3] + [0.0, 0.0, 1.0]) is not None:
                continue
            yield from self._set_down(site, pose)
        count = len(self._building.rooms)
        rooms = "the room is scanned and its" if count == 1 else f"{count} rooms are scanned and their"
        yield self.finished("completed", f"{rooms} doors are judged")

    def finished(self, outcome: Literal["completed", "interrupted", "failed"], reason: str) -> MissionFinished:
        """The last event, also of a mission that was stopped from outside."""
        finished: MissionFinished = self._surveyor.event(MissionFinished, outcome=outcome, reason=reason)
        return finished

    def _started(self) -> MissionStarted:
        robot = self._mopad.robot
        started: MissionStarted = self._surveyor.event(
            MissionStarted,
            scene=self._scene.name,
            scene_xml=self._scene.xml,
            seed=self._seed,
            config=self._config.model_dump(mode="json"),
            versions=versions(),
            world_from_base=self._mopad.world_from_base,
            robot=robot.shape(),
            footprint=self._footprint,
            base_from_scanner=robot.base_from_scanner,
            true_doors=self._scene.true_doors(),
        )
        return started

    def _entered(self, how: Literal["start", "door", "set down"], way: Exit | None = None) -> RoomEntered:
        entered: RoomEntered = self._surveyor.event(
            RoomEntered,
            how=how,
            door=way.face.door_id if way else None,
            before=way.face.room if way else None,
            world_from_room=self._building.world_from_room[self._surveyor.room],
            world_from_base=self._mopad.world_from_base,
            true_world_from_base=self._mopad.robot.true_world_from_base,
        )
        return entered

    def _explore(self, room: ExploredRoom) -> Iterator[Event]:
        """Do a room, and all that can be reached from it."""
        yield from self._do(room)
        here = room.number
        while self._may_go_on() and (way := self._building.unexplored(here)) is not None:
            beyond = self._next_room()
            here, through = yield from self._traveller.go_through(here, way, beyond)
            if not through:
                self._building.give_up(way)
                continue
            self._rooms, here = beyond.number, beyond.number
            yield self._entered("door", way)
            try:
                yield from self._do(beyond)
            except MissionError as error:  # it leads out into the open, or to where nothing can be made out
                yield self._surveyor.remark(f"behind door {way.face.door_id}: {error}")
                self._building.drop(beyond.number)
                self._building.give_up(way)
                back = yield from self._traveller.come_back(way)
                if back is None:
                    yield self._surveyor.remark(f"the robot cannot come back through door {way.face.door_id}")
                    return
                here = back

    def _may_go_on(self) -> bool:
        return len(self._building.rooms) < self._config.planning.max_rooms

    def _next_room(self) -> ExploredRoom:
        """A room of which nothing is known yet."""
        return ExploredRoom(self._rooms + 1, self._footprint, self._config, Registrar(self._config.registration))

    def _begin(self, how: Literal["start", "set down"]) -> tuple[ExploredRoom, RoomEntered]:
        """Begin a room where the robot stands."""
        room = self._next_room()
        self._rooms = self._surveyor.room = room.number
        self._building.begin(room.number, self._mopad.world_from_base[:3, 3], how)
        return room, self._entered(how)

    def _set_down(self, site: str, true_world_from_base: Pose) -> Iterator[Event]:
        """Have an operator carry the robot to where the scene says, who knows the place by eye only."""
        self._mopad.set_down(true_world_from_base)
        room, entered = self._begin("set down")
        yield entered
        try:
            yield from self._explore(room)
        except MissionError as error:
            if room.number in self._building.rooms:
                raise
            yield self._surveyor.remark(f"at {site}: {error}")
            self._building.drop(room.number)

    def _do(self, room: ExploredRoom) -> Iterator[Event]:
        """Scan a room, judge its doors, and link it to the others.

        Raises:
            MissionError: It is no room.
        """
        structure, voxels = yield from self._surveyor.survey(room)
        yield from self._completion.complete(room, structure, voxels)
        room.settle(structure.floor_height, structure.floor_height + self._mopad.laser_height)
