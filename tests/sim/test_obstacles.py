"""Boxes that are put into the robot's way while it is under way."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sim.errors import SimError
from sim.hokuyo import Hokuyo
from sim.obstacles import Obstacle
from sim.robot import Robot, RobotParameters
from sim.scene import Scene, load_scene

HALL = """
<mujoco>
  <worldbody>
    <geom type="box" pos="0 0 -0.05" size="5 5 0.05"/>
    <geom name="wall" type="box" pos="4 0 1.25" size="0.1 4 1.25"/>
    <site name="start"/>
  </worldbody>
</mujoco>"""

WALLS = (("-4 0", "0.1 4"), ("0 4", "4 0.1"), ("0 -4", "4 0.1"))
"""The others, of a room of 8 x 8 m."""


def hall(folder: Path, *obstacles: Obstacle) -> Scene:
    path = folder / "hall.xml"
    path.write_text(HALL)
    return load_scene(path, obstacles=obstacles)


def put_down(scene: Scene, time: float, *, x: float = 0.0, driving: bool = True) -> tuple[str, ...]:
    """With the robot at (x, 0)."""
    pose = np.eye(4)
    pose[0, 3] = x
    return scene.obstacles.put_down(time, pose, footprint=(0.97, 0.57), driving=driving)


def ahead(scene: Scene, robot: Robot) -> float:
    """Range of the front Hokuyo straight ahead [m]; infinite where it sees nothing."""
    hokuyo = Hokuyo(scene.model, scene.robot_bodies)
    scan = hokuyo.measure(
        scene.data, robot.true_world_from_base, robot.base_from_lasers[0], rng=np.random.default_rng(0), time=0
    )
    return float(np.nan_to_num(scan.ranges[341], nan=np.inf))


def test_an_obstacle_is_seen_and_touched_from_the_time_on_when_it_is_put_down(tmp_path: Path) -> None:
    scene = hall(tmp_path, Obstacle(1.5, 0.0, 10.0))
    robot = Robot(scene, RobotParameters(), np.random.default_rng(0))
    before = ahead(scene, robot)  # the wall's face, at x = 3.9
    assert put_down(scene, 9.9) == ()
    assert ahead(scene, robot) == pytest.approx(before, abs=0.1)
    assert put_down(scene, 10.0) == ("an obstacle stands at (1.50, 0.00)",)
    assert before - ahead(scene, robot) == pytest.approx(3.9 - 1.3, abs=0.1)  # its face is at x = 1.5 - 0.2
    assert put_down(scene, 11.0) == ()  # once is enough
    robot.step(0.3, 0.0, 5.0)  # 1.5 m, of which 1.3 - 0.485 are free
    assert robot.contacts() == ("put_down/obstacle_1",)


def test_an_obstacle_without_a_time_is_put_down_when_the_robot_sets_off(tmp_path: Path) -> None:
    scene = hall(tmp_path, Obstacle(1.5, 0.0))
    assert put_down(scene, 100.0, driving=False) == ()
    assert len(put_down(scene, 100.0)) == 1


def test_an_obstacle_waits_until_the_robot_is_out_of_its_way(tmp_path: Path) -> None:
    # Half the diagonals are 0.56 and 0.28 m, and 5 cm between: 0.9 m from middle to middle are enough.
    scene = hall(tmp_path, Obstacle(2.0, 0.0))
    assert put_down(scene, 5.0, x=1.2) == ()
    assert len(put_down(scene, 6.0, x=1.05)) == 1


@pytest.mark.parametrize(
    ("obstacle", "wrong"),
    [(Obstacle(3.75, 0.0), "wall"), (Obstacle(0.3, 0.0), "mopad"), (Obstacle(0.0, 9.0), "no floor")],
)
def test_an_obstacle_in_a_wall_in_the_robot_or_in_the_air_is_refused(
    tmp_path: Path, obstacle: Obstacle, wrong: str
) -> None:
    with pytest.raises(SimError, match=wrong) as error:
        hall(tmp_path, obstacle)
    assert f"obstacle at ({obstacle.x:.2f}, {obstacle.y:.2f})" in str(error.value)


def test_the_start_is_not_looked_for_on_what_is_put_down_later(tmp_path: Path) -> None:
    path = tmp_path / "room.xml"
    walls = [f'<geom type="box" pos="{pos} 1.25" size="{size} 1.25"/>' for pos, size in WALLS]
    path.write_text(HALL.replace('<site name="start"/>', "".join(walls)))
    free = load_scene(path).world_from_base
    again = load_scene(path, obstacles=[Obstacle(free[0, 3] + 1.2, free[1, 3])]).world_from_base
    np.testing.assert_allclose(again, free)
    assert free[2, 3] == pytest.approx(0.0, abs=1e-9)
