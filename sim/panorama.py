"""A full turn of beams, cast as six rendered pictures."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import cv2
import mujoco
import numpy as np
from numpy.typing import NDArray

from sim.curved import curved_ranges, is_curved
from sim.render import Renderer, View, looking_along
from sim.render.jumps import blocks_across_jumps

WEDGES = 6
"""Six pictures of 60 deg: pixels of about the same size everywhere, and one table for all six."""

_MARGIN_PX = 3
"""Pixels round a picture that no beam needs, but its neighbours do."""
_STEEPEST = 0.02
"""Largest relative slope a pixel that a surface may have, 87 deg of incidence; beyond that the pixel stands alone."""
_DENSITY = 512, 1024
"""Fewest and most pixels per unit of tangent, which is per radian in the middle of a picture."""


def cast_panorama(
    renderer: Renderer,
    data: mujoco.MjData,
    world_from_scanner: NDArray[np.float64],
    elevations: NDArray[np.float64],
    azimuths: NDArray[np.float64],
    value_of_geom: NDArray[np.float32],
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Cast a grid of beams from one point.

    Inverse depth is linear over a plane, and the raw depth buffer is affine in it. So interpolating the raw buffer
    bilinearly is exact on planes, and it is turned into metres at the beams only.

    Args:
        renderer: of the world.
        data: its state.
        world_from_scanner: (4, 4) pose of the grid.
        elevations: (E,) of the rows, within 70 deg of level [rad].
        azimuths: (A,) of the columns, all round at equal steps, a multiple of six [rad].
        value_of_geom: (ngeom + 1,) something to be looked up for what each beam meets.

    Returns:
        (E, A) inverse range [1/m], next to 0 where there is nothing; (E, A) value of the geom that was met.
    """
    wedge = _wedge(elevations.tobytes(), azimuths.tobytes())
    curved = is_curved(renderer.model)
    inverse_range = np.empty((len(elevations), len(azimuths)), np.float32)
    values = np.empty_like(inverse_range)
    for number in range(WEDGES):
        columns = slice(number * wedge.columns, (number + 1) * wedge.columns)
        depth = renderer.depth(data, wedge.view(world_from_scanner, number))
        raw = wedge.sample(depth.raw)
        raw += np.float32(renderer.inverse_depth_offset / renderer.inverse_depth_scale)
        inverse_range[:, columns] = cv2.multiply(raw, wedge.cosine, scale=renderer.inverse_depth_scale)
        segments = np.asarray(cv2.remap(depth.segments, wedge.map_x, wedge.map_y, cv2.INTER_NEAREST), np.uint16)
        values[:, columns] = value_of_geom[depth.geom_ids].take(segments)

        row, column = np.divmod(np.flatnonzero(curved[depth.geom_ids].take(segments)), wedge.columns)
        geoms = depth.geom_ids[segments[row, column]]
        column += columns.start
        beams = directions(elevations[row], azimuths[column]) @ world_from_scanner[:3, :3].T
        drawn = 1 / inverse_range[row, column].astype(np.float64)
        exact = curved_ranges(drawn, renderer.model, data, geoms, world_from_scanner[:3, 3], beams)
        inverse_range[row, column] = 1 / exact
    return inverse_range, values


def bare_renders(
    renderer: Renderer,
    data: mujoco.MjData,
    world_from_scanner: NDArray[np.float64],
    elevations: NDArray[np.float64],
    azimuths: NDArray[np.float64],
) -> None:
    """Render the pictures that `cast_panorama` reads, and throw them away: what no implementation can do without."""
    wedge = _wedge(elevations.tobytes(), azimuths.tobytes())
    for number in range(WEDGES):
        renderer.depth(data, wedge.view(world_from_scanner, number))


def directions(elevations: NDArray[np.float64], azimuths: NDArray[np.float64]) -> NDArray[np.float64]:
    """(N, 3) unit vectors, x forward and z up, of (N,) elevations and azimuths [rad]."""
    level = np.cos(elevations)
    return np.stack([level * np.cos(azimuths), level * np.sin(azimuths), np.sin(elevations)], axis=-1)


