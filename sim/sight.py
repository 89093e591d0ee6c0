"""What is seen from one place along a grid of beams."""

from __future__ import annotations

from typing import NamedTuple

import mujoco
import numpy as np
from numpy.typing import NDArray

from sim.facets import Grid, Strip, draw_facets, outlined, slopes_of_facets, spans
from sim.round_bodies import draw_round_bodies, slopes_of_round_bodies
from sim.surfaces import Surfaces


class Seen(NamedTuple):
    """What the beams of some columns of a grid meet."""

    inverse_range: NDArray[np.float32]
    """(columns, R) in beams' lengths [1/m]; 0 where there is nothing."""
    slopes: NDArray[np.float32]
    """(3, columns, R) normals, of a length that makes the product with the beam its inverse range [1/m]."""
    geoms: NDArray[np.int32]
    """(columns, R) geom ids; -1 for nothing, and for a flex or skin."""


class Sight:
    """A world as it is now, seen from one place. For any number of threads."""

    def __init__(
        self, surfaces: Surfaces, data: mujoco.MjData, world_from_view: NDArray[np.float64], grid: Grid
    ) -> None:
        """Take a look.

        Args:
            surfaces: of the world.
            data: its state, after `mj_kinematics` or more.
            world_from_view: (4, 4) frame of the beams.
            grid: the beams.
        """
        flat, boxes, self._bodies = surfaces.around(data, world_from_view)
        self._facets, self._boxes = outlined(flat, grid), outlined(boxes, grid)
        self._grid = grid

    def inverse_ranges(self, columns: slice) -> NDArray[np.float32]:
        """(columns, R) `Seen.inverse_range` of some columns."""
        return self._drawn(columns).inverse_range

    def seen(self, columns: slice) -> Seen:
        """What the beams of some columns meet."""
        strip = self._drawn(columns)
        slopes, geoms = np.empty((3, *strip.surfaces.shape), np.float32), np.empty_like(strip.surfaces)
        slopes_of_facets(strip, self._facets, slopes, geoms)
        if len(self._bodies.kinds):
            slopes_of_round_bodies(strip, self._bodies, len(self._facets.owners), self._grid, slopes, geoms)
        return Seen(strip.inverse_range, slopes, geoms)

    def _drawn(self, columns: slice) -> Strip:
        shape = columns.stop - columns.start, len(self._grid.level)
        strip = Strip(columns.start, np.zeros(shape, np.float32), np.full(shape, -1, np.int32))
        draw_facets(self._facets, self._grid, strip)
        around = spans(self._boxes, self._grid, columns.start, columns.stop)
        draw_round_bodies(around, self._bodies, len(self._facets.owners), self._grid, strip)
        return strip
