"""Rooms of a scene, from its truth: where MoPAD can stand in them, and where it starts."""

from __future__ import annotations

import copy
from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from mission.rigid import Pose
from sim.rays import Rays, horizontal
from sim.scene import FOOTPRINT, Scene
from sim.start import upright_pose

RASTER = 0.25
"""Places are this far apart [m]."""
MARGIN = 0.05
"""Kept clear around the body [m]."""

_TURNING = float(np.hypot(*FOOTPRINT)) / 2 + MARGIN
_HEIGHTS = (0.06, 0.15, 0.3, 0.45, 0.65, 0.9, 1.15, 1.4)
_HEADROOM = 1.5
_FAN = horizontal(np.radians(np.arange(0, 360, 5)))
_SLOPES = np.radians(np.arange(10, 90, 10))
_RISING = (
    np.cos(_SLOPES)[:, None, None] * _FAN[::3] + np.sin(_SLOPES)[:, None, None] * np.array([0.0, 0.0, 1.0])
).reshape(-1, 3)
_FARTHEST_ENTRY = 2.5
"""From a door to the place beyond it, at most [m]."""
_MOST_PLACES = 20_000


@dataclass(frozen=True, eq=False)
class TrueRoom:
    """A room as the scene has it."""

    number: int
    world_from_base: Pose
    """Where the robot starts: the scene's start, a site at which it is set down, or the far side of a door."""
    places_in_world: NDArray[np.float64]
    """(P, 3) where the robot can stand and turn without passing a closed door [m]."""


def closed(scene: Scene) -> tuple[mujoco.MjModel, mujoco.MjData]:
    """The scene with all its doors closed and its glass opaque: nothing looks out of a room."""
    model = copy.copy(scene.model)
    model.geom_rgba[:, 3] = model.mat_rgba[:, 3] = 1.0
    data = mujoco.MjData(model)
    data.qpos[:] = scene.data.qpos
    for leaf in (leaf for door in scene.doors for leaf in door.leaves):
        data.qpos[model.jnt_qposadr[leaf.leaf.joint]] = leaf.closed
    mujoco.mj_forward(model, data)
    return model, data


def rooms_of(scene: Scene) -> list[TrueRoom]:
    """The rooms that the robot can get into: at the start, by sites `start_2`, `start_3`... and through open doors."""
    rays = Rays(*closed(scene), scene.robot_bodies)
    rooms: list[TrueRoom] = []
    for pose in [scene.world_from_base, *scene.set_downs.values(), *_entries(scene, rays)]:
        known = [room.places_in_world for room in rooms]
        if any(np.hypot(*(places[:, :2] - pose[:2, 3]).T).min() < RASTER for places in known):
            continue
        places = _standing(rays, pose[:3, 3])
        rooms.append(TrueRoom(len(rooms) + 1, pose, places))
    return rooms


def _entries(scene: Scene, rays: Rays) -> list[Pose]:
    """Poses (4, 4) on both sides of each door that the robot can drive through: the first spot where it can turn."""
    as_they_stand = Rays(scene.model, scene.data, scene.robot_bodies)
    poses = []
    for door in scene.true_doors():
        foot = door.corners_in_world[:2].mean(axis=0)
        foot[2] = scene.world_from_base[2, 3]
        for normal in (door.normal, -door.normal):
            if not _passable(as_they_stand, foot, normal):
                continue
            ways = np.arange(_TURNING, _FARTHEST_ENTRY, 0.05)
            spot = next((foot + way * normal for way in ways if _can_stand(rays, foot + way * normal)), None)
            if spot is not None:
                poses.append(upright_pose(spot, float(np.arctan2(normal[1], normal[0]))))
    return poses


def _passable(rays: Rays, foot: NDArray[np.float64], normal: NDArray[np.float64]) -> bool:
    """Whether a band as wide as the body and its margins leads straight through a door, towards a (3,) normal."""
    half = FOOTPRINT[1] / 2 + MARGIN
    across = np.array([-normal[1], normal[0], 0.0])
    begin = foot - _TURNING * normal
    starts = [begin + side * across + [0, 0, z] for side in np.linspace(-half, half, 7) for z in _HEIGHTS]
    return all(np.isinf(rays.cast(start, normal[None], 2 * _TURNING).distances[0]) for start in starts)


def _standing(rays: Rays, start: NDArray[np.float64]) -> NDArray[np.float64]:
    """(P, 3) the places of a raster that the robot gets to from a start (3,) and where it can turn."""
    found = {(0, 0): start}
    tried, waiting = {(0, 0)}, [(0, 0)]
    while waiting and len(found) < _MOST_PLACES:
        row, column = waiting.pop()
        for step in ((row + 1, column), (row - 1, column), (row, column + 1), (row, column - 1)):
            if step in tried:
                continue
            tried.add(step)
            place = start + RASTER * np.array([*step, 0.0])
            if _can_stand(rays, place):
                found[step] = place
                waiting.append(step)
    return np.array(list(found.values()))


def _can_stand(rays: Rays, place: NDArray[np.float64]) -> bool:
    """Whether there is floor under a place (3,), and nothing in the disc that the robot sweeps when it turns."""
    floor = rays.floor_below(place + [0, 0, 0.3], 0.4)
    if floor is None or abs(floor - place[2]) > 0.05:
        return False
    for z in _HEIGHTS:
        if np.isfinite(rays.cast(place + [0, 0, z], _FAN, _TURNING).distances).any():
            return False
    rising = rays.cast(place + [0, 0, _HEIGHTS[0]], _RISING, 3 * _HEADROOM).distances
    level = rising * np.hypot(_RISING[:, 0], _RISING[:, 1])
    return not ((rising * _RISING[:, 2] < _HEADROOM) & (level < _TURNING)).any()
