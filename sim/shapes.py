"""Triangles of geoms, for sensors, for measuring doors and for drawing the robot."""

from __future__ import annotations

from collections.abc import Iterable

import mujoco
import numpy as np

_SIDES = 20


def triangulate(model: mujoco.MjModel, geom: int) -> tuple[np.ndarray, np.ndarray]:
    """Vertices (V, 3) [m] in the geom's frame and triangles (T, 3) of them, anticlockwise seen from outside.

    Planes, height fields and other endless or soft things have none.
    """
    kind, size = mujoco.mjtGeom(int(model.geom_type[geom])), model.geom_size[geom]
    match kind:
        case mujoco.mjtGeom.mjGEOM_BOX:
            return box(size)
        case mujoco.mjtGeom.mjGEOM_SPHERE:
            return _revolve(_arc(0.0) * size[0])
        case mujoco.mjtGeom.mjGEOM_ELLIPSOID:
            vertices, triangles = _revolve(_arc(0.0))
            return vertices * size, triangles
        case mujoco.mjtGeom.mjGEOM_CAPSULE:
            return _revolve(_arc(size[1] / size[0]) * size[0])
        case mujoco.mjtGeom.mjGEOM_CYLINDER:
            return _revolve(np.array([[0, -size[1]], [size[0], -size[1]], [size[0], size[1]], [0, size[1]]]))
        case mujoco.mjtGeom.mjGEOM_MESH | mujoco.mjtGeom.mjGEOM_SDF if model.geom_dataid[geom] >= 0:
            mesh = model.mesh(int(model.geom_dataid[geom]))
            first, count = int(mesh.vertadr[0]), int(mesh.vertnum[0])
            face, faces = int(mesh.faceadr[0]), int(mesh.facenum[0])
            return model.mesh_vert[first : first + count].astype(float), model.mesh_face[face : face + faces].copy()
    return np.zeros((0, 3)), np.zeros((0, 3), int)


def triangles_in_world(model: mujoco.MjModel, data: mujoco.MjData, geoms: Iterable[int]) -> list[np.ndarray]:
    """Corners (T, 3, 3) in world [m] of the triangles of each geom."""
    corners = []
    for geom in geoms:
        vertices, triangles = triangulate(model, geom)
        in_world = vertices @ data.geom_xmat[geom].reshape(3, 3).T + data.geom_xpos[geom]
        corners.append(in_world[triangles])
    return corners


def box(half: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Vertices (8, 3) and triangles (12, 3) of a box about the origin, from half the lengths (3,) of its sides [m]."""
    signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return signs * half, np.array([[a, b, c] for a, b, c, d in quads] + [[a, c, d] for a, b, c, d in quads])


def _arc(stretch: float) -> np.ndarray:
    """Profile (P, 2) of radius and height, from the lowest to the highest point of a unit capsule."""
    angles = np.linspace(-np.pi / 2, np.pi / 2, 12)
    return np.stack([np.cos(angles), np.sin(angles) + np.sign(angles) * stretch], axis=-1)


def _revolve(profile: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The surface that a profile (P, 2) of radius and height sweeps about z."""
    around = np.linspace(0, 2 * np.pi, _SIDES, endpoint=False)
    vertices = np.array([[r * np.cos(a), r * np.sin(a), z] for r, z in profile for a in around])
    triangles = []
    for ring in range(len(profile) - 1):
        for side in range(_SIDES):
            a, b = ring * _SIDES + side, ring * _SIDES + (side + 1) % _SIDES
            triangles += [[a, b, b + _SIDES], [a, b + _SIDES, a + _SIDES]]
    return vertices, np.array(triangles)
