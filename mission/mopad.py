"""MoPAD as the mission handles it: the robot, its sensors, its clock, and where it believes to be."""

from __future__ import annotations

from contextlib import ExitStack
from types import TracebackType
from typing import Self

import numpy as np
from numpy.typing import NDArray

from mission.config import MissionConfig
from mission.resumption import Earlier
from mission.rigid import Pose, inverted
from sim.camera import Camera, Photo
from sim.hokuyo import Hokuyo, LaserScan
from sim.render import Renderer
from sim.robot import Robot
from sim.scanner import Scan, Scanner
from sim.scene import Scene
from sim.start import upright_pose

SECONDS_PER_PHOTO = 4.0
"""Turning on and charging the flash: our assumption; Riegl and Nikon give no figure [s]."""


MAX_SET_DOWN_ERROR, MAX_SET_DOWN_TURN = 0.05, np.radians(2.0)
"""How far off an operator's word may be where the robot is set down [m, rad]."""


class Mopad:
    """The robot in its scene. Sensors measure from the true pose; what is estimated never reads it."""

    def __init__(self, scene: Scene, config: MissionConfig, *, seed: int, earlier: Earlier | None = None) -> None:
        """Switch the robot on at its start.

        Args:
            scene: With the robot in it.
            config: Parameters of robot and sensors.
            seed: Of all noise; each sensor draws from a stream of its own, scanner and camera anew every time.
            earlier: What need not be measured, for it was, when the same mission was interrupted.
        """
        self._earlier = earlier or Earlier()
        self._scan_seeds, self._photo_seeds, *others = np.random.SeedSequence(seed).spawn(5)
        hokuyo, robot, operator = (np.random.default_rng(s) for s in others)
        self._scene = scene
        self._hokuyo, self._hokuyo_rng = Hokuyo(scene.model, scene.robot_bodies, config.hokuyo), hokuyo
        self.robot = Robot(scene, config.robot, robot)
        self._operator_rng = operator
        self.world_from_odometry: Pose = np.eye(4)
        """What registration and localisation correct the odometry by."""
        self.news: list[str] = []
        """What was put in the robot's way, in words, for the record: it does not know."""
        self._scanner = Scanner(scene.model, config.scanner, hidden_bodies=scene.robot_bodies)
        with ExitStack() as stack:  # what fails from here on closes the renderer
            renderer = stack.enter_context(Renderer(scene.model, hidden_bodies=scene.robot_bodies))
            self._camera = Camera(renderer, config.camera)
            self._owned = stack.pop_all()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._owned.close()

    @property
    def time(self) -> int:
        """Mission time [ns]."""
        return round(self.robot.time * 1e9)

    @property
    def world_from_base(self) -> Pose:
        """Where the robot believes to be."""
        return self.world_from_odometry @ self.robot.odometry

    @property
    def world_from_scanner(self) -> Pose:
        """Where the robot believes its scanner to be."""
        return self.world_from_base @ self.robot.base_from_scanner

    @property
    def true_world_from_scanner(self) -> Pose:
        """Where the scanner is."""
        return self.robot.true_world_from_base @ self.robot.base_from_scanner

    @property
    def laser_height(self) -> float:
        """Of the Hokuyos' plane over the floor that the robot stands on [m]."""
        return float(self.robot.base_from_lasers[0][2, 3])

    @property
    def true_openings(self) -> NDArray[np.float64]:
        """(D,) how far each door of the scene stands open [rad or m]."""
        return self._scene.true_openings()

    def believe(self, world_from_base: Pose) -> None:
        """Correct the odometry: the robot is there now."""
        self.world_from_odometry = world_from_base @ inverted(self.robot.odometry)

    def set_down(self, true_world_from_base: Pose) -> None:
        """An operator carries the robot to a pose (4, 4) and tells it where it is, as well as one can by eye."""
        away, bearing, turn = self._operator_rng.uniform([0, -np.pi, -1], [1, np.pi, 1])
        error = upright_pose(
            MAX_SET_DOWN_ERROR * away * np.array([np.cos(bearing), np.sin(bearing), 0.0]), MAX_SET_DOWN_TURN * turn
        )
        self.robot.set_down(true_world_from_base, true_world_from_base @ error)
        self.world_from_odometry = np.eye(4)

    def scan(self) -> Scan:
        """One panorama; takes the time that the VZ-400 needs."""
        self.meet_obstacles(driving=False)
        rng = np.random.default_rng(*self._scan_seeds.spawn(1))
        scan = self._earlier.scan(self.true_world_from_scanner)
        if scan is None:
            scan = self._scanner.scan(self._scene.data, self.true_world_from_scanner, rng)
        self.robot.wait(scan.duration)
        return scan

    def photograph(self) -> tuple[Photo, ...]:
        """One turn of the camera."""
        rng = np.random.default_rng(*self._photo_seeds.spawn(1))
        photos = self._earlier.photos()
        if photos is None:
            photos = self._camera.photograph(self._scene.data, self.true_world_from_scanner, rng)
        self.robot.wait(SECONDS_PER_PHOTO * len(photos))
        return photos

    def meet_obstacles(self, *, driving: bool) -> None:
        """Let what is due get in the way."""
        robot = self.robot
        self.news += self._scene.obstacles.put_down(
            robot.time, robot.true_world_from_base, footprint=robot.footprint, driving=driving
        )

    def measure_lasers(self) -> list[LaserScan]:
        """One sweep of each Hokuyo."""
        return [
            self._hokuyo.measure(
                self._scene.data,
                self.robot.true_world_from_base,
                base_from_laser,
                rng=self._hokuyo_rng,
                time=self.time,
            )
            for base_from_laser in self.robot.base_from_lasers
        ]
