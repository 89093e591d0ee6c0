"""Deciding what to command next on a path, and what of it the obstacles in sight allow."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from mission.grid import Footprint
from sim.guardian import RobotParameters
from sim.parameters import Parameters


class DrivingParameters(Parameters):
    """How exactly and how carefully the robot follows its path; how fast is the robot's own limit."""

    acceleration: float = Field(
        default=0.3, ge=0.01, le=2.0, description="[m/s2], for braking too; at most what the robot can do"
    )
    heading_gain: float = Field(default=2.0, ge=0.01, le=10.0, description="Turn rate per heading error [1/s]")
    aligned: float = Field(
        default=0.17, ge=0.01, le=1.0, description="Heading error at which driving gives way to turning [rad]"
    )
    backwards: float = Field(
        default=0.5, ge=0.0, le=1.6, description="A way point this close to straight behind: reverse [rad]"
    )
    tolerance: float = Field(default=0.05, ge=0.005, le=0.5, description="A way point is reached from here on [m]")
    tick: float = Field(default=0.1, ge=0.01, le=1.0, description="Time between commands [s]; the Hokuyos' 10 Hz")
    foresight: float = Field(
        default=0.8, ge=0.0, le=5.0, description="The body's next moves must be free for so long [s]"
    )
    guard: float = Field(
        default=0.04,
        ge=0.0,
        le=0.5,
        description="Readings may not come closer to the body than this [m]: with their noise, 5 cm stay clear",
    )
    readings: int = Field(
        default=2, ge=1, le=50, description="So many within the guard are an obstacle; fewer are noise"
    )
    patience: float = Field(default=30.0, ge=1.0, le=600.0, description="Without progress for so long: stuck [s]")
    progress: float = Field(default=0.05, ge=0.001, le=1.0, description="What counts as progress along the path [m]")
    halt: float = Field(
        default=3.0, gt=0.0, le=30.0, description="Braking at the end of a leg takes so long at most [s]"
    )
    release: float = Field(
        default=1.0, ge=0.0, le=10.0, description="A leg that starts at a touch must be free of it after so long [s]"
    )
    match_every: float = Field(default=0.5, gt=0.0, le=60.0, description="Time between localisations [s]")
    laser_every: float = Field(
        default=1.0, gt=0.0, le=60.0, description="Time between Hokuyo scans kept for the record [s]"
    )


@dataclass(frozen=True)
class Command:
    """What the robot is to do for the next tick."""

    speed: float
    """Forward [m/s]; negative is backwards."""
    turn_rate: float
    """Anticlockwise [rad/s]."""
    target: int
    """Index of the way point headed for; the path's length once it is done."""


def follow_path(
    path: NDArray[np.float64],
    world_from_base: NDArray[np.float64],
    *,
    target: int = 1,
    robot: RobotParameters | None = None,
    parameters: DrivingParameters | None = None,
) -> Command:
    """Decide the next command: turn towards the way point, then drive to it, then on to the next.

    The robot heads for the way point itself, so what odometry or slip has put it beside the leg shrinks along the leg.

    Args:
        path: (P, 2) way points in the world [m], the start among them.
        world_from_base: (4, 4) present pose.
        target: Way point headed for so far, from the last command.
        robot: What is driven: its limits of speed.
    """
    parameters, robot = parameters or DrivingParameters(), robot or RobotParameters()
    position, ahead = world_from_base[:2, 3], world_from_base[:2, 0]
    heading = float(np.arctan2(ahead[1], ahead[0]))
    while target < len(path):
        distance, error = _towards(path[target], position, heading)
        # A way point just missed is not worth turning round for.
        if distance > parameters.tolerance and not (distance < 2 * parameters.tolerance and abs(error) > np.pi / 2):
            break
        target += 1
    else:
        return Command(0.0, 0.0, target)
    reverse = abs(error) > np.pi - parameters.backwards
    if reverse:
        error = _wrapped(error + np.pi)
    turn_rate = float(np.clip(parameters.heading_gain * error, -robot.max_turn_rate, robot.max_turn_rate))
    acceleration = min(parameters.acceleration, robot.max_acceleration)
    braking = float(np.sqrt(2 * acceleration * max(distance - parameters.tolerance, 0.0)))
    speed = min(robot.max_speed, max(braking, parameters.tolerance / 1.0)) * max(
        0.0, 1.0 - abs(error) / parameters.aligned
    )
    return Command(-speed if reverse else speed, turn_rate, target)


