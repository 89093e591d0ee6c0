"""The Hokuyo URG-04LX-UG01: a small laser that sweeps a level plane."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from contextlib import contextmanager

import mujoco
import numpy as np
from numpy.typing import NDArray

from sim.laser_scan import HokuyoParameters, LaserScan
from sim.render.visibility import cast_at_shown, showing, visible_geoms

# Makers' numbers: SCIP 2.0 manual of the URG-04LX, pages 5, 12, 21.
STEPS_PER_TURN = 1024
FIRST_STEP, FRONT_STEP, LAST_STEP = 44, 384, 725
RESOLUTION = 0.001
"""Ranges come in whole millimetres [m]."""
_TOUCH = 1e-3
"""A bounding box so near to the beams' plane counts as cut [m]: far more than rounding."""


class Hokuyo:
    """A URG-04LX-UG01 in one world."""

    angles = np.arange(FIRST_STEP - FRONT_STEP, LAST_STEP - FRONT_STEP + 1, dtype=np.float64) * (
        2 * np.pi / STEPS_PER_TURN
    )
    """(682,) direction of each beam [rad]: 240 deg, symmetric to within a step."""

    def __init__(
        self,
        model: mujoco.MjModel,
        hidden_bodies: Collection[int] = (),
        parameters: HokuyoParameters | None = None,
    ) -> None:
        """Take a laser into use.

        Args:
            model: the world.
            hidden_bodies: ids of bodies that the laser does not see: the robot that carries it.
            parameters: how to measure.
        """
        self.parameters = parameters or HokuyoParameters()
        self._model = model
        self._visible = visible_geoms(model, hidden_bodies)
        self._loose = _loose_bodies(model, self._visible)
        self._middles, self._halves = model.geom_aabb[:, :3].copy(), model.geom_aabb[:, 3:].copy()
        self._beams = np.column_stack([np.cos(self.angles), np.sin(self.angles), np.zeros(len(self.angles))])

    def measure(
        self,
        data: mujoco.MjData,
        world_from_base: NDArray[np.float64],
        base_from_laser: NDArray[np.float64],
        *,
        rng: np.random.Generator,
        time: int,
    ) -> LaserScan:
        """Sweep once; glass is let through.

        Args:
            data: state of the world, after `mj_kinematics` or more.
            world_from_base: (4, 4) pose of the robot.
            base_from_laser: (4, 4) where the laser sits on it.
            rng: source of the noise.
            time: mission time [ns].
        """
        ranges = self._cast(data, world_from_base @ base_from_laser)
        if self.parameters.noise:
            sigma = np.maximum(self.parameters.noise_near, self.parameters.noise_far * ranges)
            ranges = np.rint((ranges + sigma * rng.standard_normal(len(ranges))) / RESOLUTION) * RESOLUTION
        ranges[(ranges < self.parameters.min_range) | (ranges > self.parameters.max_range)] = np.nan
        return LaserScan(base_from_laser, self.angles, ranges.astype(np.float32), time)

    def _cast(self, data: mujoco.MjData, world_from_laser: NDArray[np.float64]) -> NDArray[np.float64]:
        """(682,) exact ranges [m]; NaN where there is nothing."""
        shown = self._visible & self._cut(data, world_from_laser)
        beams = self._beams @ world_from_laser[:3, :3].T
        # the only way to hide several bodies and glass from a ray
        with showing(self._model, shown), _unbounded(self._model, self._loose):
            reach = 2 * self.parameters.max_range
            ranges, met = cast_at_shown(self._model, data, world_from_laser[:3, 3], beams, reach)
        return np.where(met < 0, np.nan, ranges)

    def _cut(self, data: mujoco.MjData, world_from_laser: NDArray[np.float64]) -> NDArray[np.bool_]:
        """(ngeom,) whether the beams' plane cuts a geom's bounding box: the others would cost half the time."""
        origin, up = world_from_laser[:3, 3], world_from_laser[:3, 2]
        up_in_geom = up @ data.geom_xmat.reshape(-1, 3, 3)
        height = (data.geom_xpos - origin) @ up + np.sum(up_in_geom * self._middles, axis=1)
        return abs(height) <= np.sum(abs(up_in_geom) * self._halves, axis=1) + _TOUCH


def _loose_bodies(model: mujoco.MjModel, visible: NDArray[np.bool_]) -> NDArray[np.intp]:
    """Bodies with visible geoms outside their bounding volume, which holds those alone that collide."""
    bounded = np.zeros(model.ngeom, np.bool_)
    for first, count in zip(model.body_bvhadr, model.body_bvhnum, strict=True):
        nodes = model.bvh_nodeid[first : first + count]
        bounded[nodes[nodes >= 0]] = True
    return np.unique(model.geom_bodyid[visible & ~bounded])


@contextmanager
def _unbounded(model: mujoco.MjModel, bodies: NDArray[np.intp]) -> Iterator[None]:
    """Have rays try every geom of these bodies for the length of a `with` block."""
    trees = model.body_bvhadr[bodies]
    model.body_bvhadr[bodies] = -1
    try:
        yield
    finally:
        model.body_bvhadr[bodies] = trees
