"""What else casts beams: MuJoCo's own rays, Open3D's RaycastingScene, mujoco-lidar."""

from __future__ import annotations

import copy
from collections.abc import Callable
from importlib.util import find_spec

import mujoco
import numpy as np
from numpy.typing import NDArray

from mission.bench.speed.worlds import World
from sim.render.visibility import visible_geoms
from sim.shapes import triangulate

Caster = Callable[[], tuple[NDArray[np.floating], NDArray[np.integer]]]
"""Casts all its beams; (N,) ranges [m], infinite where there is nothing, and (N,) geom ids."""

HIDDEN_GROUP = 5
GROUPS = np.array([1, 1, 1, 1, 1, 0], np.uint8)
CHUNKS = (2**17, 2**20, 2**24)
"""Rays at a time that are tried."""
HALF_PLANE = 100.0
"""An endless plane ends here [m]."""


def rays_model(world: World) -> mujoco.MjModel:
    """The model as rays see it: what the sensors do not see is in a group of its own."""
    model = copy.copy(world.model)
    model.geom_group[:] = np.where(visible_geoms(model, world.hidden_bodies), 0, HIDDEN_GROUP)
    model.body_bvhadr[:] = -1  # bounding volumes hold colliding geoms only; others would be missed
    return model


def multi_ray(world: World, directions: NDArray[np.float64]) -> Caster:
    """`mj_multiRay` along directions (N, 3) in the world."""
    model, beams = rays_model(world), np.ascontiguousarray(directions).ravel()
    origin, count = world.world_from_scanner[:3, 3].copy(), len(directions)
    geoms, ranges = np.empty(count, np.int32), np.empty(count)

    def cast() -> tuple[NDArray, NDArray]:
        mujoco.mj_multiRay(model, world.data, origin, beams, GROUPS, True, -1, geoms, ranges, None, count, 1e4)
        return np.where(geoms < 0, np.inf, ranges), geoms

    return cast


def has_open3d() -> bool:
    """Whether Open3D is installed."""
    return find_spec("open3d") is not None


def embree(world: World, directions: NDArray[np.floating], chunk: int) -> Caster:
    """Open3D's RaycastingScene on all threads, `chunk` rays at a time, prepared beforehand."""
    import open3d as o3d

    tensor = o3d.core.Tensor.from_numpy
    scene = o3d.t.geometry.RaycastingScene()
    geom_of: list[int] = []
    for geom in np.flatnonzero(visible_geoms(world.model, world.hidden_bodies)):
        vertices, triangles = _triangles(world.model, int(geom))
        if len(triangles):
            turn, place = world.data.geom_xmat[geom].reshape(3, 3), world.data.geom_xpos[geom]
            in_world = (vertices @ turn.T + place).astype(np.float32)
            scene.add_triangles(tensor(in_world), tensor(triangles.astype(np.uint32)))
            geom_of.append(int(geom))
    geom_ids = np.array(geom_of)
    origin = np.broadcast_to(world.world_from_scanner[:3, 3], directions.shape)
    rays = np.concatenate([origin, directions], axis=1).astype(np.float32)
    chunks = [tensor(rays[start : start + chunk]) for start in range(0, len(rays), chunk)]

    def cast() -> tuple[NDArray, NDArray]:
        answers = [scene.cast_rays(part) for part in chunks]
        ranges = np.concatenate([answer["t_hit"].numpy() for answer in answers])
        hit = np.concatenate([answer["geometry_ids"].numpy() for answer in answers])
        return ranges, np.where(np.isfinite(ranges), geom_ids[np.minimum(hit, len(geom_ids) - 1)], -1)

    return cast


def has_mujoco_lidar() -> bool:
    """Whether mujoco-lidar is installed."""
    return find_spec("mujoco_lidar") is not None


def mujoco_lidar(world: World, elevations: NDArray[np.float64], azimuths: NDArray[np.float64]) -> Caster:
    """The CPU backend of mujoco-lidar along (N,) elevations and azimuths [rad] in the scanner's frame."""
    from mujoco_lidar.core_cpu.mjlidar_cpu import MjLidarCPU

    lidar = MjLidarCPU(rays_model(world), cutoff_dist=1e4, geomgroup=GROUPS)

    def cast() -> tuple[NDArray, NDArray]:
        lidar.update(world.data)
        lidar.trace_rays(world.world_from_scanner, azimuths, elevations)
        ranges = lidar.get_distances()
        return np.where(ranges < 0, np.inf, ranges), np.full(len(ranges), -1)  # it does not tell the geoms

    return cast


def _triangles(model: mujoco.MjModel, geom: int) -> tuple[NDArray, NDArray]:
    if model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_PLANE:
        half = np.where(model.geom_size[geom][:2] > 0, model.geom_size[geom][:2], HALF_PLANE)
        corners = np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)]) * [*half, 0]
        return corners, np.array([(0, 1, 2), (0, 2, 3)])
    return triangulate(model, geom)
