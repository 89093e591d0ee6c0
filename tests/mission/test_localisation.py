"""Finding the robot's place again by its Hokuyos."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from mission.driving import drive
from mission.localisation import LaserMap, laser_map, localise
from sim.laser_scan import LaserScan
from tests.mission.driving_world import FOOTPRINT, Rectangle, Unicycle, hokuyos, laser_scan, pose

WALLS: list[Rectangle] = [
    (-3.1, -3.0, -2.0, 2.0),
    (3.0, 3.1, -2.0, 2.0),
    (-3.0, 3.0, -2.1, -2.0),
    (-3.0, 3.0, 2.0, 2.1),
]
"""Around a room of 6 x 4 m about the origin."""


def scanned(walls: list[int]) -> LaserMap:
    """The inner faces of some of the walls, in points 3 cm apart and 0.4 m high."""
    points, normals = [], []
    for index in walls:
        axis, face, inward = ((0, -3.0, 1.0), (0, 3.0, -1.0), (1, -2.0, 1.0), (1, 2.0, -1.0))[index]
        along = np.arange(-3.0, 3.0, 0.03) if axis else np.arange(-2.0, 2.0, 0.03)
        columns = [along, np.full(len(along), face)] if axis else [np.full(len(along), face), along]
        points.append(np.column_stack([*columns, np.full(len(along), 0.4)]))
        normals.append(np.tile(inward * np.eye(3)[axis], (len(along), 1)))
    return laser_map(np.concatenate(points), np.concatenate(normals), height=0.4)


def noisy_scans(true: NDArray[np.float64], obstacles: list[Rectangle]) -> list[LaserScan]:
    """Both Hokuyos with 1 % noise."""
    rng = np.random.default_rng(0)
    scans = [laser_scan(true, obstacles, rear=rear) for rear in (False, True)]
    for scan in scans:
        scan.ranges[:] *= (1 + 0.01 * rng.standard_normal(len(scan.ranges))).astype(np.float32)
    return scans


def errors(found: NDArray[np.float64], true: NDArray[np.float64]) -> tuple[float, float]:
    """Distance [m] and angle [rad] between two poses."""
    apart = np.linalg.inv(true) @ found
    return float(np.hypot(*apart[:2, 3])), float(abs(np.arctan2(apart[1, 0], apart[0, 0])))


def test_a_pose_that_has_drifted_is_found_again() -> None:
    true = pose(0.5, -0.4, 0.6)
    drifted = pose(0.6, -0.48, 0.65)
    distance, angle = errors(localise(scanned([0, 1, 2, 3]), noisy_scans(true, WALLS), drifted), true)
    # 1 % of 3 m over some 1000 readings: 1 mm; the prior of 5 cm pulls back by a few per cent of the drift
    assert distance < 0.01
    assert angle < 0.005


def test_along_a_corridor_the_odometry_is_believed() -> None:
    corridor = [(-50.0, 50.0, -2.1, -2.0), (-50.0, 50.0, 2.0, 2.1)]
    true, drifted = pose(0, 0), pose(0.08, 0.08)
    found = localise(scanned([2, 3]), noisy_scans(true, corridor), drifted)
    assert found[1, 3] == pytest.approx(0.0, abs=0.01)
    assert found[0, 3] == pytest.approx(0.08, abs=0.01)


def test_what_the_scans_do_not_know_does_not_pull() -> None:
    true = pose(0.5, -0.4, 0.6)
    box = (0.9, 1.3, 0.6, 1.0)  # put there after the scan
    distance, _ = errors(localise(scanned([0, 1, 2, 3]), noisy_scans(true, [*WALLS, box]), pose(0.55, -0.4, 0.6)), true)
    assert distance < 0.01


def test_readings_that_do_not_fit_leave_the_pose_as_it_was() -> None:
    elsewhere = [(x - 1.2, x - 1.0, y, y + 0.2) for x in range(4) for y in range(-2, 3)]
    drifted = pose(0.55, -0.4, 0.6)
    np.testing.assert_array_equal(localise(scanned([0, 1, 2, 3]), noisy_scans(drifted, elsewhere), drifted), drifted)
    nowhere = laser_map(np.empty((0, 3)), np.empty((0, 3)), height=0.4)
    np.testing.assert_array_equal(localise(nowhere, noisy_scans(drifted, WALLS), drifted), drifted)


def test_the_map_holds_upright_surfaces_at_the_lasers_height_only() -> None:
    points = np.array([[1, 0, 0.4], [2, 0, 0.4], [3, 0, 0.4], [4, 0, 0.6]])
    normals = np.array([[1, 0, 0], [0, 0, 1], [np.nan, np.nan, np.nan], [1, 0, 0.0]])
    assert laser_map(points, normals, height=0.4).points.tolist() == [[1.0, 0.0]]


def test_driving_with_localisation_arrives_where_it_should_in_spite_of_the_odometry() -> None:
    path = np.array([[-2.0, -1.0], [1.0, -1.0], [2.0, 1.0]])
    room = scanned([0, 1, 2, 3])
    misses = []
    for matched in (True, False):
        robot = Unicycle(pose(-2.0, -1.0), bias=0.03)  # counts 3 % too much
        driven = drive(
            robot,
            path,
            hokuyos(robot, WALLS),
            footprint=FOOTPRINT,
            localise=(lambda scans, guess: localise(room, scans, guess)) if matched else None,
        )
        assert driven.arrived, driven.reason
        misses.append(np.hypot(*(robot.true[:2, 3] - path[-1])))
    assert misses[0] < 0.07  # the tolerance of 5 cm, and 2 cm
    assert misses[1] > 0.10  # without it, 3 % of 5.2 m and of the turn
