"""Rays through a scene against everything that is seen or bumped into."""

from __future__ import annotations

import copy
from dataclasses import dataclass

import mujoco
import numpy as np

from sim.render.visibility import VISUAL_GROUPS

_IGNORED_GROUP = 5
_KEPT_GROUPS = np.array([1, 1, 1, 1, 1, 0], np.uint8)


@dataclass(frozen=True)
class Hits:
    """What a fan of rays met."""

    distances: np.ndarray
    """(N,) [m]; infinite where the ray met nothing."""
    geoms: np.ndarray
    """(N,) geom ids, -1 where the ray met nothing."""
    normals: np.ndarray
    """(N, 3) outward normals of the surfaces met, in world."""


class Rays:
    """Casts rays against a scene, past the bodies that are to be ignored.

    Args:
        model: the compiled scene.
        data: its state; positions must be up to date.
        ignored_bodies: bodies that rays pass, such as the robot or a door's leaf.
        only_solid: rays pass what takes no part in collisions, too.
    """

    def __init__(
        self,
        model: mujoco.MjModel,
        data: mujoco.MjData,
        ignored_bodies: frozenset[int] = frozenset(),
        *,
        only_solid: bool = False,
    ):
        self._data = data
        ghosts = (model.geom_contype == 0) & (model.geom_conaffinity == 0)
        if not only_solid:
            ghosts &= model.geom_group >= VISUAL_GROUPS
        ignored = ghosts | np.isin(model.geom_bodyid, sorted(ignored_bodies))
        self._model = copy.copy(model)  # whose groups say what to ignore; the caller's model stays as it is
        self._model.geom_group[:] = np.where(ignored, _IGNORED_GROUP, np.minimum(model.geom_group, _IGNORED_GROUP - 1))
        # a body's bounding volume holds its colliding geoms only; mj_multiRay would miss the others
        self._model.body_bvhadr[:] = -1

    def cast(self, origin: np.ndarray, directions: np.ndarray, cutoff: float = 1e3) -> Hits:
        """Cast rays from one point.

        Args:
            origin: (3,) in world [m].
            directions: (N, 3) unit vectors in world.
            cutoff: surfaces farther than this count as missed [m].
        """
        n = len(directions)
        geoms, distances, normals = np.empty(n, np.int32), np.empty(n), np.zeros(3 * n)
        mujoco.mj_multiRay(
            *(self._model, self._data, np.asarray(origin, float), np.ascontiguousarray(directions, float).ravel()),
            *(_KEPT_GROUPS, True, -1, geoms, distances, normals, n, cutoff),
        )
        missed = geoms < 0
        return Hits(np.where(missed | (distances > cutoff), np.inf, distances), geoms, normals.reshape(n, 3))

    def down(self, x: float, y: float, top: float, bottom: float) -> list[tuple[float, float]]:
        """Heights of all surfaces that face upward under a point and the free height above each [(m, m)]."""
        levels = []
        ceiling, z = np.inf, top
        point, down, geom, normal = np.array([x, y, top]), np.array([0.0, 0, -1]), np.zeros(1, np.int32), np.zeros(3)
        while z > bottom:
            point[2] = z
            distance = mujoco.mj_ray(self._model, self._data, point, down, _KEPT_GROUPS, True, -1, geom, normal)
            if distance < 0:
                break
            height = z - distance
            if normal[2] > 0.9:
                levels.append((height, ceiling - height))
            ceiling, z = height, height - 1e-4
        return levels

    def floor_below(self, point: np.ndarray, reach: float) -> float | None:
        """Height of the surface straight below a point in world, or None if there is none within `reach` [m]."""
        hits = self.cast(point, np.array([[0.0, 0, -1]]), reach)
        return float(point[2] - hits.distances[0]) if np.isfinite(hits.distances[0]) else None

    def name(self, geom: int) -> str:
        """What to call a geom when speaking to the user: its own name, its body's, or its number."""
        return geom_name(self._model, geom)


def horizontal(azimuths: np.ndarray) -> np.ndarray:
    """Unit vectors (N, 3) in the horizontal plane of world at azimuths (N,) [rad]."""
    return np.stack([np.cos(azimuths), np.sin(azimuths), np.zeros_like(azimuths)], axis=-1)


def geom_name(model: mujoco.MjModel, geom: int) -> str:
    """The name of a geom, else that of the nearest named body above it with the geom's number."""
    if name := model.geom(geom).name:
        return str(name)
    body = int(model.geom_bodyid[geom])
    while body and not model.body(body).name:
        body = int(model.body_parentid[body])
    return f"geom {geom} of body {model.body(body).name!r}"
