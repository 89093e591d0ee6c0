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
    body_from_view: NDArray[np.float64]
    """(B, 3, 3) turns a beam into the body's frame, and divides it by the radii [1/m]."""
    origins: NDArray[np.float64]
    """(B, 3) the beams' origin in the body's frame [radii]."""
    geoms: NDArray[np.int32]
    """(B,) geom ids."""


@compiled
def draw_round_bodies(spans: NDArray[np.int32], bodies: RoundBodies, first: int, grid: Grid, strip: Strip) -> None:
    """Draw round bodies on a strip, before what lies behind them.

    Args:
        spans: (N, 4) body, column, first and last row of the beams that may meet it.
        bodies: the round bodies.
        first: index of the first one among the surfaces of the strip.
        grid: all beams.
        strip: some of its columns; changed in place.
    """
    for i in range(len(spans)):
        body, column = spans[i, 0], spans[i, 1]
        kind, half_length, turn = bodies.kinds[body], bodies.half_lengths[body], bodies.body_from_view[body]
        eye = bodies.origins[body, 0], bodies.origins[body, 1], bodies.origins[body, 2]
        ahead = _level(turn, grid.ahead[column], grid.aside[column])
        inverse_range, surfaces = strip.inverse_range[column - strip.first], strip.surfaces[column - strip.first]
        for row in range(spans[i, 2], spans[i, 3] + 1):
            level, rise = grid.level[row], grid.rise[row]
            x = ahead[0] * level + turn[0, 2] * rise
            y = ahead[1] * level + turn[1, 2] * rise
            z = ahead[2] * level + turn[2, 2] * rise
            near = np.float32(1 / _reach(kind, half_length, eye, (x, y, z)))
            if near > inverse_range[row]:
                inverse_range[row], surfaces[row] = near, first + body


@compiled
def _level(turn: NDArray[np.float64], x: float, y: float) -> tuple[float, float, float]:
    """The level part of a beam in the body's frame."""
    return turn[0, 0] * x + turn[0, 1] * y, turn[1, 0] * x + turn[1, 1] * y, turn[2, 0] * x + turn[2, 1] * y


@compiled
def _reach(kind: int, half_length: float, eye: tuple[float, float, float], beam: tuple[float, float, float]) -> float:
    """Range at which a beam enters a body, or leaves it if it starts inside; infinite where it passes by.

    A pill is a rod without lids between two balls, each of which counts beyond its end of the rod.
    """
    best = np.inf
    if kind != BALL:
        square, product = beam[0] ** 2 + beam[1] ** 2, eye[0] * beam[0] + eye[1] * beam[1]
        for reach in _roots(square, product, eye[0] ** 2 + eye[1] ** 2 - 1):
            if 0 < reach < best and abs(eye[2] + reach * beam[2]) <= half_length:
                best = reach
    if kind == ROD:
        for end in (-half_length, half_length):
            reach = (end - eye[2]) / beam[2] if beam[2] != 0 else np.inf
            if 0 < reach < best and (eye[0] + reach * beam[0]) ** 2 + (eye[1] + reach * beam[1]) ** 2 <= 1:
                best = reach
        return best
    square = beam[0] ** 2 + beam[1] ** 2 + beam[2] ** 2
    for side in (-1.0, 1.0):
        height = eye[2] - side * half_length  # of the origin above the ball's middle
        product = eye[0] * beam[0] + eye[1] * beam[1] + height * beam[2]
        for reach in _roots(square, product, eye[0] ** 2 + eye[1] ** 2 + height**2 - 1):
            if 0 < reach < best and (kind == BALL or side * (height + reach * beam[2]) >= 0):
                best = reach
    return best


@compiled
def slopes_of_round_bodies(
    strip: Strip, bodies: RoundBodies, first: int, grid: Grid, slopes: NDArray[np.float32], geoms: NDArray[np.int32]
) -> None:
    """Say what lies behind the beams that meet round bodies.

    Args:
        strip: all drawn.
        bodies: the round bodies.
        first: index of the first one among the surfaces of the strip.
        grid: all beams.
        slopes: (3, columns, R) normals, of a length that makes the product with the beam its inverse range; those of
            round bodies are set.
        geoms: (columns, R) geom ids; likewise.
    """
    for k in range(len(strip.surfaces)):
        ahead, aside = grid.ahead[strip.first + k], grid.aside[strip.first + k]
        for row in range(len(grid.level)):
            body = strip.surfaces[k, row] - first
            if body < 0:
                continue
            beam = ahead * grid.level[row], aside * grid.level[row], grid.rise[row]
            x, y, z = _normal(bodies, body, beam, 1 / strip.inverse_range[k, row])
            scale = strip.inverse_range[k, row] / (x * beam[0] + y * beam[1] + z * beam[2])
            slopes[0, k, row], slopes[1, k, row], slopes[2, k, row] = x * scale, y * scale, z * scale
            geoms[k, row] = bodies.geoms[body]


@compiled
def _normal(
    bodies: RoundBodies, body: int, beam: tuple[float, float, float], reach: float
) -> tuple[float, float, float]:
    """Normal of a body where a beam meets it, of any length, in the frame of the beams."""
    turn, eye, half_length = bodies.body_from_view[body], bodies.origins[body], bodies.half_lengths[body]
    level = _level(turn, beam[0], beam[1])
    x = eye[0] + reach * (level[0] + turn[0, 2] * beam[2])
    y = eye[1] + reach * (level[1] + turn[1, 2] * beam[2])
    z = eye[2] + reach * (level[2] + turn[2, 2] * beam[2])
    if bodies.kinds[body] == ROD and abs(abs(z) - half_length) < abs(x * x + y * y - 1) / 2:  # on a lid
        x, y = 0.0, 0.0
    elif bodies.kinds[body] != BALL:
        z -= min(max(z, -half_length), half_length)  # from the nearest point of the axis
    return (
        turn[0, 0] * x + turn[1, 0] * y + turn[2, 0] * z,
        turn[0, 1] * x + turn[1, 1] * y + turn[2, 1] * z,
        turn[0, 2] * x + turn[1, 2] * y + turn[2, 2] * z,
    )


@compiled
def _roots(a: float, b: float, c: float) -> tuple[float, float]:
    """Solutions of a x2 + 2 b x + c = 0, infinite where there are none."""
    radicand = b * b - a * c
    if radicand < 0 or a == 0:
        return np.inf, np.inf
    root = math.sqrt(radicand)
    return (-b - root) / a, (-b + root) / a
