"""Exact rays for the beams that no pixel answers for: at the edges of things, and on round ones."""

from __future__ import annotations

import copy

import mujoco
import numpy as np
from numpy.typing import NDArray

from sim.render.visibility import HIDDEN, SHOWN, cast_at_shown

_FARTHEST = 1e10


class EdgeRays:
    """MuJoCo's rays against a few geoms at a time. Not for several threads at once."""

    def __init__(self, model: mujoco.MjModel) -> None:
        """Make room for the rays of a world.

        Args:
            model: the world; it is copied.
        """
        self._model = copy.copy(model)  # whose groups say what rays meet
        self._model.geom_type[model.geom_type == mujoco.mjtGeom.mjGEOM_SDF] = mujoco.mjtGeom.mjGEOM_MESH  # as drawn
        self._model.body_bvhadr[:] = -1  # bounding volumes hold colliding geoms only; others would be missed
        self._data = mujoco.MjData(self._model)
        self._eye = np.zeros(3)

    def place(self, data: mujoco.MjData, eye: NDArray[np.float64]) -> None:
        """Take over where the geoms are in `data`, and start all beams at `eye` (3,) in the world frame."""
        self._data.geom_xpos[:] = data.geom_xpos
        self._data.geom_xmat[:] = data.geom_xmat
        self._eye = eye

    def cast(
        self, beams: NDArray[np.float64], geoms: NDArray[np.int32]
    ) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
        """Cast beams against some geoms.

        Args:
            beams: (N, 3) unit vectors in the world frame.
            geoms: (G,) ids of what beams can meet.

        Returns:
            (N,) range [m], infinite where a beam meets nothing; (N,) geom id, then -1.
        """
        self._model.geom_group[:] = HIDDEN
        self._model.geom_group[geoms] = SHOWN
        return cast_at_shown(self._model, self._data, self._eye, beams, _FARTHEST)
