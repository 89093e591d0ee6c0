"""Spheres, ellipsoids, cylinders and capsules met by beams: exact, where a picture would show polyhedra."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.compiled import compiled
from sim.facets import Grid, Strip

BALL, ROD, PILL = range(3)
"""Kinds of round bodies: ellipsoids and spheres, cylinders, capsules."""


class RoundBodies(NamedTuple):
    """Round bodies, each in a frame of its own in which its radii are 1."""

    kinds: NDArray[np.int8]
    """(B,) `BALL`, `ROD` or `PILL`; the latter two lie along z."""
    half_lengths: NDArray[np.float64]
    """(B,) of rods, and of the straight part of pills [radii]."""
    body_from_scanner: NDArray[np.float64]
    """(B, 3, 3) turns a direction into the body's frame, and divides it by the radii [1/m]."""
    origins: NDArray[np.float64]
    """(B, 3) the scanner in the body's frame [radii]."""
    radii: NDArray[np.float64]
    """(B, 3) along the body's axes [m]."""
    geoms: NDArray[np.int32]
    """(B,) geom ids."""


@compiled
def draw_round_bodies(spans: NDArray[np.int32], bodies: RoundBodies, grid: Grid, strip: Strip) -> None:
    """Draw round bodies on a strip, before what lies behind them.

    Args:
        spans: (N, 4) body, column, first and last row of the beams that may meet it.
        bodies: the round bodies.
        grid: all beams.
        strip: some of its columns; changed in place.
    """
    for i in range(len(spans)):
        body, column = spans[i, 0], spans[i, 1]
        kind, half_length, turn = bodies.kinds[body], bodies.half_lengths[body], bodies.body_from_scanner[body]
        eye = bodies.origins[body, 0], bodies.origins[body, 1], bodies.origins[body, 2]
        radii = bodies.radii[body]
        level = _level(turn, grid.cos_azimuth[column], grid.sin_azimuth[column])
        inverse_range = strip.inverse_range[column - strip.first]
        cosine, geoms = strip.cosine[column - strip.first], strip.geoms[column - strip.first]
        for row in range(spans[i, 2], spans[i, 3] + 1):
            cos, sin = grid.cos_elevation[row], grid.sin_elevation[row]
            x = level[0] * cos + turn[0, 2] * sin
            y = level[1] * cos + turn[1, 2] * sin
            z = level[2] * cos + turn[2, 2] * sin
            reach, nx, ny, nz = _meet(kind, half_length, eye, (x, y, z))
            if 1 / reach > inverse_range[row]:
                length = math.sqrt((nx / radii[0]) ** 2 + (ny / radii[1]) ** 2 + (nz / radii[2]) ** 2)
                inverse_range[row], geoms[row] = 1 / reach, bodies.geoms[body]
                cosine[row] = abs(nx * x + ny * y + nz * z) / length


@compiled
def _level(turn: NDArray[np.float64], x: float, y: float) -> tuple[float, float, float]:
    """A level direction in the body's frame."""
    return turn[0, 0] * x + turn[0, 1] * y, turn[1, 0] * x + turn[1, 1] * y, turn[2, 0] * x + turn[2, 1] * y


@compiled
def _meet(
    kind: int, half_length: float, eye: tuple[float, float, float], beam: tuple[float, float, float]
) -> tuple[float, float, float, float]:
    """Range at which a beam enters, or leaves if it starts inside, and the normal there, in the body's frame.

    The range is infinite where the beam passes by. A pill is a rod without lids between two balls, each valid where
    the body ends.
    """
    dx, dy, dz = beam
    best, nx, ny, nz = np.inf, 0.0, 0.0, 1.0
    if kind != BALL:
        for reach in _roots(dx * dx + dy * dy, eye[0] * dx + eye[1] * dy, eye[0] ** 2 + eye[1] ** 2 - 1):
            if 0 < reach < best and abs(eye[2] + reach * dz) <= half_length:
                best, nx, ny, nz = reach, eye[0] + reach * dx, eye[1] + reach * dy, 0.0
    if kind == ROD:
        for end in (-half_length, half_length):
            reach = (end - eye[2]) / dz if dz != 0 else np.inf
            if 0 < reach < best and (eye[0] + reach * dx) ** 2 + (eye[1] + reach * dy) ** 2 <= 1:
                best, nx, ny, nz = reach, 0.0, 0.0, 1.0
        return best, nx, ny, nz
    square = dx * dx + dy * dy + dz * dz
    for side in (-1.0, 1.0):
        height = eye[2] - side * half_length  # of the scanner above the ball's middle
        product = eye[0] * dx + eye[1] * dy + height * dz
        for reach in _roots(square, product, eye[0] ** 2 + eye[1] ** 2 + height**2 - 1):
            z = height + reach * dz
            if 0 < reach < best and (kind == BALL or side * z >= 0):
                best, nx, ny, nz = reach, eye[0] + reach * dx, eye[1] + reach * dy, z
    return best, nx, ny, nz


@compiled
def _roots(a: float, b: float, c: float) -> tuple[float, float]:
    """Solutions of a x2 + 2 b x + c = 0, infinite where there are none."""
    radicand = b * b - a * c
    if radicand < 0 or a == 0:
        return np.inf, np.inf
    root = math.sqrt(radicand)
    return (-b - root) / a, (-b + root) / a
