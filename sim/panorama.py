"""A full turn of beams, cast as six rendered pictures."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import lru_cache
from queue import SimpleQueue
from typing import Any

import cv2
import mujoco
import numpy as np
from numpy.typing import NDArray

from sim.edge_rays import EdgeRays
from sim.facets import bent_blocks, on_facets
from sim.render import Depth, Renderer, View, looking_along

WEDGES = 6
"""Six pictures of 60 deg: pixels of about the same size everywhere, and one table for all six."""

_MARGIN_PX = 3
"""Pixels round a picture that no beam needs, but its neighbours do."""
_TILE = 128
"""Side of the parts of a picture whose edges are cast as rays together [px]."""
_ROUND = [
    kind.value
    for kind in (
        mujoco.mjtGeom.mjGEOM_SPHERE,
        mujoco.mjtGeom.mjGEOM_CAPSULE,
        mujoco.mjtGeom.mjGEOM_ELLIPSOID,
        mujoco.mjtGeom.mjGEOM_CYLINDER,
    )
]
_ROUND_MARK = np.uint8(2)
_AROUND = 5
"""How far beyond its drawn edge a round geom may reach [px]: 0.5 % of its radius, from not nearer than half of that."""
_DENSITY = 512, 1024
"""Fewest and most pixels per unit of tangent, which is per radian in the middle of a picture."""


class BeamCaster:
    """Casts grids of beams in one world."""

    def __init__(self, renderer: Renderer) -> None:
        """Take a caster into use.

        Args:
            renderer: of the world; what it hides, beams pass.
        """
        self._renderer = renderer
        self._is_round = np.append(np.isin(renderer.model.geom_type, _ROUND), False)  # the last one: no geom
        self._rays = [EdgeRays(renderer.model) for _ in range(min(os.cpu_count() or 1, WEDGES))]

    def cast(
        self,
        data: mujoco.MjData,
        world_from_scanner: NDArray[np.float64],
        elevations: NDArray[np.float64],
        azimuths: NDArray[np.float64],
        value_of_geom: NDArray[np.float32],
    ) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Cast a grid of beams from one point.

        Inverse depth is linear over a plane, and the raw depth buffer is affine in it. So interpolating the raw buffer
        bilinearly is exact on planes, and it is turned into metres at the beams only. Where facets meet, their planes
        are prolonged; at the edges of things and on round ones, which are drawn as polyhedra, rays are cast.

        Args:
            data: state of the world.
            world_from_scanner: (4, 4) pose of the grid.
            elevations: (E,) of the rows, within 70 deg of level [rad].
            azimuths: (A,) of the columns, all round at equal steps, a multiple of six [rad].
            value_of_geom: (ngeom + 1,) something to be looked up for what each beam meets; the last one is for
                nothing.

        Returns:
            (E, A) inverse range [1/m], next to 0 where there is nothing; (E, A) value of the geom that was met.
        """
        wedge = _wedge(elevations.tobytes(), azimuths.tobytes())
        inverse_range = np.empty((len(elevations), len(azimuths)), np.float32)
        values = np.empty_like(inverse_range)
        free: SimpleQueue[EdgeRays] = SimpleQueue()
        for rays in self._rays:
            rays.place(data, world_from_scanner[:3, 3])
            free.put(rays)

        def read(number: int, depth: Depth) -> None:
            columns = slice(number * wedge.columns, (number + 1) * wedge.columns)

            def along(row: NDArray[np.intp], column: NDArray[np.intp]) -> NDArray[np.float64]:
                return directions(elevations[row], azimuths[columns][column]) @ world_from_scanner[:3, :3].T

            rays = free.get()
            try:
                inverse_range[:, columns], values[:, columns] = self._read(depth, wedge, rays, along, value_of_geom)
            finally:
                free.put(rays)

        with ThreadPoolExecutor(len(self._rays)) as pool:  # a picture is read while the next one is rendered
            pictures = (self._renderer.depth(data, wedge.view(world_from_scanner, k)) for k in range(WEDGES))
            for reading in [pool.submit(read, number, picture) for number, picture in enumerate(pictures)]:
                reading.result()
        return inverse_range, values

    def _read(
        self,
        depth: Depth,
        wedge: _Wedge,
        rays: EdgeRays,
        along: Callable[[NDArray[np.intp], NDArray[np.intp]], NDArray[np.float64]],
        value_of_geom: NDArray[np.float32],
    ) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """(E, columns) inverse ranges and values of a wedge; `along` gives the beams of rows and columns in world."""
        raw, inexact = wedge.sample(depth, self._is_round)
        picture = _look_up(value_of_geom[depth.geom_ids], depth.segments)
        values = np.asarray(cv2.remap(picture, wedge.map_x, wedge.map_y, cv2.INTER_NEAREST), np.float32)
        raw += np.float32(self._renderer.inverse_depth_offset / self._renderer.inverse_depth_scale)
        cv2.multiply(raw, wedge.cosine, dst=raw, scale=self._renderer.inverse_depth_scale)
        for beams, geoms in wedge.groups(depth, inexact):
            row, column = np.divmod(beams, wedge.columns)
            ranges, met = rays.cast(along(row, column), geoms)
            raw[row, column] = 1 / np.minimum(ranges, self._renderer.far)
            values[row, column] = value_of_geom[met]
        return raw, values