@dataclass(frozen=True, eq=False)
class _Wedge:
    """A sixth of a panorama as a picture: where each beam pierces it."""

    columns: int
    azimuth: float
    """Of the middle of the first wedge [rad]."""
    half_width: float
    """Of the window at unit distance."""
    bottom: float
    top: float
    width: int
    """[px]"""
    height: int
    """[px]"""
    map_x: NDArray[np.float32]
    """(E, columns) column of each beam in the picture, pixel centres at whole numbers [px]."""
    map_y: NDArray[np.float32]
    """(E, columns) row, counted from the bottom [px]."""
    cosine: NDArray[np.float32]
    """(E, columns) of the angle between beam and optical axis."""
    block: NDArray[np.int32]
    """(E, columns) flat index of the lower left of the four pixels round the beam."""

    def view(self, world_from_scanner: NDArray[np.float64], number: int) -> View:
        """The picture to be rendered for one of the wedges."""
        pose = world_from_scanner @ looking_along(self.azimuth + number * 2 * np.pi / WEDGES)
        return View(pose, -self.half_width, self.half_width, self.bottom, self.top, self.width, self.height)

    def sample(self, raw: NDArray[np.float32]) -> NDArray[np.float32]:
        """(E, columns) raw depth at the beams: bilinear on a surface, on the nearer pixel's side where two meet."""
        values = np.asarray(cv2.remap(raw, self.map_x, self.map_y, cv2.INTER_LINEAR), np.float32)
        at_jump = np.flatnonzero(blocks_across_jumps(raw).ravel().take(self.block))
        values.ravel()[at_jump] = _one_sided(raw, self.map_x.ravel()[at_jump], self.map_y.ravel()[at_jump])
        return values


def _one_sided(raw: NDArray[np.float32], x: NDArray[np.float32], y: NDArray[np.float32]) -> NDArray[np.float32]:
    """(N,) raw depth at (x, y) on the surface of the nearest pixel, prolonged by that surface's own slope."""
    column, row = np.rint(x).astype(np.intp), np.rint(y).astype(np.intp)
    nearest = raw[row, column]
    value = nearest.copy()
    for offset, before, after in (
        (x - column, raw[row, column - 1], raw[row, column + 1]),
        (y - row, raw[row - 1, column], raw[row + 1, column]),
    ):
        slope = np.where(np.abs(after - nearest) < np.abs(nearest - before), after - nearest, nearest - before)
        slope[np.abs(slope) > _STEEPEST * nearest] = 0
        value += offset.astype(np.float32) * slope
    return value


@lru_cache(maxsize=2)
def _wedge(elevations_bytes: bytes, azimuths_bytes: bytes) -> _Wedge:
    """The tables of a grid of beams, which depend on nothing else."""
    elevations = np.frombuffer(elevations_bytes)[:, None]
    azimuths = np.frombuffer(azimuths_bytes)
    density = np.clip(len(azimuths) / (2 * np.pi), *_DENSITY)  # one pixel a beam, in the middle of the picture
    azimuths = azimuths[: len(azimuths) // WEDGES]
    middle = float(azimuths.mean())
    cos_azimuth, tan_azimuth = np.cos(azimuths - middle), np.tan(azimuths - middle)
    heights = np.tan(elevations) / cos_azimuth
    width = 2 * int(np.ceil(density * tan_azimuth.max() + _MARGIN_PX))
    below, above = (int(np.ceil(density * edge + _MARGIN_PX)) for edge in (-heights.min(), heights.max()))
    map_x = np.broadcast_to(width / 2 - density * tan_azimuth - 0.5, heights.shape)  # azimuth runs to the left
    map_y = below + density * heights - 0.5  # -0.5: from pixel edges, as OpenGL counts, to OpenCV's centres
    return _Wedge(
        columns=len(azimuths),
        azimuth=middle,
        half_width=width / 2 / density,
        bottom=-below / density,
        top=above / density,
        width=width,
        height=below + above,
        map_x=map_x.astype(np.float32),
        map_y=map_y.astype(np.float32),
        cosine=(np.cos(elevations) * cos_azimuth).astype(np.float32),
        block=np.floor(map_y).astype(np.int32) * width + np.floor(map_x).astype(np.int32),
    )
