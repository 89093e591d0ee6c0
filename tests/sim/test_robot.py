"""MoPAD drives by physics and knows where it is only by its wheels."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sim.robot import Robot, RobotParameters
from sim.scene import Scene, load_scene

HALL = """
<mujoco>
  {option}
  <worldbody>
    <geom name="floor" type="plane" size="8 8 1" friction="{friction}"/>
    <geom name="far_wall" type="box" pos="7 0 1.25" size="0.1 7 1.25"/>
    {things}
    <site name="start" euler="0 0 {heading}"/>
  </worldbody>
</mujoco>"""
EXACT = RobotParameters(encoder_scale_error=0.0, track_width_error=0.0)


def hall(tmp_path: Path, *, things: str = "", friction: float = 1.0, option: str = "", heading: float = 0.0) -> Scene:
    path = tmp_path / "hall.xml"
    path.write_text(HALL.format(option=option, friction=friction, things=things, heading=heading))
    return load_scene(path)


def robot_in(scene: Scene, parameters: RobotParameters = EXACT, seed: int = 0) -> Robot:
    return Robot(scene, parameters, np.random.default_rng(seed))


def moved(before: np.ndarray, after: np.ndarray) -> tuple[np.ndarray, float]:
    """Shift in the frame of the first pose [m] and turn [rad]."""
    change = np.linalg.inv(before) @ after
    return change[:3, 3], float(np.arctan2(change[1, 0], change[0, 0]))


def drive(robot: Robot, v: float, w: float, duration: float) -> tuple[np.ndarray, float]:
    before = robot.true_world_from_base
    robot.step(v, w, duration)
    robot.step(0.0, 0.0, 1.0)
    return moved(before, robot.true_world_from_base)


@pytest.mark.parametrize("direction", [1, -1])
def test_a_metre_straight_ahead_arrives_a_metre_ahead(tmp_path: Path, direction: int) -> None:
    robot = robot_in(hall(tmp_path, heading=30))
    # Both ramps at 0.5 m/s2 take 0.6 s: the one on the way adds 0.3 * 0.6 / 2, the one at its start takes as much away.
    shift, turn = drive(robot, direction * 0.3, 0.0, 1 / 0.3)
    np.testing.assert_allclose(shift, [direction, 0, 0], atol=0.01)
    assert abs(np.degrees(turn)) < 0.1


@pytest.mark.parametrize("friction", [0.2, 1.0, 3.0])
def test_it_turns_about_its_centre_at_the_rate_asked_on_any_floor(tmp_path: Path, friction: float) -> None:
    robot = robot_in(hall(tmp_path, friction=friction))
    # The ramp at 1 rad/s2 takes as much at the start as it adds at the end, so 0.5 rad/s for pi s is a quarter turn.
    shift, turn = drive(robot, 0.0, 0.5, np.pi)
    assert np.linalg.norm(shift) < 0.005
    assert np.degrees(turn) == pytest.approx(90, abs=4), "a few percent of slip"


@pytest.mark.parametrize("option", ["", '<option timestep="0.01" integrator="RK4"/>', '<option timestep="0.0005"/>'])
def test_it_neither_bounces_nor_tips_whatever_the_scene_s_timestep(tmp_path: Path, option: str) -> None:
    robot = robot_in(hall(tmp_path, option=option))
    heights, tilts = [], []
    for v, w in ((0.3, 0.0), (-0.3, 0.7), (0.3, -0.7), (0.0, 0.0)):
        for _ in range(4):
            robot.step(v, w, 0.25)
            heights.append(robot.true_world_from_base[2, 3])
            tilts.append(np.degrees(np.arccos(min(1.0, robot.true_world_from_base[2, 2]))))
    assert np.ptp(heights) < 0.002
    assert max(tilts) < 0.3


def test_speeds_and_accelerations_stay_within_the_limits(tmp_path: Path) -> None:
    robot = robot_in(hall(tmp_path))
    places = [robot.true_world_from_base[0, 3]]
    for _ in range(20):
        robot.step(9.0, 0.0, 0.1)
        places.append(robot.true_world_from_base[0, 3])
    speeds = np.diff(places) / 0.1
    assert speeds.max() < 0.305
    assert np.diff(speeds).max() / 0.1 < 0.65, "0.5 m/s2 and a little swing"


def test_standing_still_it_stays_where_it_is(tmp_path: Path) -> None:
    robot = robot_in(hall(tmp_path))
    drive(robot, 0.2, 0.3, 1.0)
    shift, turn = drive(robot, 0.0, 0.0, 10.0)
    assert np.linalg.norm(shift) < 1e-4
    assert abs(turn) < 1e-4


def test_odometry_starts_at_the_known_start_and_drifts_by_percents(tmp_path: Path) -> None:
    scene = hall(tmp_path, heading=120)
    robot = robot_in(scene, RobotParameters(), seed=3)
    shift, turn = moved(robot.odometry, scene.world_from_base)
    assert np.linalg.norm(shift) < 1e-3 and abs(turn) < 1e-3

    for _ in range(4):
        robot.step(0.3, 0.0, 3.0)
        robot.step(0.0, 0.6, 2.6)
    robot.step(0.0, 0.0, 1.0)

    shift, turn = moved(robot.true_world_from_base, robot.odometry)
    assert 0.005 < np.linalg.norm(shift) < 0.4, "of 3.6 m driven"
    assert 0.2 < abs(np.degrees(turn)) < 40, "of 360 deg turned"


def test_the_errors_of_the_odometry_belong_to_the_seed(tmp_path: Path) -> None:
    ends = []
    for seed in (1, 1, 2):
        robot = robot_in(hall(tmp_path), RobotParameters(), seed)
        robot.step(0.3, 0.3, 1.0)
        ends.append(robot.odometry)
    assert np.array_equal(ends[0], ends[1])
    assert not np.allclose(ends[0], ends[2], atol=1e-5)


GATE = """
<geom name="left_post" type="box" pos="1.5 {y} 1" size="0.06 1 1"/>
<geom name="right_post" type="box" pos="1.5 -{y} 1" size="0.06 1 1"/>"""


def test_it_fits_through_a_doorway_of_80_cm_and_touches_nothing(tmp_path: Path) -> None:
    robot = robot_in(hall(tmp_path, things=GATE.format(y=1.4)))  # posts from 0.4 outward
    for _ in range(10):
        robot.step(0.3, 0.0, 1.0)
        assert robot.contacts() == ()
    assert robot.true_world_from_base[0, 3] > 2.5


def test_a_gate_of_50_cm_stops_it_and_contacts_names_the_posts_but_not_the_floor(tmp_path: Path) -> None:
    robot = robot_in(hall(tmp_path, things=GATE.format(y=1.25)))
    robot.step(0.3, 0.0, 6.0)
    assert robot.contacts() == ("left_post", "right_post")
    # The chassis ends 0.4855 m ahead of the base, the posts begin at 1.44.
    assert robot.true_world_from_base[0, 3] == pytest.approx(1.44 - 0.4855, abs=0.02)


def test_it_climbs_a_threshold_of_a_centimetre(tmp_path: Path) -> None:
    sill = '<geom name="sill" type="box" pos="1 0 0.005" size="0.05 0.6 0.005"/>'
    robot = robot_in(hall(tmp_path, things=sill))
    robot.step(0.3, 0.0, 7.0)
    assert robot.true_world_from_base[0, 3] > 1.8
    assert robot.contacts() == ()


def test_its_sensors_sit_where_the_makers_put_them(tmp_path: Path) -> None:
    robot = robot_in(hall(tmp_path, heading=70))
    np.testing.assert_allclose(robot.base_from_scanner[:3, 3], [0, 0, 1.15], atol=1e-9)
    np.testing.assert_allclose(robot.base_from_scanner[:3, :3], np.eye(3), atol=1e-9)
    front, rear = robot.base_from_lasers
    # (0.442, 0, 0.312) and (-0.432, 0, 0.292) of base_link, which is 0.18 m above the floor
    np.testing.assert_allclose(front[:3, 3], [0.442, 0, 0.492], atol=1e-9)
    np.testing.assert_allclose(rear[:3, 3], [-0.432, 0, 0.472], atol=1e-9)
    np.testing.assert_allclose(rear[:3, 0], [-1, 0, 0], atol=1e-9)


def test_waiting_lets_the_clock_run_and_nothing_move(tmp_path: Path) -> None:
    robot = robot_in(hall(tmp_path))
    before, start = robot.true_world_from_base, robot.time
    robot.wait(82.0)
    assert robot.time - start == pytest.approx(82.0)
    assert np.array_equal(robot.true_world_from_base, before)
    robot.step(0.0, 0.0, 0.5)
    assert robot.time - start == pytest.approx(82.5)


def test_an_operator_s_new_place_is_known_to_the_odometry(tmp_path: Path) -> None:
    robot = robot_in(hall(tmp_path))
    robot.step(0.3, 0.2, 2.0)
    place = np.eye(4)
    place[:2, 3] = [2, -3]
    robot.set_down(place)
    np.testing.assert_allclose(robot.odometry, place, atol=1e-3)
    np.testing.assert_allclose(robot.true_world_from_base, place, atol=1e-3)


def test_its_drawn_shape_is_closed_and_lies_within_its_footprint(tmp_path: Path) -> None:
    robot = robot_in(hall(tmp_path, heading=45))
    shape = robot.shape()
    assert shape.triangles.max() < len(shape.vertices) == len(shape.colours)
    length, width = robot.footprint
    low, high = shape.vertices.min(0), shape.vertices.max(0)
    np.testing.assert_allclose([*low, *high], [-length / 2, -width / 2, 0, length / 2, width / 2, 1.43], atol=0.01)


def test_it_is_drawn_in_the_colours_that_are_rendered(tmp_path: Path) -> None:
    scene = hall(tmp_path)
    (lid,) = (
        geom for geom in range(scene.model.ngeom) if np.allclose(scene.model.geom_size[geom], [0.4855, 0.2605, 0.035])
    )
    assert (robot_in(scene).shape().colours == [219, 92, 20]).all(axis=1).any()  # of its material: 0.86 0.36 0.08
    scene.model.geom_rgba[lid] = [0.2, 0.4, 0.6, 1]  # overrides the material
    colours = robot_in(scene).shape().colours
    assert (colours == [51, 102, 153]).all(axis=1).sum() == 8  # the corners of a box


def test_a_door_can_be_bumped_into_and_gives_way(tmp_path: Path) -> None:
    leaf = """<body name="leaf" pos="1.5 0.45 0"><joint name="leaf" axis="0 0 1" range="0 100" damping="1"/>
      <geom name="panel" type="box" pos="0 -0.4 1.02" size="0.02 0.4 1" mass="20"/></body>"""
    scene = hall(tmp_path, things=leaf)
    robot = robot_in(scene)
    robot.step(0.3, 0.0, 4.5)
    assert robot.contacts() == ("panel",)
    assert np.degrees(scene.data.joint("leaf").qpos[0]) > 10