def bare_renders(
    renderer: Renderer,
    data: mujoco.MjData,
    world_from_scanner: NDArray[np.float64],
    elevations: NDArray[np.float64],
    azimuths: NDArray[np.float64],
) -> None:
    """Render the pictures that a `BeamCaster` reads, and throw them away: what no implementation can do without."""
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

    def sample(self, depth: Depth, is_round: NDArray[np.bool_]) -> tuple[NDArray[np.float32], NDArray[np.intp]]:
        """(E, columns) raw depth at the beams, and the flat indices of those for which it is not exact."""
        sampled = np.asarray(cv2.remap(depth.raw, self.map_x, self.map_y, cv2.INTER_LINEAR), np.float32)
        values, flat_x, flat_y, flat_block = sampled.ravel(), self.map_x.ravel(), self.map_y.ravel(), self.block.ravel()
        marks = bent_blocks(depth.raw)
        if is_round.any():
            round_marks = _look_up(_ROUND_MARK * is_round[depth.geom_ids], depth.segments)
            cv2.max(marks, cv2.dilate(round_marks, np.ones((2 * _AROUND + 1,) * 2, np.uint8)), dst=marks)
        mark = marks.ravel().take(flat_block)

        bent = np.flatnonzero(mark == 1)
        block = flat_block[bent]
        up, right = (index.astype(np.float32) for index in np.divmod(block, self.width))
        raw, proven = on_facets(depth, block, flat_x[bent] - right, flat_y[bent] - up)
        values[bent[proven]] = raw[proven]
        mark[bent[proven]] = 0

        unknown = np.flatnonzero(mark)
        nearest = np.rint(flat_y[unknown]).astype(np.intp) * self.width + np.rint(flat_x[unknown]).astype(np.intp)
        segment = depth.segments.ravel().take(nearest)
        soft = (segment > 0) & (depth.geom_ids[segment] < 0)  # flexes and skins, which rays do not know
        values[unknown[soft]] = depth.raw.ravel()[nearest[soft]]
        return sampled, unknown[~soft]

    def groups(self, depth: Depth, beams: NDArray[np.intp]) -> Iterator[tuple[NDArray[np.intp], NDArray[np.int32]]]:
        """Part beams by where in the picture they are, each part with the geoms that are seen thereabouts."""
        up, right = np.divmod(self.block.ravel()[beams], self.width)
        tile = up // _TILE * self.width + right // _TILE
        order = np.argsort(tile, kind="stable")
        for part in np.split(order, np.flatnonzero(np.diff(tile[order])) + 1):
            if len(part):
                window = tuple(
                    slice(max(first - _AROUND, 0), first + _TILE + 1 + _AROUND)
                    for first in (up[part[0]] // _TILE * _TILE, right[part[0]] // _TILE * _TILE)
                )
                seen = depth.geom_ids[np.flatnonzero(np.bincount(depth.segments[window].ravel()))]
                yield beams[part], seen[seen >= 0]


def _look_up(table: NDArray[np.generic], index: NDArray[np.uint16]) -> NDArray[Any]:
    """`table[index]`, three times as fast."""
    whole = np.zeros(2**16, table.dtype)
    whole[: len(table)] = table
    return np.asarray(cv2.LUT(index, whole))


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
