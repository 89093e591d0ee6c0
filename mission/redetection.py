"""A recorded mission judged again: registration to doors, from recorded scans and photographs, where they were taken.

Nothing is planned or driven: plans, legs and remarks are told again as they were recorded. The stages are the mission's
own, and need no simulator.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any, cast

from mission.completion import Completion
from mission.config import MissionConfig
from mission.errors import MissionError
from mission.events import (
    Coloured,
    DoorsDetected,
    DoorsEvaluated,
    Event,
    Labelled,
    MissionFinished,
    MissionStarted,
    Photographed,
    Registered,
    Remarked,
    RoomEntered,
    RoomsTied,
    Scanned,
    Structured,
)
from mission.explored_building import ExploredBuilding
from mission.explored_room import ExploredRoom
from mission.recorded_mopad import RecordedMopad
from mission.registration import Registrar
from mission.stopwatch import Stopwatch
from mission.structure import Structure
from mission.surveyor import Surveyor
from mission.versions import versions
from mission.voxels import VoxelModel
from sim.door_truth import DoorTruth

UNUSED = (Coloured, DoorsDetected)
"""What need not be read of a recording that is judged again: large, and made anew."""
USED = ("samples", "registration", "links", "structure", "voxels", "navigation.exits", "detector")
"""Parts of the configuration that judging again depends on."""
_MADE_ANEW = (*UNUSED, Labelled, DoorsEvaluated)


class Redetection:
    """Judges a recorded mission again."""

    def __init__(self, started: MissionStarted, config: MissionConfig, *, stopwatch: Stopwatch | None = None) -> None:
        """Begin as the mission began.

        Args:
            started: Its first event.
            config: Parameters of all stages: those of the recording, or changed ones.
            stopwatch: Counts the time of each stage.
        """
        self._started, self._config = started, config
        self._mopad = RecordedMopad(started.base_from_scanner)
        mopad, stopwatch = cast(Any, self._mopad), stopwatch or Stopwatch()
        self._surveyor = Surveyor(mopad, config, stopwatch, seed=started.seed)
        self._building = ExploredBuilding(config.links)
        self._completion = Completion(
            self._building,
            started.footprint,
            config,
            stopwatch,
            event=self._surveyor.event,
            true_doors=self.true_doors,
        )
        self._mopad.time = started.time
        self._doors = started.true_doors
        self._rooms: dict[int, ExploredRoom] = {}
        self._newest = 0
        self._beyond = self._room(1)
        self._understood: dict[int, tuple[Structure, VoxelModel]] = {}

    def true_doors(self) -> tuple[DoorTruth, ...]:
        """As they stood then: for the comparison only."""
        return self._doors

    def run(self, recorded: Iterator[Event]) -> Iterator[Event]:
        """Tell the mission again.

        Args:
            recorded: Its events after the first; those of `UNUSED` kinds may be left out.
        """
        yield self._begun()
        events = _Ahead(recorded)
        for event in events:
            self._mopad.time, self._surveyor.room = event.time, event.room
            match event:
                case RoomEntered():
                    yield self._entered(event)
                case Scanned():
                    yield from self._scan(event, events)
                case Structured():
                    yield from self._understand(event.room)
                case RoomsTied():
                    if isinstance(events.next, DoorsEvaluated):
                        self._doors = events.next.true_doors
                    yield from self._complete(event.room)
                case _ if not isinstance(event, _MADE_ANEW):
                    yield self._surveyor.again(event)

    def _begun(self) -> Event:
        config = self._config.model_dump(mode="json")
        return self._surveyor.again(replace(self._started, config=config, versions=versions()))

    def _room(self, number: int) -> ExploredRoom:
        registrar = Registrar(self._config.registration)
        return ExploredRoom(number, self._started.footprint, self._config, registrar)

    def _entered(self, event: RoomEntered) -> Event:
        """Begin a room; one that was not judged by now was none."""
        if self._newest not in self._building.rooms:
            self._building.drop(self._newest)
        number, place = event.room, event.world_from_base[:3, 3]
        if event.how != "door":
            self._building.begin(number, place, event.how)
            self._beyond = self._room(number)
        elif event.before in self._building.world_from_room:
            self._building.enter_from(event.before, number, place)
        else:  # judged with these parameters the room before is none
            self._building.begin(number, place, "set down")
        self._rooms[number], self._newest = self._beyond, number
        return self._surveyor.again(replace(event, world_from_room=self._building.world_from_room[number]))

    def _scan(self, scanned: Scanned, events: _Ahead) -> Iterator[Event]:
        """Register and colour a scan again: one of the room, or without photographs one from a doorway."""
        photographed = None
        for event in events:
            match event:
                case Remarked():
                    self._mopad.news.append(event.text)
                case Photographed():
                    photographed = event
                case Registered():
                    self._mopad.stand(scanned, photographed, event)
                    break
                case MissionFinished():  # stopped before the scan was registered
                    yield self._surveyor.again(event)
                    return
                case _:
                    raise MissionError(f"scan {scanned.scan_number} was not registered")
        else:
            return  # the recording ends here
        if not event.accepted:
            next(events, None)  # the remark that says so is made anew
        if scanned.room not in self._rooms:
            raise MissionError(f"scan {scanned.scan_number} was taken in a room that was never entered")
        room = self._rooms[scanned.room]
        if photographed is not None:
            yield from self._surveyor.scan_here(room, photograph=True)
        else:
            self._beyond = self._room(self._newest + 1)
            yield from self._surveyor.scan_threshold(room, self._beyond)

    def _understand(self, number: int) -> Iterator[Event]:
        self._understood.pop(number, None)
        try:
            self._understood[number] = yield from self._surveyor.understand(self._rooms[number])
        except MissionError as error:
            yield self._surveyor.remark(f"room {number} is left out: {error}")

    def _complete(self, number: int) -> Iterator[Event]:
        if number in self._understood:
            room = self._rooms[number]
            yield from self._completion.complete(room, *self._understood.pop(number))
            room.samples.clear()  # nobody drives through it


class _Ahead:
    """An iterator that knows the next event."""

    def __init__(self, events: Iterator[Event]) -> None:
        self._events = events
        self._error: MissionError | None = None
        self.next = self._fetched()

    def __iter__(self) -> _Ahead:
        return self

    def __next__(self) -> Event:
        event = self.next
        if event is None:
            if self._error is not None:
                raise self._error
            raise StopIteration
        self.next = self._fetched()
        return event

    def _fetched(self) -> Event | None:
        """The next event; where the recording breaks off, nothing, until its turn has come."""
        try:
            return next(self._events, None)
        except MissionError as error:
            self._error = error
            return None
