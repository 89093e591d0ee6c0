"""MoPAD driven by physics: wheels on a floor, an odometry that drifts, and what it bumps into."""

from __future__ import annotations

import mujoco
import numpy as np

from sim.guardian import RobotParameters, RobotShape
from sim.rays import geom_name
from sim.render.materials import materials_of, srgb_from_linear
from sim.render.visibility import VISUAL_GROUPS
from sim.scene import FOOTPRINT, Scene, set_base
from sim.shapes import triangulate
from sim.start import upright_pose

_LEFT = ("left_front", "left_middle", "left_rear")
_RIGHT = ("right_front", "right_middle", "right_rear")
_ENCODERS = ("left_middle", "right_middle")
_STANDING = 0.7
"""Cosine between a contact's normal and the vertical from which on a wheel stands on what it touches."""


class Robot:
    """MoPAD in a scene. Its base frame lies on the floor midway between the axles, x forward, z up.

    Args:
        scene: the loaded scene; its data is what moves.
        parameters: limits and errors.
        rng: draws the errors of this robot's odometry, once.
    """

    def __init__(self, scene: Scene, parameters: RobotParameters, rng: np.random.Generator):
        self._model, self._data, self._prefix = scene.model, scene.data, scene.robot_prefix
        self.parameters = parameters
        self._own = np.isin(self._model.geom_bodyid, sorted(scene.robot_bodies))
        self._base = self._model.body(f"{self._prefix}base").id
        self._left = [self._model.actuator(self._prefix + name).id for name in _LEFT]
        self._right = [self._model.actuator(self._prefix + name).id for name in _RIGHT]
        self._encoders = [int(self._model.joint(self._prefix + name).qposadr[0]) for name in _ENCODERS]
        self._radii = parameters.wheel_radius * (1 + parameters.encoder_scale_error * rng.standard_normal(2))
        self._track_width = parameters.track_width * (1 + parameters.track_width_error * rng.standard_normal())
        self._speed = np.zeros(2)
        self._touched: set[int] = set()
        self._waited = 0.0
        self._started = self._data.time
        self.base_from_scanner = self._mount("beam_origin")
        """(4, 4) of the scanner's beam origin."""
        self.base_from_lasers = (self._mount("laser_front"), self._mount("laser_rear"))
        """(4, 4) of the front and the rear Hokuyo; their x axes point away from the robot."""
        self.footprint = FOOTPRINT
        """Length and width [m]."""
        self._odometry = scene.world_from_base.copy()
        self.settle()

    @property
    def odometry(self) -> np.ndarray:
        """World pose (4, 4) of the base as the wheels tell it: the known start, then dead reckoning, which drifts."""
        return self._odometry.copy()

    @property
    def true_world_from_base(self) -> np.ndarray:
        """World pose (4, 4) of the base as the physics has it: for sensors to measure from and for the evaluation."""
        pose = np.eye(4)
        pose[:3, :3] = self._data.xmat[self._base].reshape(3, 3)
        pose[:3, 3] = self._data.xpos[self._base]
        return pose

    @property
    def time(self) -> float:
        """Simulated time since the robot was set down, driving and waiting [s]."""
        return float(self._data.time - self._started + self._waited)

    def step(self, v: float, w: float, duration: float) -> None:
        """Hold a command for a while; speeds ramp within the limits of acceleration.

        Args:
            v: forward speed [m/s], cut to the robot's limit.
            w: turn rate, anticlockwise positive [rad/s], cut likewise.
            duration: at least one physics step is done [s].
        """
        limits = np.array([self.parameters.max_speed, self.parameters.max_turn_rate])
        ramps = np.array([self.parameters.max_acceleration, self.parameters.max_turn_acceleration])
        command = np.clip([v, w], -limits, limits)
        timestep = self._model.opt.timestep
        remaining = max(1, round(duration / timestep))
        self._touched = set()
        while remaining > 0:
            steps = min(remaining, max(1, round(self.parameters.control_period / timestep)))
            self._speed += np.clip(command - self._speed, -ramps * steps * timestep, ramps * steps * timestep)
            self._command_wheels()
            before = self._wheel_angles()
            mujoco.mj_step(self._model, self._data, steps)
            self._reckon(self._wheel_angles() - before)
            self._touched |= self._touching()
            remaining -= steps
        mujoco.mj_forward(self._model, self._data)

    def settle(self) -> None:
        """Stop and stand until the robot rests on its wheels."""
        self._speed[:] = 0.0
        self.step(0.0, 0.0, self.parameters.settling_time)

    def wait(self, duration: float) -> None:
        """Stand still with the brakes on while a sensor measures: the clock runs, nothing moves [s]."""
        self._waited += duration

    def set_down(self, true_world_from_base: np.ndarray, told_world_from_base: np.ndarray | None = None) -> None:
        """An operator carries the robot to a pose on the floor and tells it where it is.

        Args:
            true_world_from_base: (4, 4) where it comes to stand.
            told_world_from_base: (4, 4) what its odometry starts from; the truth by default.
        """
        set_base(self._model, self._data, self._prefix, true_world_from_base)
        told = true_world_from_base if told_world_from_base is None else told_world_from_base
        self._odometry = np.array(told, float)
        self.settle()

    def contacts(self) -> tuple[str, ...]:
        """Names of the scene's geoms that the robot touched in the last step, other than what it stood on."""
        return tuple(sorted(geom_name(self._model, geom) for geom in self._touched))

    def shape(self) -> RobotShape:
        """The robot's visible surface."""
        vertices, triangles, colours = [], [], []
        drawn_in = np.round(255 * srgb_from_linear(materials_of(self._model).colour))
        base_from_world = np.linalg.inv(self.true_world_from_base)
        count = 0
        for geom in np.flatnonzero(self._own):
            if self._model.geom_group[geom] >= VISUAL_GROUPS:
                continue
            points, faces = triangulate(self._model, int(geom))
            in_world = points @ self._data.geom_xmat[geom].reshape(3, 3).T + self._data.geom_xpos[geom]
            vertices.append(in_world @ base_from_world[:3, :3].T + base_from_world[:3, 3])
            triangles.append(faces + count)
            colours.append(np.tile(drawn_in[geom], (len(points), 1)))
            count += len(points)
        return RobotShape(
            np.concatenate(vertices).astype(np.float32),
            np.concatenate(triangles).astype(np.int32),
            np.concatenate(colours).astype(np.uint8),
        )

    def _command_wheels(self) -> None:
        v, w = self._speed
        half = w * self.parameters.track_width / 2
        self._data.ctrl[self._left] = (v - half) / self.parameters.wheel_radius
        self._data.ctrl[self._right] = (v + half) / self.parameters.wheel_radius

    def _touching(self) -> set[int]:
        """Geoms of the scene that the robot touches other than from above."""
        contacts = self._data.contact
        beside = (contacts.dist <= 0) & (np.abs(contacts.frame[:, 2]) < _STANDING)
        if not beside.any():
            return set()
        geoms = contacts.geom[beside]
        mine = self._own[geoms]
        return set(geoms[~mine & mine[:, ::-1]].tolist())

    def _wheel_angles(self) -> np.ndarray:
        return self._data.qpos[self._encoders].copy()

    def _reckon(self, turned: np.ndarray) -> None:
        """Move the odometry along the arc that the wheels tell of (2,) [rad]."""
        left, right = turned * self._radii
        turn = (right - left) / self._track_width
        arc = upright_pose(np.zeros(3), turn)
        middle = turn / 2
        arc[:2, 3] = (left + right) / 2 * np.sinc(middle / np.pi) * np.array([np.cos(middle), np.sin(middle)])
        self._odometry = self._odometry @ arc

    def _mount(self, name: str) -> np.ndarray:
        site = self._data.site(self._prefix + name)
        world_from_site = np.eye(4)
        world_from_site[:3, :3], world_from_site[:3, 3] = site.xmat.reshape(3, 3), site.xpos
        return np.linalg.inv(self.true_world_from_base) @ world_from_site
