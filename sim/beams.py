"""A full turn of beams, cast at once."""

from __future__ import annotations

import math
import os
from collections.abc import Collection
from concurrent.futures import ThreadPoolExecutor

import mujoco
import numpy as np
from numpy.typing import NDArray

from sim.compiled import compiled
from sim.echo import Hits
from sim.facets import panorama
from sim.sight import Seen, Sight
from sim.surfaces import Surfaces

_STRIP = 64
"""Columns drawn at a time, so that they stay in the processor's cache."""


class BeamCaster:
    """Casts panoramas of beams in one world."""

    def __init__(self, model: mujoco.MjModel, hidden_bodies: Collection[int] = ()) -> None:
        """Take a caster into use.

        Args:
            model: the compiled world; shapes and colours are taken as they are now.
            hidden_bodies: ids of bodies that beams pass, such as the robot that carries the scanner.
        """
        self._surfaces = Surfaces(model, hidden_bodies)

    def cast(
        self,
        data: mujoco.MjData,
        world_from_scanner: NDArray[np.float64],
        elevations: NDArray[np.float64],
        azimuths: NDArray[np.float64],
    ) -> Hits:
        """Cast a grid of beams from one point.

        Args:
            data: state of the world, after `mj_kinematics` or more.
            world_from_scanner: (4, 4) pose of the grid.
            elevations: (E,) of the rows, downwards at equal steps, between the poles [rad].
            azimuths: (A,) of the columns, all round at equal steps from 0 [rad].
        """
        shape = len(elevations), len(azimuths)
        hits = Hits(np.empty(shape, np.float32), np.empty(shape, np.float32), np.empty(shape, np.int32))
        sight = Sight(self._surfaces, data, world_from_scanner, panorama(elevations, azimuths))

        def draw(first: int) -> None:
            columns = slice(first, min(first + _STRIP, len(azimuths)))
            _turn_over(sight.seen(columns), first, hits)

        with ThreadPoolExecutor(os.cpu_count()) as pool:
            list(pool.map(draw, range(0, len(azimuths), _STRIP)))
        return hits


@compiled
def _turn_over(seen: Seen, first: int, hits: Hits) -> None:
    """Put what columns of beams meet, one after the other, into rows."""
    columns, rows = seen.geoms.shape
    for row in range(rows):
        for k in range(columns):
            x, y, z = seen.slopes[0, k, row], seen.slopes[1, k, row], seen.slopes[2, k, row]
            inverse_range = seen.inverse_range[k, row]
            hits.inverse_range[row, first + k] = inverse_range
            hits.cosine[row, first + k] = inverse_range / math.sqrt(x * x + y * y + z * z) if inverse_range > 0 else 0
            hits.geoms[row, first + k] = seen.geoms[k, row]


def directions(elevations: NDArray[np.float64], azimuths: NDArray[np.float64]) -> NDArray[np.float64]:
    """(N, 3) unit vectors, x forward and z up, of (N,) elevations and azimuths [rad]."""
    level = np.cos(elevations)
    return np.stack([level * np.cos(azimuths), level * np.sin(azimuths), np.sin(elevations)], axis=-1)
