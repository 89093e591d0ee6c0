"""Samples of scans: normals, smoothing and thinning, on a room of boxes."""

from __future__ import annotations

import numpy as np
import pytest

from mission.samples import SampleParameters, place, sample_scan, thinned
from tests.mission.boxroom import plain_room, pose, scan


def test_a_flat_wall_gets_its_normal_within_two_degrees_and_points_much_finer_than_the_noise() -> None:
    place_of_scan = pose(3, 2)
    sample = place(sample_scan(scan(plain_room(), place_of_scan, noise=0.003)), place_of_scan)
    points, normals = sample.points_in_world, sample.normals_in_world
    wall = (np.abs(points[:, 1]) < 0.02) & (points[:, 2] > 0.3) & (points[:, 2] < 2.3) & np.isfinite(normals[:, 0])

    assert np.count_nonzero(wall) > 2000
    off = np.arccos(np.clip(normals[wall, 1], -1, 1))  # the wall y = 0 faces +y
    assert np.median(off) < np.deg2rad(2)
    assert np.std(points[wall, 1]) < 0.003 / 3  # 25 beams or more make a plane: 3 mm / 5


def test_no_normal_mixes_two_walls_of_a_corner() -> None:
    place_of_scan = pose(3, 2, yaw=0.3)
    sample = place(sample_scan(scan(plain_room(), place_of_scan)), place_of_scan)
    normals = sample.normals_in_world[np.isfinite(sample.normals_in_world[:, 0])]

    along_an_axis = np.abs(normals).max(axis=1) > np.cos(np.deg2rad(10))
    assert along_an_axis.mean() > 0.98


def test_a_cube_keeps_one_point_and_rather_a_preferred_one() -> None:
    points = np.array([[0.01, 0, 0], [0.02, 0, 0], [0.11, 0, 0], [0.12, 0, 0]])
    preferred = np.array([False, True, False, False])

    # cubes of 0.1: {0, 1} keeps 1, which is preferred; {2, 3} keeps 2, which comes first
    assert thinned(points, 0.1, first=preferred).tolist() == [1, 2]


def test_what_returns_nothing_leaves_no_point() -> None:
    nothing = sample_scan(scan([], pose(0, 0)), SampleParameters())

    assert nothing.points.shape == (0, 3)
    assert np.isnan(nothing.ranges).all()


def test_bands_do_not_show_in_a_sample(monkeypatch: pytest.MonkeyPatch) -> None:
    taken = scan(plain_room(), pose(3, 2), noise=0.003)
    samples = []
    for pixels in (1, 10**9):
        monkeypatch.setattr("sim.bands._PIXELS", pixels)
        samples.append(sample_scan(taken))

    assert np.array_equal(samples[0].points, samples[1].points)
    assert np.array_equal(samples[0].normals, samples[1].normals, equal_nan=True)
