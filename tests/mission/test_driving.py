"""Following a path, and stopping before it is too late."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from mission.driving import drive
from mission.following import DrivingParameters, follow_path
from mission.grid import Cell, OccupancyGrid, with_laser
from mission.navigation import plan_path
from sim.guardian import RobotParameters
from tests.mission.driving_world import FOOTPRINT, Unicycle, body_gap, hokuyos, laser_scan, pose


def test_the_follower_first_turns_then_drives_and_never_exceeds_its_limits() -> None:
    path = np.array([[0.0, 0.0], [0.0, 2.0]])
    command = follow_path(path, pose(0, 0, 0))
    assert command.speed == 0.0
    assert command.turn_rate == pytest.approx(0.7)  # left, at the limit
    command = follow_path(path, pose(0, 0, np.pi / 2))
    assert command.speed == pytest.approx(0.3)
    assert command.turn_rate == pytest.approx(0.0, abs=1e-9)
    assert follow_path(path, pose(0, 1.98, np.pi / 2)).target == 2  # done


def test_a_way_point_straight_behind_is_reached_backwards() -> None:
    command = follow_path(np.array([[0.0, 0.0], [-1.0, 0.0]]), pose(0, 0, 0.05))
    assert command.speed < -0.15
    assert command.turn_rate < 0  # turns the heading, 0.05 to the left, back to the line


@pytest.mark.parametrize("seed", range(3))
def test_an_l_shaped_path_is_driven_to_its_end_within_what_odometry_drifts(seed: int) -> None:
    path = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 2.0]])
    robot = Unicycle(pose(0, 0, 2.0), drift=0.3)
    robot._rng = np.random.default_rng(seed)
    driven = drive(robot, path, hokuyos(robot, []), footprint=FOOTPRINT)
    assert driven.outcome == "arrived"
    np.testing.assert_allclose(driven.world_from_base[-1][:2, 3], [2.0, 2.0], atol=0.1)
    # 30 % white noise a tick of 3 cm: over some 140 ticks about 10 cm, sideways with the heading's
    assert np.hypot(*(robot.true[:2, 3] - [2.0, 2.0])) < 0.35
    v, w = np.abs(np.array(robot.commands)).T
    assert v.max() <= 0.3 and w.max() <= 0.7
    assert robot.time < 40.0  # 4 m at 0.3 m/s, three turns of up to 2 rad at 0.7 rad/s


def test_a_slower_robot_is_driven_no_faster_than_it_can() -> None:
    slow = RobotParameters(max_speed=0.1, max_turn_rate=0.2, max_acceleration=0.05)
    robot = Unicycle(pose(0, 0), parameters=slow)
    path = np.array([[0.0, 0.0], [0.5, 0.0], [0.5, 0.5]])
    assert drive(robot, path, hokuyos(robot, []), footprint=FOOTPRINT).arrived
    v, w = np.array(robot.commands).T
    assert v.max() == pytest.approx(0.1) and abs(w).max() == pytest.approx(0.2)
    assert np.diff(v).max() <= 0.05 * 0.1 + 1e-9  # a tick is 0.1 s


def test_the_record_of_a_drive_begins_at_its_start_and_ends_at_its_end() -> None:
    robot = Unicycle(pose(0, 0))
    watched: list[float] = []
    correction = pose(5.0, 0.0, np.pi / 2)  # registration has found the odometry's origin here
    path = np.array([[5.0, 0.0], [5.0, 1.0]])
    driven = drive(
        robot,
        path,
        hokuyos(robot, []),
        world_from_odometry=correction,
        footprint=FOOTPRINT,
        watch=lambda: watched.append(robot.time),
    )
    assert driven.arrived
    np.testing.assert_allclose(robot.odometry[:2, 3], [1.0, 0.0], atol=0.06)
    np.testing.assert_allclose(driven.world_from_base[0], correction, atol=1e-12)
    np.testing.assert_allclose(driven.world_from_base[-1], correction @ robot.odometry, atol=1e-12)
    np.testing.assert_array_equal(driven.times, np.rint(np.array(watched) * 1e9).astype(np.int64))
    assert len(driven.laser_scans) == len(driven.world_from_base_at_laser) > 4


def test_the_robot_stops_before_a_box_in_its_way_and_then_finds_a_way_round_it() -> None:
    box = (2.0, 2.4, -0.2, 0.2)
    walls = [(-2.0, 5.0, -2.6, -2.5), (-2.0, 5.0, 2.5, 2.6), (-1.1, -1.0, -2.5, 2.5), (5.0, 5.1, -2.5, 2.5)]
    robot = Unicycle(pose(0, 0))
    goal = np.array([4.0, 0.0])
    driven = drive(robot, np.array([[0.0, 0.0], goal]), hokuyos(robot, [box, *walls]), footprint=FOOTPRINT)
    assert driven.outcome == "blocked"
    assert 0.02 < body_gap(robot.true, [box]) < 0.25
    origin = np.array([-1.0, -2.5])
    grid = OccupancyGrid(origin, 0.05, np.full((100, 120), Cell.FREE, np.uint8))
    for scan, world_from_base in zip(driven.laser_scans, driven.world_from_base_at_laser, strict=True):
        grid = with_laser(grid, scan, world_from_base)
    path = plan_path(grid, driven.world_from_base[-1], goal, footprint=FOOTPRINT)
    assert path is not None
    gaps: list[float] = []
    again = drive(
        robot,
        path,
        hokuyos(robot, [box, *walls]),
        footprint=FOOTPRINT,
        watch=lambda: gaps.append(body_gap(robot.true, [box, *walls])),
    )
    assert again.arrived, again.reason
    assert min(gaps) > 0.02


def test_a_robot_that_does_not_move_is_stuck_after_thirty_seconds() -> None:
    robot = Unicycle(pose(0, 0), grip=0.0)
    driven = drive(robot, np.array([[0.0, 0.0], [2.0, 0.0]]), hokuyos(robot, []), footprint=FOOTPRINT)
    assert driven.outcome == "stuck"
    assert robot.time == pytest.approx(30.0, abs=0.2)


def test_a_touch_ends_the_drive_and_names_what_was_touched() -> None:
    robot = Unicycle(pose(0, 0))
    path = np.array([[0.0, 0.0], [2.0, 0.0]])

    def bump() -> None:
        robot.touching = ["chair"] if robot.true[0, 3] > 1.0 else []

    driven = drive(robot, path, hokuyos(robot, []), footprint=FOOTPRINT, watch=bump)
    assert driven.outcome == "contact"
    assert "chair" in driven.reason
    assert 1.0 < robot.true[0, 3] < 1.1  # within two ticks of 3 cm


def test_a_touch_that_a_leg_starts_with_and_does_not_leave_behind_ends_it() -> None:
    robot = Unicycle(pose(0, 0))
    robot.touching = ["chair"]
    driven = drive(robot, np.array([[0.0, 0.0], [2.0, 0.0]]), hokuyos(robot, []), footprint=FOOTPRINT)
    assert driven.outcome == "contact"
    assert robot.time == pytest.approx(1.15, abs=0.1)  # the second that it had, and a tick to halt


def test_a_robot_turns_on_the_spot_only_if_its_corners_find_room() -> None:
    # A wall 0.35 m beside the centre: the body has 6.5 cm, its corners would sweep 0.56 m.
    wall = [(-2.0, 2.0, -0.5, -0.35)]
    robot = Unicycle(pose(0, 0))
    driven = drive(robot, np.array([[0.0, 0.0], [0.0, 2.0]]), hokuyos(robot, wall), footprint=FOOTPRINT)
    assert driven.outcome == "blocked"
    assert body_gap(robot.true, wall) > 0.01
    # Straight along it, it drives; and away from a post that is already within the guard of 3 cm.
    for obstacles in (wall, [(-0.2, 0.2, -0.5, -0.295)]):
        robot = Unicycle(pose(0, 0))
        path = np.array([[0.0, 0.0], [1.0, 0.0]])
        assert drive(robot, path, hokuyos(robot, obstacles), footprint=FOOTPRINT).arrived


def test_noise_of_a_single_reading_does_not_stop_the_robot() -> None:
    robot = Unicycle(pose(0, 0))

    def measure() -> list[Any]:
        scan = laser_scan(robot.true, [])
        scan.ranges[341] = 0.1  # dust
        return [scan]

    parameters = DrivingParameters(readings=2)
    path = np.array([[0.0, 0.0], [1.0, 0.0]])
    assert drive(robot, path, measure, footprint=FOOTPRINT, parameters=parameters).arrived
