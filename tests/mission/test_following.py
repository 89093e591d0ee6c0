"""What of a command the obstacles in sight allow."""

from __future__ import annotations

import numpy as np
import pytest

from mission.following import Command, DrivingParameters, restrained
from mission.grid import Footprint

BODY = Footprint(0.97, 0.57)
PARAMETERS = DrivingParameters()  # foresight 0.8 s, guard 0.04 m, two readings are an obstacle


@pytest.mark.parametrize(
    ("ahead", "share"),
    [
        (0.6, 0.25),  # 0.115 m before the body at 0.485 m: 0.3 m/s would come 0.24 m nearer, a quarter of it 0.06 m
        (0.66, 0.5),  # 0.175 m: half speed comes 0.12 m nearer, and leaves 0.055 m
        (0.8, 1.0),  # 0.315 m: full speed leaves 0.075 m
    ],
)
def test_the_robot_slows_down_before_what_it_would_come_too_near(ahead: float, share: float) -> None:
    readings = np.array([[ahead, 0.0], [ahead, 0.02]])
    allowed = restrained(Command(0.3, 0.0, 1), readings, footprint=BODY, parameters=PARAMETERS)
    assert allowed is not None
    assert allowed.speed == pytest.approx(share * 0.3)


def test_a_corner_that_turns_into_something_beside_the_body_is_stopped() -> None:
    # Both readings lie 0.055 m beside the left side, 0.4 m ahead: a corner at 0.7 rad/s moves 0.07 m there in 0.25 s.
    readings = np.array([[0.40, 0.34], [0.42, 0.34]])
    assert restrained(Command(0.0, 0.7, 1), readings[:1], footprint=BODY, parameters=PARAMETERS) is not None
    assert restrained(Command(0.0, 0.7, 1), readings, footprint=BODY, parameters=PARAMETERS) is None


def test_readings_farther_than_the_body_turns_and_drives_change_nothing() -> None:
    # Half the diagonal is 0.563 m, with 0.24 m of driving and the guard 0.843 m.
    angles = np.radians(np.arange(0, 360, 2.0))
    ring = 0.9 * np.column_stack([np.cos(angles), np.sin(angles)])
    command = Command(0.3, 0.7, 1)
    assert restrained(command, ring, footprint=BODY, parameters=PARAMETERS) == command
