"""Sinks: readers of the mission's events, which hold one event at a time and always close what they opened."""

from __future__ import annotations

from types import TracebackType
from typing import Protocol, Self

from mission.events import Event


class Sink(Protocol):
    """A reader of the event stream; entering opens its outputs, leaving closes them whatever happened."""

    def __enter__(self) -> Self: ...

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None: ...

    def handle(self, event: Event) -> None:
        """Take one event."""