def restrained(
    command: Command,
    obstacles_in_base: NDArray[np.float64],
    *,
    footprint: Footprint,
    parameters: DrivingParameters,
) -> Command | None:
    """The command at the fastest of full, half and quarter speed that is safe; None if none is.

    Safe is what brings no obstacle within the guard around the body during the foresight. What is within the guard
    already may not come closer.

    Args:
        obstacles_in_base: (N, 2) readings of the Hokuyos [m].
    """
    # Turning keeps a reading's distance from the base's middle: so far away nothing comes within the guard.
    reach = footprint.half_diagonal + parameters.guard + abs(command.speed) * parameters.foresight
    obstacles = obstacles_in_base[np.hypot(*obstacles_in_base.T) < reach + 0.01]
    now = gap_to_body(obstacles, footprint)
    times = np.arange(parameters.tick, parameters.foresight + 1e-9, parameters.tick)
    for share in (1.0, 0.5, 0.25):
        speed, turn_rate = share * command.speed, share * command.turn_rate
        inside = np.zeros(len(now), dtype=np.bool_)
        for time in times:
            gap = gap_to_body(_seen_after(obstacles, speed, turn_rate, time), footprint)
            inside |= (gap < parameters.guard) & (gap < now - 0.005)
        if inside.sum() < parameters.readings:
            return Command(speed, turn_rate, command.target)
    return None


def remaining(path: NDArray[np.float64], pose: NDArray[np.float64], target: int) -> float:
    """What is left to do: metres of path, and turning towards the way point at a third of a metre a radian."""
    distance, error = _towards(path[target], pose[:2, 3], float(np.arctan2(pose[1, 0], pose[0, 0])))
    return distance + float(np.hypot(*np.diff(path[target:], axis=0).T).sum()) + min(abs(error), np.pi - abs(error)) / 3


def _wrapped(angle: float) -> float:
    """The same angle between -pi and pi."""
    return float((angle + np.pi) % (2 * np.pi) - np.pi)


def _towards(point: NDArray[np.float64], position: NDArray[np.float64], heading: float) -> tuple[float, float]:
    """Distance [m] and heading error [rad] to a point."""
    offset = point - position
    return float(np.hypot(*offset)), _wrapped(float(np.arctan2(offset[1], offset[0])) - heading)


def eased(wanted: Command, last: Command, *, robot: RobotParameters, parameters: DrivingParameters) -> Command:
    """The wanted command, its speed no more than one tick's acceleration away from the last one's."""
    change = min(parameters.acceleration, robot.max_acceleration) * parameters.tick
    return Command(
        float(np.clip(wanted.speed, last.speed - change, last.speed + change)), wanted.turn_rate, wanted.target
    )


def gap_to_body(points: NDArray[np.float64], footprint: Footprint) -> NDArray[np.float64]:
    """(N,) distance from the body's sides to points of the base frame [m], negative inside."""
    beyond = abs(points) - np.array([footprint.length, footprint.width]) / 2
    return np.where((beyond > 0).all(axis=1), np.hypot(beyond[:, 0], beyond[:, 1]), beyond.max(axis=1))


def _seen_after(points: NDArray[np.float64], speed: float, turn_rate: float, time: float) -> NDArray[np.float64]:
    """(N, 2) standing points as the base frame will have them after a time of constant command."""
    turned = turn_rate * time
    # Along the arc; sinc keeps it exact for a straight line: sin(x)/x with numpy's sinc(x/pi).
    chord = speed * time * np.sinc(turned / 2 / np.pi)
    moved = chord * np.array([np.cos(turned / 2), np.sin(turned / 2)])
    cos, sin = np.cos(turned), np.sin(turned)
    return (points - moved) @ np.array([[cos, -sin], [sin, cos]])
