"""Rooms of boxes and their exact range images: rays against upright boxes, nothing else."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim.scan import Scan


@dataclass(frozen=True)
class Box:
    """An upright box that stands anywhere, turned about the vertical."""

    centre: tuple[float, float, float]
    size: tuple[float, float, float]
    yaw: float = 0.0


def box(x: tuple[float, float], y: tuple[float, float], z: tuple[float, float]) -> Box:
    """A box from its limits."""
    limits = np.array([x, y, z], float)
    centre, size = limits.mean(axis=1), limits[:, 1] - limits[:, 0]
    return Box((centre[0], centre[1], centre[2]), (size[0], size[1], size[2]))


def moved(boxes: list[Box], yaw: float, shift: tuple[float, float]) -> list[Box]:
    """The boxes turned about the origin and then shifted."""
    c, s = np.cos(yaw), np.sin(yaw)
    return [
        Box(
            (c * b.centre[0] - s * b.centre[1] + shift[0], s * b.centre[0] + c * b.centre[1] + shift[1], b.centre[2]),
            b.size,
            b.yaw + yaw,
        )
        for b in boxes
    ]


def pose(x: float, y: float, yaw: float = 0.0, z: float = 1.2) -> NDArray[np.float64]:
    """An upright scanner's world_from_scanner."""
    c, s = np.cos(yaw), np.sin(yaw)
    return np.array([[c, -s, 0, x], [s, c, 0, y], [0, 0, 1, z], [0, 0, 0, 1]], float)


def plain_room(width: float = 6.0, depth: float = 4.0, height: float = 2.6, ceiling: bool = True) -> list[Box]:
    """Floor, four walls of 0.2 m round 0..width by 0..depth, and a ceiling."""
    w, d, h = width, depth, height
    boxes = [
        box((-0.2, w + 0.2), (-0.2, d + 0.2), (-0.2, 0)),
        box((-0.2, w + 0.2), (-0.2, 0), (0, h)),
        box((w, w + 0.2), (0, d), (0, h)),
        box((-0.2, w + 0.2), (d, d + 0.2), (0, h)),
        box((-0.2, 0), (0, d), (0, h)),
    ]
    return boxes + ([box((-0.2, w + 0.2), (-0.2, d + 0.2), (h, h + 0.2))] if ceiling else [])


def with_doorway(boxes: list[Box], wall: int, left: float, right: float, top: float) -> list[Box]:
    """A gap from `left` to `right` along x and up to `top` in a wall of a room that runs along x."""
    b = boxes[wall]
    (cx, cy, cz), (sx, sy, sz) = b.centre, b.size
    x = (cx - sx / 2, cx + sx / 2)
    y, z = (cy - sy / 2, cy + sy / 2), (cz - sz / 2, cz + sz / 2)
    pieces = [box((x[0], left), y, z), box((right, x[1]), y, z)]
    if top < z[1]:
        pieces.append(box((left, right), y, (top, z[1])))
    return boxes[:wall] + pieces + boxes[wall + 1 :]


def scan(
    boxes: list[Box],
    world_from_scanner: NDArray[np.float64],
    *,
    step_deg: float = 0.5,
    noise: float = 0.0,
    seed: int = 0,
    min_range: float = 1.5,
) -> Scan:
    """The range image of a full turn, +60 to -40 deg, with range noise [m]."""
    elevations = np.deg2rad(np.arange(60 - step_deg / 2, -40, -step_deg))
    azimuths = np.deg2rad(np.arange(0, 360 - step_deg / 2, step_deg))
    e, a = np.meshgrid(elevations, azimuths, indexing="ij")
    d = np.stack([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)]).reshape(3, -1)
    d = (world_from_scanner[:3, :3] @ d).astype(np.float32)
    ranges = np.full(e.size, np.inf, np.float32)
    for b in boxes:
        ranges = np.minimum(ranges, _ranges_to(b, world_from_scanner[:3, 3], d))
    ranges = ranges.reshape(e.shape)
    ranges += noise * np.random.default_rng(seed).standard_normal(ranges.shape)
    ranges[(ranges < min_range) | (ranges > 600)] = np.nan
    return Scan(elevations, azimuths, ranges.astype(np.float32), np.zeros(ranges.shape, np.float32), 0.0)


def _ranges_to(b: Box, origin: NDArray[np.float64], d: NDArray[np.float32]) -> NDArray[np.float32]:
    """(N,) distance to a box along beams (3, N); infinite where they miss it."""
    c, s = np.cos(b.yaw), np.sin(b.yaw)
    box_from_world = np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])
    start = box_from_world @ (origin - np.array(b.centre))
    enter = np.full(d.shape[1], -np.inf, np.float32)
    leave = np.full(d.shape[1], np.inf, np.float32)
    for along, half, at in zip(box_from_world.astype(np.float32), np.array(b.size) / 2, start, strict=True):
        with np.errstate(divide="ignore"):
            slowness = 1 / (along[0] * d[0] + along[1] * d[1] + along[2] * d[2])
        near, far = np.float32(-half - at) * slowness, np.float32(half - at) * slowness
        np.maximum(enter, np.minimum(near, far), out=enter)
        np.minimum(leave, np.maximum(near, far), out=leave)
    return np.where((enter <= leave) & (enter > 0), enter, np.float32(np.inf))
