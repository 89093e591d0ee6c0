"""Driving along a path until arrival, or until something is in the way; the record of it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from mission.following import Command, DrivingParameters, eased, follow_path, gap_to_body, remaining, restrained
from mission.grid import Footprint
from mission.localisation import readings_in_base
from mission.rigid import inverted

if TYPE_CHECKING:
    from sim.guardian import RobotParameters
    from sim.laser_scan import LaserScan


Outcome = Literal["arrived", "blocked", "stuck", "contact"]
"""How a leg ended."""

Localise = Callable[[Sequence["LaserScan"], NDArray[np.float64]], NDArray[np.float64]]
"""Gives the pose (4, 4) that fits readings best, from them and the pose by odometry."""

STANDING = 1e-3
"""Wheels slower than this stand [m/s, rad/s]."""


class DrivenRobot(Protocol):
    """What driving needs of a robot."""

    @property
    def parameters(self) -> RobotParameters:
        """Its limits of speed and acceleration."""

    @property
    def time(self) -> float:
        """Simulated time [s]."""

    @property
    def odometry(self) -> NDArray[np.float64]:
        """(4, 4) world_from_base as the wheels count it."""

    def step(self, v: float, w: float, duration: float) -> None:
        """Hold a speed [m/s] and a turn rate [rad/s] for a time [s]."""

    def contacts(self) -> Sequence[str]:
        """Names of what the robot touches, the floor apart."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Drive:
    """A leg as it was driven."""

    times: NDArray[np.int64]
    """(T,) simulated time of each pose [ns]."""
    world_from_base: NDArray[np.float64]
    """(T, 4, 4) poses by odometry and localisation; the first is the start, the last where the robot stands now."""
    laser_scans: tuple[LaserScan, ...]
    """Hokuyo scans on the way; the last of them were taken at the end."""
    world_from_base_at_laser: NDArray[np.float64]
    """(len(laser_scans), 4, 4) pose at which each was taken."""
    outcome: Outcome
    reason: str
    """The outcome in words."""

    @property
    def arrived(self) -> bool:
        """Whether the robot stands at the end of its path."""
        return self.outcome == "arrived"


def drive(
    robot: DrivenRobot,
    path: NDArray[np.float64],
    measure: Callable[[], Sequence[LaserScan]],
    *,
    footprint: Footprint,
    world_from_odometry: NDArray[np.float64] | None = None,
    parameters: DrivingParameters | None = None,
    localise: Localise | None = None,
    watch: Callable[[], None] = lambda: None,
) -> Drive:
    """Drive along a path until its end, or until something is touched or seen in the way, or nothing moves any more.

    What the robot touches already when the leg begins does not end it, provided that the leg leads away from it. At
    the end it stands, whatever the outcome.

    Args:
        robot: Is moved.
        path: (P, 2) way points in the world [m], the robot's position first.
        measure: Takes a reading of each Hokuyo now.
        footprint: Of the robot.
        world_from_odometry: (4, 4) correction that the last registration made to the odometry; none by default.
        localise: Gives the pose (4, 4) that fits readings best, from them and the pose by odometry; asked now and then.
        watch: Called at each recorded pose, so that the caller can note what else it wants beside it.
    """
    parameters = parameters or DrivingParameters()
    correction = np.eye(4) if world_from_odometry is None else world_from_odometry
    log = _Log(robot, measure, localise, watch, correction=correction, parameters=parameters)
    outcome, reason = _advance(robot, path, log, footprint=footprint, parameters=parameters)
    _halt(robot, log, parameters)
    return log.closed(outcome, reason)


