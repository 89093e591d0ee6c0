"""Exact ranges to spheres, ellipsoids, cylinders and capsules, which are drawn as polyhedra."""

from __future__ import annotations

import mujoco
import numpy as np
from numpy.typing import NDArray

_SPHERE, _CAPSULE, _ELLIPSOID, _CYLINDER = (
    kind.value
    for kind in (
        mujoco.mjtGeom.mjGEOM_SPHERE,
        mujoco.mjtGeom.mjGEOM_CAPSULE,
        mujoco.mjtGeom.mjGEOM_ELLIPSOID,
        mujoco.mjtGeom.mjGEOM_CYLINDER,
    )
)
_CHUNK = 2**16

Vectors = NDArray[np.float64]


def is_curved(model: mujoco.MjModel) -> NDArray[np.bool_]:
    """(ngeom + 1,) True for geoms that are drawn as polyhedra but are none; the last one stands for no geom."""
    return np.append(np.isin(model.geom_type, (_SPHERE, _CAPSULE, _ELLIPSOID, _CYLINDER)), False)


def curved_ranges(
    drawn: Vectors,
    model: mujoco.MjModel,
    data: mujoco.MjData,
    geoms: NDArray[np.int32],
    eye: Vectors,
    beams: Vectors,
) -> Vectors:
    """(N,) ranges of beams to the curved geoms that they are known to meet [m].

    Args:
        drawn: (N,) ranges to the drawn surface [m]; kept where a beam passes the true one, and on ends of cylinders.
        model: the world.
        data: its state.
        geoms: (N,) curved geom that each beam meets.
        eye: (3,) where the beams start, in the world frame.
        beams: (N, 3) unit vectors in the world frame.
    """
    exact = drawn.copy()
    for start in range(0, len(drawn), _CHUNK):
        part = slice(start, start + _CHUNK)
        kind, size = model.geom_type[geoms[part]], model.geom_size[geoms[part]]
        geom_from_world = data.geom_xmat[geoms[part]].reshape(-1, 3, 3).transpose(0, 2, 1)
        origin = np.einsum("nij,nj->ni", geom_from_world, eye - data.geom_xpos[geoms[part]])
        direction = np.einsum("nij,nj->ni", geom_from_world, beams[part])
        radii = np.where((kind == _ELLIPSOID)[:, None], size, size[:, :1])
        met = np.where(
            (kind == _SPHERE) | (kind == _ELLIPSOID),
            _first_root(origin / radii, direction / radii),
            _tube(origin, direction, size, rounded=kind == _CAPSULE),
        )
        exact[part] = np.where(np.isnan(met), drawn[part], met)
    return exact


def _tube(origin: Vectors, direction: Vectors, size: Vectors, rounded: NDArray[np.bool_]) -> Vectors:
    """(N,) distance to the side of a cylinder about z or the round end of a capsule; NaN where a ray meets neither."""
    radius, half = size[:, :1], size[:, 1]
    distance = _first_root(origin[:, :2] / radius, direction[:, :2] / radius)
    height = origin[:, 2] + distance * direction[:, 2]
    # A ray that leaves the tube through its end, or passes it, may still meet the ball on the end that it comes by.
    upper = np.where(np.isnan(height), origin[:, 2], height) > 0
    centre = np.zeros_like(origin)
    centre[:, 2] = np.where(upper, half, -half)
    ball = np.where(rounded, _first_root((origin - centre) / radius, direction / radius), np.nan)
    return np.where(np.abs(height) <= half, distance, ball)


def _first_root(origin: Vectors, direction: Vectors) -> Vectors:
    """(N,) smallest t >= 0 with |origin + t direction| = 1; NaN if there is none."""
    a = np.einsum("nk,nk->n", direction, direction)
    b = np.einsum("nk,nk->n", origin, direction)
    c = np.einsum("nk,nk->n", origin, origin) - 1
    discriminant = b * b - a * c
    valid = (discriminant >= 0) & (a > 0)
    root = np.sqrt(np.where(valid, discriminant, np.nan))
    a = np.where(valid, a, np.nan)
    near, far = (-b - root) / a, (-b + root) / a
    return np.where(near >= 0, near, np.where(far >= 0, far, np.nan))
