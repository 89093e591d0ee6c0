"""Which geoms light and laser meet: the same answer for rendering, for beams and for rays."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from contextlib import contextmanager

import mujoco
import numpy as np
from numpy.typing import NDArray

VISUAL_GROUPS = 3
"""Groups 0 to 2 are drawn by MuJoCo's convention; 3 to 5 hold collision shapes."""
GLASS_ALPHA = 0.5
"""A geom less opaque than this is glass, and lets light through."""

SHOWN, HIDDEN = 0, mujoco.mjNGROUP - 1
"""The two groups that `showing` sorts the geoms into."""
_SHOWN_ONLY = (np.arange(mujoco.mjNGROUP) == SHOWN).astype(np.uint8)


def effective_rgba(model: mujoco.MjModel) -> NDArray[np.float32]:
    """(ngeom, 4) colour that each geom is drawn in: its material's, unless its own differs from MuJoCo's default."""
    rgba = model.geom_rgba.copy()
    from_material = (model.geom_matid >= 0) & (rgba == np.array([0.5, 0.5, 0.5, 1], np.float32)).all(axis=1)
    rgba[from_material] = model.mat_rgba[model.geom_matid[from_material]]
    return rgba


def visible_geoms(model: mujoco.MjModel, hidden_bodies: Collection[int] = ()) -> NDArray[np.bool_]:
    """Mark the geoms that a sensor can see.

    Args:
        model: the world.
        hidden_bodies: ids of bodies whose geoms the sensor does not see: the robot that carries it.

    Returns:
        (ngeom,) True for geoms of a visual group, of at least half opacity, and not on a hidden body.
    """
    group = np.clip(model.geom_group, 0, mujoco.mjNGROUP - 1)
    own = np.isin(model.geom_bodyid, list(hidden_bodies))
    return (group < VISUAL_GROUPS) & (effective_rgba(model)[:, 3] >= GLASS_ALPHA) & ~own


@contextmanager
def showing(model: mujoco.MjModel, visible: NDArray[np.bool_]) -> Iterator[None]:
    """Sort the geoms into the groups `SHOWN` and `HIDDEN` for the length of a `with` block."""
    groups = model.geom_group.copy()
    model.geom_group[:] = np.where(visible, SHOWN, HIDDEN)
    try:
        yield
    finally:
        model.geom_group[:] = groups


def cast_at_shown(
    model: mujoco.MjModel, data: mujoco.MjData, eye: NDArray[np.float64], beams: NDArray[np.float64], reach: float
) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """Cast beams from one point against the geoms in the group `SHOWN`.

    Args:
        model: the world, its geoms sorted into groups.
        data: its state.
        eye: (3,) where the beams start, in the world frame.
        beams: (N, 3) unit vectors in the world frame.
        reach: beams meet nothing farther away [m].

    Returns:
        (N,) range [m], infinite where a beam meets nothing; (N,) geom id, then -1.
    """
    ranges, met = np.empty(len(beams)), np.empty(len(beams), np.int32)
    mujoco.mj_multiRay(
        *(model, data, np.ascontiguousarray(eye), np.ascontiguousarray(beams).ravel(), _SHOWN_ONLY),
        *(True, -1, met, ranges, None, len(beams), reach),
    )
    return np.where(met < 0, np.inf, ranges), met