def _advance(
    robot: DrivenRobot, path: NDArray[np.float64], log: _Log, *, footprint: Footprint, parameters: DrivingParameters
) -> tuple[Outcome, str]:
    """Go on until the leg ends; the robot may still roll then.

    Returns:
        How it ended, and that in words.
    """
    command = Command(0.0, 0.0, 1)
    began, held = robot.time, set(robot.contacts())
    best, since = np.inf, robot.time
    while True:
        scans, pose = log.look()
        touched = set(robot.contacts())
        held &= touched
        if touched - held or (held and robot.time - began > parameters.release):
            return "contact", f"touched {', '.join(sorted(touched))}"
        wanted = follow_path(path, pose, target=command.target, robot=robot.parameters, parameters=parameters)
        if wanted.target == len(path):
            return "arrived", "reached the end of the path"
        obstacles = readings_in_base(scans)
        next_command = eased(wanted, command, robot=robot.parameters, parameters=parameters)
        allowed = restrained(next_command, obstacles, footprint=footprint, parameters=parameters)
        if allowed is None:
            gap = gap_to_body(obstacles, footprint).min()
            return "blocked", f"an obstacle {gap:.2f} m from the body is in the way"
        left = remaining(path, pose, wanted.target)
        if left < best - parameters.progress:
            best, since = left, robot.time
        if robot.time - since >= parameters.patience:
            return "stuck", f"no progress for {parameters.patience:g} s, {left:.2f} m from the goal"
        robot.step(allowed.speed, allowed.turn_rate, parameters.tick)
        command = allowed


def _halt(robot: DrivenRobot, log: _Log, parameters: DrivingParameters) -> None:
    """Brake until the wheels stand: a scan from a robot that rolls is smeared, and its pose is stale."""
    for _ in range(round(parameters.halt / parameters.tick)):
        before = robot.odometry
        robot.step(0.0, 0.0, parameters.tick)
        log.look()
        moved = inverted(before) @ robot.odometry
        if max(np.hypot(*moved[:2, 3]), abs(moved[1, 0])) < STANDING * parameters.tick:
            return


class _Log:
    """Looks about at every tick, and gathers what a `Drive` is made of."""

    def __init__(
        self,
        robot: DrivenRobot,
        measure: Callable[[], Sequence[LaserScan]],
        localise: Localise | None,
        watch: Callable[[], None],
        *,
        correction: NDArray[np.float64],
        parameters: DrivingParameters,
    ) -> None:
        self._robot, self._measure, self._localise, self._watch = robot, measure, localise, watch
        self._correction, self._matched = correction, robot.time
        self._parameters = parameters
        self._times: list[int] = []
        self._poses: list[NDArray[np.float64]] = []
        self._kept: list[tuple[LaserScan, NDArray[np.float64]]] = []
        self._now: list[tuple[LaserScan, NDArray[np.float64]]] = []
        self._next_laser = -np.inf

    def look(self) -> tuple[Sequence[LaserScan], NDArray[np.float64]]:
        """Measure, localise now and then, and record this moment.

        Returns:
            A reading of each Hokuyo, and the pose (4, 4) at which they were taken.
        """
        scans, pose, time = self._measure(), self._correction @ self._robot.odometry, self._robot.time
        if self._localise is not None and time - self._matched >= self._parameters.match_every - 1e-9:
            pose, self._matched = self._localise(scans, pose), time
            self._correction = pose @ inverted(self._robot.odometry)
        self._times.append(round(time * 1e9))
        self._poses.append(pose)
        self._now = [(scan, pose) for scan in scans]
        if time >= self._next_laser - 1e-9:
            self._kept += self._now
            self._now = []
            self._next_laser = time + self._parameters.laser_every
        self._watch()
        return scans, pose

    def closed(self, outcome: Outcome, reason: str) -> Drive:
        """The record, its last laser scans those of the last moment."""
        kept = self._kept + self._now
        return Drive(
            times=np.array(self._times, dtype=np.int64),
            world_from_base=np.array(self._poses),
            laser_scans=tuple(scan for scan, _ in kept),
            world_from_base_at_laser=np.array([pose for _, pose in kept]).reshape(-1, 4, 4),
            outcome=outcome,
            reason=reason,
        )
