"""Ctrl-C is taken at safe places only."""

from __future__ import annotations

import signal

import pytest

from mission.interrupts import Interrupts


def test_a_signal_outside_the_safe_place_waits_for_it() -> None:
    with Interrupts() as interrupts:
        signal.raise_signal(signal.SIGINT)  # nothing happens here
        with pytest.raises(KeyboardInterrupt), interrupts.raised():
            raise AssertionError("the pending signal comes first")


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_inside_the_safe_place_is_raised_at_once(number: signal.Signals) -> None:
    with Interrupts() as interrupts, pytest.raises(KeyboardInterrupt), interrupts.raised():
        signal.raise_signal(number)
        raise AssertionError("not reached")


def test_the_handlers_of_before_are_put_back() -> None:
    before = signal.getsignal(signal.SIGINT)
    with Interrupts():
        assert signal.getsignal(signal.SIGINT) != before
    assert signal.getsignal(signal.SIGINT) == before
