"""Sinks: readers of the mission's events."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from types import TracebackType
from typing import Protocol, Self

from mission.events import Event
from mission.memory import release_freed_memory
from mission.stopwatch import Stopwatch


class Sink(Protocol):
    """A reader of the event stream; one that holds files is a context manager too, and closes them whatever happens."""

    def handle(self, event: Event) -> None:
        """Take one event."""


class SideBySide:
    """Hands events to sinks while the mission goes on: one event at a time, each sink in a thread of its own.

    An event is handed over when all sinks are done with the one before: none waits in memory, and a mission that
    is killed leaves all events but the one being written. The stopwatch counts as recording what the mission waits.
    """

    def __init__(self, sinks: Sequence[Sink], stopwatch: Stopwatch) -> None:
        self._sinks, self._stopwatch = sinks, stopwatch
        self._hands = ThreadPoolExecutor(max(len(sinks), 1))
        self._handed: list[Future[None]] = []

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        with self._hands:
            self._wait()

    def hand(self, event: Event) -> None:
        """Hand an event over.

        Raises:
            Exception: What a sink raised at the event before.
        """
        self._wait()
        self._handed = [self._hands.submit(sink.handle, event) for sink in self._sinks]

    def _wait(self) -> None:
        handed, self._handed = self._handed, []
        with self._stopwatch("recording"):
            done = [future.exception() for future in handed]
        release_freed_memory()
        for error in done:
            if error is not None:
                raise error
