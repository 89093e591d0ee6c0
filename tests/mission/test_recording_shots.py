"""Photographs for display: which one is shown, and where doors are in it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from mission.recording.rerun_photos import label_places
from mission.recording.shots import Shot
from tests.mission import recording_room as made

SHOT = Shot(b"", np.array([[80, 0, 60], [0, 80, 40], [0, 0, 1.0]]), 120, 80, 1, np.eye(4), np.eye(4))


def upright(left: float, depth: float = 2.0) -> NDArray[np.float64]:
    """A square of 1 m that faces the camera."""
    return np.array([[left, -0.5, depth], [left + 1, -0.5, depth], [left + 1, 0.5, depth], [left, 0.5, depth]])


def test_the_best_photograph_shows_a_door_whole_and_large() -> None:
    whole = SHOT.shows([upright(-0.5)])  # f w / z = 80 * 1 / 2 = 40 px wide and tall
    assert whole > SHOT.shows([upright(-0.5, depth=4.0)]) > 0  # 20 px
    assert whole > 4 * SHOT.shows([upright(1.0)]) > 0  # half of it is cut off
    assert SHOT.shows([upright(9.0)]) == 0
    assert SHOT.shows([-upright(-0.5)]) == 0  # behind the camera


def test_a_door_is_outlined_as_far_as_the_picture_has_it() -> None:
    assert len(SHOT.outline(upright(-0.5))) == 4
    cut = np.array(SHOT.outline(upright(1.0)))  # its left side is in column 60 + 80 * 1 / 2 = 100; the right one is out
    assert len(cut) == 3
    assert (cut[..., 0].min(), cut[..., 0].max()) == pytest.approx((100, 120))
    beside = np.array([[1, -0.5, 2], [1, -0.5, -2], [1, 0.5, -2], [1, 0.5, 2.0]])  # goes on behind the camera
    assert np.array(SHOT.outline(beside))[..., 0].max() == pytest.approx(120)
    assert SHOT.outline(-upright(-0.5)) == []


def test_a_door_behind_another_wall_is_not_in_the_photograph() -> None:
    """The camera looks along y from (3, 1, 1); a wall of 2 m stands across, 1 m ahead, and the door 4 m ahead."""
    looking = made.pose(3, 1, 1) @ np.array([[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1.0]])
    shot = replace(SHOT, room_from_camera=looking)
    door = np.array([[2.5, 5, 0], [3.5, 5, 0], [3.5, 5, 2], [2.5, 5, 2.0]])
    far, screen = made.walls()[2], made.walls()[2]
    far = replace(far, origin=np.array([0, 5.0, 0]))
    screen = replace(screen, origin=np.array([2.0, 2.0, 0]), width=2.0)
    assert shot.sees(door, [far])
    assert not shot.sees(door, [far, screen])
    assert shot.sees(door, [far, replace(screen, origin=np.array([4.0, 2.0, 0]))])  # beside the line of sight


def test_labels_in_a_photograph_do_not_hide_each_other() -> None:
    assert label_places([(300, 500), (100, 490), (200, 100)], pitch=70) == [(300, 490), (100, 420), (200, 30)]
