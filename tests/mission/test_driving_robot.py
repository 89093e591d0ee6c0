"""Legs driven by the robot of the simulator, whose wheels brake and whose body touches."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import mujoco
import numpy as np
import pytest
from numpy.typing import NDArray

from mission.driving import drive
from sim.hokuyo import Hokuyo, LaserScan
from sim.robot import Robot, RobotParameters
from sim.scene import Scene, load_scene
from tests.mission.driving_world import FOOTPRINT, Unicycle, pose

HALL = """
<mujoco>
  <worldbody>
    <geom name="floor" type="plane" size="8 8 1"/>
    <geom name="far_wall" type="box" pos="7 0 1.25" size="0.1 7 1.25"/>
    {things}
    <site name="start"/>
  </worldbody>
</mujoco>"""
KERB = '<geom name="kerb" type="box" pos="1.1 0 0.15" size="0.1 1 0.15"/>'
"""Too low for the Hokuyos, whose plane is 0.47-0.49 m high; the body ends at 0.485, so it is touched at x = 0.515."""


def hall(folder: Path, things: str = "") -> tuple[Scene, Robot]:
    path = folder / "hall.xml"
    path.write_text(HALL.format(things=things))
    scene = load_scene(path)
    exact = RobotParameters(encoder_scale_error=0.0, track_width_error=0.0)
    return scene, Robot(scene, exact, np.random.default_rng(0))


def hokuyos(scene: Scene, robot: Robot) -> Callable[[], Sequence[LaserScan]]:
    hokuyo, rng = Hokuyo(scene.model, scene.robot_bodies), np.random.default_rng(0)
    return lambda: [
        hokuyo.measure(
            scene.data,
            robot.true_world_from_base,
            base_from_laser,
            rng=rng,
            time=round(robot.time * 1e9),
        )
        for base_from_laser in robot.base_from_lasers
    ]


def way(robot: Robot, x: float) -> NDArray[np.float64]:
    return np.array([robot.odometry[:2, 3], [x, 0.0]])


def test_after_a_touch_the_robot_drives_away_from_what_it_touched(tmp_path: Path) -> None:
    scene, robot = hall(tmp_path, KERB)
    measure = hokuyos(scene, robot)
    bump = drive(robot, way(robot, 2.0), measure, footprint=FOOTPRINT)
    assert bump.outcome == "contact"
    assert bump.reason == "touched kerb"
    again = drive(robot, way(robot, 1.5), measure, footprint=FOOTPRINT)
    assert again.outcome == "contact"  # still ahead
    back = drive(robot, way(robot, -0.5), measure, footprint=FOOTPRINT)
    assert back.outcome == "arrived"
    assert (
        robot.true_world_from_base[0, 3] < -0.4
    )  # the tolerance is 5 cm, and wheels that pushed have slipped a little


def test_at_the_end_of_a_leg_the_robot_stands_where_the_record_ends(tmp_path: Path) -> None:
    scene, robot = hall(tmp_path)
    truth: list[NDArray[np.float64]] = []
    leg = drive(
        robot,
        way(robot, 1.0),
        hokuyos(scene, robot),
        footprint=FOOTPRINT,
        watch=lambda: truth.append(robot.true_world_from_base),
    )
    assert leg.outcome == "arrived"
    assert abs(scene.data.qvel).max() < 1e-3  # a tenth of a millimetre in a tick
    np.testing.assert_array_equal(leg.world_from_base[-1], robot.odometry)
    np.testing.assert_array_equal(truth[-1], robot.true_world_from_base)
    assert len(truth) == len(leg.times)
    assert leg.times[-1] == leg.laser_scans[-1].time == round(robot.time * 1e9)
    np.testing.assert_array_equal(leg.world_from_base_at_laser[-1], leg.world_from_base[-1])


def test_a_blocked_leg_ends_standing_short_of_the_wall(tmp_path: Path) -> None:
    scene, robot = hall(tmp_path, '<geom name="box" type="box" pos="2 0 0.5" size="0.1 1 0.5"/>')
    leg = drive(robot, way(robot, 3.0), hokuyos(scene, robot), footprint=FOOTPRINT)
    assert leg.outcome == "blocked"
    assert abs(scene.data.qvel).max() < 1e-3
    assert robot.contacts() == ()
    body = [int(geom) for geom in np.flatnonzero(np.isin(scene.model.geom_bodyid, sorted(scene.robot_bodies)))]
    box, ends = scene.model.geom("box").id, np.zeros(6)
    gap = min(mujoco.mj_geomDistance(scene.model, scene.data, geom, box, 1.0, ends) for geom in body)
    assert 0.05 <= gap < 0.25  # and it did try: at 0.3 m/s it looks 0.24 m ahead


def test_a_wheel_that_never_stands_is_waited_for_three_seconds_only() -> None:
    robot = Unicycle(pose(0, 0))
    robot.step = lambda v, w, duration: Unicycle.step(robot, 0.1, w, duration)  # type: ignore[method-assign]
    leg = drive(robot, np.array([[0.0, 0.0], [0.01, 0.0]]), lambda: [], footprint=FOOTPRINT)
    assert leg.outcome == "arrived"  # at once
    assert robot.time == pytest.approx(3.0, abs=0.05)
