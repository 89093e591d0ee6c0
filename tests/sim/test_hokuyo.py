"""Tests of the small laser."""

from __future__ import annotations

import numpy as np
import pytest

from sim.hokuyo import Hokuyo, HokuyoParameters, LaserScan

ORIGIN = np.eye(4)
EXACT = HokuyoParameters(noise=False)


def sweep(scene, *, parameters=EXACT, base=ORIGIN, mount=ORIGIN, hidden=(), seed=0):
    laser = Hokuyo(scene[0], hidden, parameters)
    return laser.measure(scene[1], base, mount, rng=np.random.default_rng(seed), time=5)


def test_a_sweep_has_682_beams_over_240_degrees_anticlockwise(world):
    scan = sweep(world('<geom size=".1" pos="0 2 0"/>'))  # a ball on the left
    assert scan.angles.shape == scan.ranges.shape == (682,)
    assert np.degrees(scan.angles[-1] - scan.angles[0]) == pytest.approx(239.4, abs=0.1)  # 681 steps of 0.3516 deg
    assert scan.angles[340] == 0
    assert scan.ranges[340 + 256] == pytest.approx(1.9, abs=1e-6)  # 256 steps are 90 deg
    assert np.isnan(scan.ranges[340])
    assert scan.time == 5


def test_ranges_are_those_of_a_wall(world):
    scan = sweep(world('<geom type="box" size=".1 9 1" pos="2.1 0 0"/>'))
    ahead = np.abs(scan.angles) < np.radians(60)
    assert np.allclose(scan.ranges[ahead], 2 / np.cos(scan.angles[ahead]), atol=1e-6)


def test_it_measures_from_where_it_sits_on_the_robot(world):
    base, mount = np.eye(4), np.eye(4)
    base[:3, :3] = [[0, -1, 0], [1, 0, 0], [0, 0, 1]]  # the robot looks along y
    base[:2, 3] = 1, 0.6
    mount[:3, 3] = 0.4, 0, 0.3  # so the laser is at y = 1
    scan = sweep(world('<geom type="box" size="9 .1 .1" pos="0 3.1 .3"/>'), base=base, mount=mount)
    assert scan.ranges[340] == pytest.approx(2, abs=1e-6)
    assert scan.base_from_laser is mount


def test_points_of_a_sweep_lie_where_the_robot_has_what_it_hit():
    # The laser sits 0.45 m behind the base and looks backwards: 2 m ahead of it is x = -2.45, 1 m to its left y = -1.
    backwards = np.array([[-1.0, 0, 0, -0.45], [0, -1, 0, 0], [0, 0, 1, 0.4], [0, 0, 0, 1]])
    angles, ranges = np.radians([0.0, 45.0, 90.0]), np.array([2.0, np.nan, 1.0], np.float32)
    scan = LaserScan(backwards, angles, ranges, time=0)
    assert scan.points_in_base() == pytest.approx(np.array([[-2.45, 0, 0.4], [-0.45, -1, 0.4]]))
    assert scan.points_in_base(up_to=1.5) == pytest.approx(np.array([[-0.45, -1, 0.4]]))


def test_nothing_beyond_5_6_metres_returns(world):
    assert np.isfinite(sweep(world('<geom type="box" size=".1 1 1" pos="5.6 0 0"/>')).ranges[340])
    assert np.isnan(sweep(world('<geom type="box" size=".1 1 1" pos="5.8 0 0"/>')).ranges[340])


def test_it_sees_past_the_robot_glass_and_collision_shapes(world):
    scene = world(
        '<geom type="box" size=".1 9 9" pos="4.1 0 0"/>'
        '<geom type="box" size=".01 9 9" pos="3 0 0" rgba="1 1 1 .3"/>'
        '<geom type="box" size=".01 9 9" pos="2 0 0" group="3"/>'
        '<body name="base"><geom size=".2"/><body name="wheel"><geom size=".2" pos=".5 0 0"/></body></body>'
    )
    robot = {scene[0].body("base").id, scene[0].body("wheel").id}
    assert sweep(scene, hidden=robot).ranges[340] == pytest.approx(4, abs=1e-6)
    assert sweep(scene).ranges[340] == pytest.approx(0.2, abs=1e-6)  # from within its own ball
    assert (scene[0].geom_group == [0, 0, 3, 0, 0]).all()  # and the model is as it was


@pytest.mark.parametrize(("distance", "sigma"), [(0.5, 0.01), (4.0, 0.04)])
def test_noise_is_one_centimetre_then_one_per_cent(world, distance, sigma):
    scene = world(f'<geom type="cylinder" size="{distance} 1"/>')  # seen from its middle
    ranges = np.concatenate([sweep(scene, parameters=HokuyoParameters(), seed=k).ranges for k in range(10)])
    assert (ranges.astype(float) - distance).std() == pytest.approx(sigma, rel=0.05)
    assert np.allclose(ranges * 1000, np.rint(ranges * 1000), atol=1e-3)  # whole millimetres


def test_it_sees_what_nothing_can_bump_into(world):
    # A curtain 2 m ahead that takes no part in collisions, on a body whose solid part is 3 m to the left.
    curtain = '<geom type="box" size=".01 1 1" pos="2.01 0 0" contype="0" conaffinity="0"/>'
    scene = world(f'<body>{curtain}<geom size=".1" pos="0 3 0"/><geom size=".1" pos="0 3 1"/></body>')
    trees = scene[0].body_bvhadr.copy()
    ranges = sweep(scene).ranges
    assert ranges[340] == pytest.approx(2, abs=1e-6)
    assert ranges[340 + 256] == pytest.approx(2.9, abs=1e-6)
    assert (scene[0].body_bvhadr == trees).all()  # and the model is as it was


def test_a_tilted_laser_sees_what_its_plane_meets_and_nothing_else(world):
    # nose down: 1 m ahead the plane is tan(30 deg) = 0.577 m lower, after 1/cos(30 deg) = 1.155 m
    tilt = np.radians(30)
    base = np.eye(4)
    base[:3, :3] = [[np.cos(tilt), 0, np.sin(tilt)], [0, 1, 0], [-np.sin(tilt), 0, np.cos(tilt)]]
    low, level = '<geom type="box" size=".1 2 .1" pos="1.1 0 -.6"/>', '<geom type="box" size=".1 2 .1" pos="1.1 0 0"/>'
    assert sweep(world(low), base=base).ranges[340] == pytest.approx(1.155, abs=1e-3)
    assert np.isnan(sweep(world(level), base=base).ranges[340])
