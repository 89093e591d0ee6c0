"""A full turn of beams, cast at once."""

from __future__ import annotations

import os
from collections.abc import Collection
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from sim.facets import Grid, Strip, draw_facets, outlined, spans
from sim.round_bodies import draw_round_bodies
from sim.surfaces import Surfaces

_STRIP = 128
"""Columns drawn at a time, so that they stay in the processor's cache."""


@dataclass(frozen=True, eq=False)
class Hits:
    """What the beams of a panorama meet."""

    inverse_range: NDArray[np.float32]
    """(E, A) [1/m], 0 where there is nothing."""
    cosine: NDArray[np.float32]
    """(E, A) of the angle of incidence."""
    geoms: NDArray[np.int32]
    """(E, A) geom ids; -1 for nothing, and for a flex or skin."""


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
        flat, round_boxes, round_bodies = self._surfaces.around(data, world_from_scanner)
        facets, boxes = outlined(flat, len(azimuths)), outlined(round_boxes, len(azimuths))
        grid = Grid(
            *(np.cos(azimuths), np.sin(azimuths), np.cos(elevations), np.sin(elevations)),
            top=float(elevations[0]),
            step=float(elevations[0] - elevations[-1]) / (len(elevations) - 1),
        )
        shape = len(elevations), len(azimuths)
        hits = Hits(np.empty(shape, np.float32), np.empty(shape, np.float32), np.empty(shape, np.int32))

        def draw(first: int) -> None:
            columns = slice(first, min(first + _STRIP, len(azimuths)))
            size = columns.stop - first, len(elevations)
            strip = Strip(first, np.zeros(size, np.float32), np.zeros(size, np.float32), np.full(size, -1, np.int32))
            draw_facets(facets, grid, strip)
            draw_round_bodies(spans(boxes, grid, first, columns.stop), round_bodies, grid, strip)
            hits.inverse_range[:, columns] = strip.inverse_range.T
            hits.cosine[:, columns] = strip.cosine.T
            hits.geoms[:, columns] = strip.geoms.T

        with ThreadPoolExecutor(os.cpu_count()) as pool:
            list(pool.map(draw, range(0, len(azimuths), _STRIP)))
        return hits


def directions(elevations: NDArray[np.float64], azimuths: NDArray[np.float64]) -> NDArray[np.float64]:
    """(N, 3) unit vectors, x forward and z up, of (N,) elevations and azimuths [rad]."""
    level = np.cos(elevations)
    return np.stack([level * np.cos(azimuths), level * np.sin(azimuths), np.sin(elevations)], axis=-1)
