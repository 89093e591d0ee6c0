"""Legs driven by the robot of the simulator, whose wheels brake and whose body touches."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mission.driving import drive
from mission.grid import Footprint
from sim.hokuyo import Hokuyo, LaserScan
from sim.robot import Robot, RobotParameters
from sim.scene import Scene, load_scene

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
            robot.true_world_from_base @ base_from_laser,
            base_from_laser=base_from_laser,
            rng=rng,
            time=round(robot.time * 1e9),
        )
        for base_from_laser in robot.base_from_lasers
    ]


def way(robot: Robot, x: float) -> NDArray[np.float64]:
    return np.array([robot.odometry[:2, 3], [x, 0.0]])


def test_after_a_touch_the_robot_drives_away_from_what_it_touched(tmp_path: Path) -> None:
    scene, robot = hall(tmp_path, KERB)
    measure, footprint = hokuyos(scene, robot), Footprint(*robot.footprint)
    bump = drive(robot, way(robot, 2.0), measure, footprint=footprint)
    assert bump.outcome == "contact"
    assert bump.reason == "touched kerb"
    again = drive(robot, way(robot, 1.5), measure, footprint=footprint)
    assert again.outcome == "contact"  # still ahead
    back = drive(robot, way(robot, -0.5), measure, footprint=footprint)
    assert back.outcome == "arrived"
    assert (
        robot.true_world_from_base[0, 3] < -0.4
    )  # the tolerance is 5 cm, and wheels that pushed have slipped a little
