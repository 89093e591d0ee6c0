"""Sinks that take events while the mission goes on."""

from __future__ import annotations

import time

import pytest

from mission.events import Event, Remarked
from mission.sink import SideBySide
from mission.stopwatch import Stopwatch


class Slow:
    """Takes a tenth of a second an event, and may break."""

    def __init__(self, breaks_at: int | None = None) -> None:
        self.begun: list[int] = []
        self.done: list[int] = []
        self._breaks_at = breaks_at

    def handle(self, event: Event) -> None:
        self.begun.append(event.step)
        time.sleep(0.1)
        if event.step == self._breaks_at:
            raise OSError("the disk is full")
        self.done.append(event.step)


def remark(step: int) -> Remarked:
    return Remarked(step=step, time=0, level="info", text="")


def test_the_mission_goes_on_while_an_event_is_recorded_and_waits_before_the_next() -> None:
    sinks, stopwatch = [Slow(), Slow()], Stopwatch()
    with SideBySide(sinks, stopwatch) as recording:
        recording.hand(remark(0))
        assert stopwatch.seconds["recording"] < 0.05  # nothing to wait for yet
        recording.hand(remark(1))
        assert all(sink.done == [0] for sink in sinks)
    assert all(sink.begun == sink.done == [0, 1] for sink in sinks)  # the end waits for the last
    assert 0.15 < stopwatch.seconds["recording"] < 0.4  # twice a tenth of a second, both sinks at once


def test_a_sink_that_breaks_is_told_of_and_the_others_have_the_event() -> None:
    good, bad = Slow(), Slow(breaks_at=0)
    with pytest.raises(OSError, match="the disk is full"), SideBySide([bad, good], Stopwatch()) as recording:
        recording.hand(remark(0))
        recording.hand(remark(1))
    assert good.done == [0]


def test_the_last_event_counts_when_it_breaks() -> None:
    with pytest.raises(OSError, match="the disk is full"), SideBySide([Slow(breaks_at=0)], Stopwatch()) as recording:
        recording.hand(remark(0))
