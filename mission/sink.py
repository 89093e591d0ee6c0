"""Sinks: readers of the mission's events."""

from __future__ import annotations

from typing import Protocol

from mission.events import Event


class Sink(Protocol):
    """A reader of the event stream; one that holds files is a context manager too, and closes them whatever happens."""

    def handle(self, event: Event) -> None:
        """Take one event."""
