"""A flat world of upright boxes, a robot that drives in it, and Hokuyos that measure it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

import sim.scene
from mission.grid import Cell, Footprint, OccupancyGrid
from sim.guardian import RobotParameters
from sim.laser_scan import LaserScan

Rectangle = tuple[float, float, float, float]
"""x from, x to, y from, y to [m]."""
FOOTPRINT = Footprint(*sim.scene.FOOTPRINT)


def pose(x: float, y: float, yaw: float = 0.0) -> NDArray[np.float64]:
    world_from_base = np.eye(4)
    world_from_base[:2, :2] = [[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]]
    world_from_base[:2, 3] = x, y
    return world_from_base


def free_room(
    width: float, depth: float, *obstacles: Rectangle, yaw: float = 0.0, resolution: float = 0.05
) -> OccupancyGrid:
    """A room of free cells from (0, 0) to (width, depth), turned about the origin; walls and obstacles are occupied."""
    reach = float(np.hypot(width, depth)) + 0.5
    size = int(2 * reach / resolution)
    empty = OccupancyGrid(np.array([-reach, -reach]), resolution, np.full((size, size), Cell.OCCUPIED, np.uint8))
    x, y = np.moveaxis(empty.centres() @ pose(0, 0, yaw)[:2, :2], -1, 0)
    free = (x > 0) & (x < width) & (y > 0) & (y < depth)
    for x0, x1, y0, y1 in obstacles:
        free &= ~((x > x0) & (x < x1) & (y > y0) & (y < y1))
    return OccupancyGrid(empty.origin, resolution, np.where(free, Cell.FREE, Cell.OCCUPIED).astype(np.uint8))


def laser_scan(
    world_from_base: NDArray[np.float64], obstacles: list[Rectangle], *, rear: bool = False, time: int = 0
) -> LaserScan:
    """What a Hokuyo at the robot's front or rear measures of upright boxes, 240 deg, up to 5.6 m."""
    base_from_laser = pose(-0.45, 0, np.pi) if rear else pose(0.45, 0)
    base_from_laser[2, 3] = 0.4
    angles = np.radians(np.linspace(-120, 120, 682))
    world_from_laser = world_from_base @ base_from_laser
    beams = np.stack([np.cos(angles), np.sin(angles)], axis=1) @ world_from_laser[:2, :2].T
    ranges = np.full(len(angles), np.inf)
    for x0, x1, y0, y1 in obstacles:
        with np.errstate(divide="ignore"):
            near = (np.array([x0, y0]) - world_from_laser[:2, 3]) / beams
            far = (np.array([x1, y1]) - world_from_laser[:2, 3]) / beams
        enter, leave = np.minimum(near, far).max(axis=1), np.maximum(near, far).min(axis=1)
        ranges = np.where((enter <= leave) & (enter > 0), np.minimum(ranges, enter), ranges)
    ranges[ranges > 5.6] = np.nan
    return LaserScan(base_from_laser, angles, ranges.astype(np.float32), time)


class Unicycle:
    """A robot that does what it is told, while its odometry counts a little differently."""

    def __init__(
        self,
        start: NDArray[np.float64],
        *,
        drift: float = 0.0,
        bias: float = 0.0,
        grip: float = 1.0,
        parameters: RobotParameters | None = None,
    ) -> None:
        self.parameters = parameters or RobotParameters()
        self.true, self.odometry, self.time = start, start, 0.0
        self._drift, self._bias, self._grip, self._rng = drift, bias, grip, np.random.default_rng(0)
        self.commands: list[tuple[float, float]] = []
        self.touching: list[str] = []

    def step(self, v: float, w: float, duration: float) -> None:
        self.commands.append((v, w))
        self.true = self.true @ pose(self._grip * v * duration, 0, self._grip * w * duration)
        error = 1 + self._bias + self._drift * self._rng.standard_normal(2)
        self.odometry = self.odometry @ pose(
            self._grip * v * duration * error[0], 0, self._grip * w * duration * error[1]
        )
        self.time += duration

    def contacts(self) -> list[str]:
        return self.touching


def hokuyos(robot: Unicycle, obstacles: list[Rectangle]) -> Callable[[], list[LaserScan]]:
    return lambda: [laser_scan(robot.true, obstacles, rear=rear) for rear in (False, True)]


def body_gap(world_from_base: NDArray[np.float64], obstacles: list[Rectangle]) -> float:
    """Least distance between the robot's outline and boxes [m], from points all along the outline."""
    s = np.linspace(-1, 1, 41)
    half = np.array([FOOTPRINT.length, FOOTPRINT.width]) / 2
    outline = np.concatenate([np.column_stack([s, k + 0 * s]) for k in (-1, 1)])
    outline = np.concatenate([outline, outline[:, ::-1]]) * half
    x, y = (outline @ world_from_base[:2, :2].T + world_from_base[:2, 3]).T
    gaps = [
        np.hypot(np.maximum(np.maximum(x0 - x, x - x1), 0), np.maximum(np.maximum(y0 - y, y - y1), 0))
        for x0, x1, y0, y1 in obstacles
    ]
    return float(np.min(gaps))
