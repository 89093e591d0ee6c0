"""Things that get into the robot's way during a mission: boxes that are put down at a given time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np

from sim.errors import SimError
from sim.rays import Rays, horizontal

SIZE = (0.4, 0.4, 0.8)
"""Of an obstacle, like a chair: its sides, and its height, which the Hokuyos' planes at 0.47 and 0.49 m cut [m]."""

_NAME = "put_down/obstacle"
_PARKED = 50.0
"""So far below the floor it waits [m]: nothing looks there."""
_FLOOR_REACH = 0.3
_CLEAR = 0.05


@dataclass(frozen=True)
class Obstacle:
    """A box that stands upright along the axes of the world from some time on."""

    x: float
    """Of its middle, in world [m]."""
    y: float
    time: float | None = None
    """When it is put down [s of the robot's time]; None for when the robot first sets off."""


def add_obstacles(spec: mujoco.MjSpec, obstacles: Sequence[Obstacle]) -> None:
    """Add the bodies of obstacles, which nothing moves, and park them out of sight."""
    for number, obstacle in enumerate(obstacles, start=1):
        body = spec.worldbody.add_body(name=f"{_NAME}_{number}", mocap=True, pos=[obstacle.x, obstacle.y, -_PARKED])
        body.add_geom(
            name=f"{_NAME}_{number}",
            type=mujoco.mjtGeom.mjGEOM_BOX,
            size=[side / 2 for side in SIZE],
            rgba=[0.75, 0.35, 0.2, 1.0],
        )


def obstacle_bodies(model: mujoco.MjModel, obstacles: Sequence[Obstacle]) -> list[int]:
    """Ids of the bodies that `add_obstacles` added, in their order."""
    return [model.body(f"{_NAME}_{number}").id for number in range(1, len(obstacles) + 1)]


class Obstacles:
    """The obstacles of a scene, most of which are still to come."""

    def __init__(
        self, model: mujoco.MjModel, data: mujoco.MjData, obstacles: Sequence[Obstacle], *, floor_height: float
    ) -> None:
        """Find where the obstacles will stand.

        Args:
            model: Compiled with `add_obstacles`.
            data: Its state at the start.
            obstacles: As they were added.
            floor_height: Of the floor that the robot starts on: theirs is looked for round it [m].

        Raises:
            SimError: There is no floor, or something stands where one is to stand, the robot included.
        """
        self._model, self._data = model, data
        self._waiting: list[tuple[Obstacle, int, np.ndarray]] = []
        bodies = obstacle_bodies(model, obstacles)
        rays = Rays(model, data, frozenset(bodies))
        for obstacle, body in zip(obstacles, bodies, strict=True):
            self._waiting.append((obstacle, int(model.body_mocapid[body]), _place(rays, obstacle, floor_height)))

    def put_down(
        self, time: float, world_from_base: np.ndarray, *, footprint: tuple[float, float], driving: bool
    ) -> tuple[str, ...]:
        """Put down what is due; what the robot stands in the way of comes when it has left.

        Args:
            time: Of the robot [s].
            world_from_base: (4, 4) of the robot now.
            footprint: Its length and width [m].
            driving: Whether it sets off or drives: obstacles without a time of their own are due.

        Returns:
            What was put down, in words.
        """
        put = []
        for entry in list(self._waiting):
            obstacle, mocap, place = entry
            away = np.hypot(*(place[:2] - world_from_base[:2, 3]))
            due = driving if obstacle.time is None else time >= obstacle.time
            if due and away > (np.hypot(*footprint) + np.hypot(*SIZE[:2])) / 2 + _CLEAR:
                self._data.mocap_pos[mocap] = place
                self._waiting.remove(entry)
                put.append(f"an obstacle stands at ({obstacle.x:.2f}, {obstacle.y:.2f})")
        if put:
            mujoco.mj_forward(self._model, self._data)
        return tuple(put)


def _place(rays: Rays, obstacle: Obstacle, floor_height: float) -> np.ndarray:
    """(3,) where the middle of an obstacle comes to be [m]."""
    at = f"the obstacle at ({obstacle.x:.2f}, {obstacle.y:.2f})"
    above = np.array([obstacle.x, obstacle.y, floor_height + _FLOOR_REACH])
    azimuths = np.radians(np.arange(0, 360, 2.5))
    border = SIZE[0] / 2 / np.maximum(abs(np.cos(azimuths)), abs(np.sin(azimuths)))
    for z in np.linspace(0.05, SIZE[2], 8):
        hits = rays.cast(np.array([obstacle.x, obstacle.y, floor_height + z]), horizontal(azimuths), 1.0)
        inside = hits.distances < border
        if inside.any():
            raise SimError(f"{at} would stand in {rays.name(int(hits.geoms[inside][0]))}")
    floor = rays.floor_below(above, 2 * _FLOOR_REACH)
    if floor is None:
        raise SimError(f"there is no floor under {at}")
    return np.array([obstacle.x, obstacle.y, floor + SIZE[2] / 2])
