"""What a scan says of places without points: seen through, or not seen (section 3's Opening and Occluded)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field

from mission.rigid import inverted, transformed
from mission.samples import PosedSample

Mask = NDArray[np.bool_]


class VisibilityParameters(BaseModel):
    """When a beam counts as having passed a place."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    minimum_range: float = Field(default=1.5, ge=0, description="nothing nearer returns: VZ-400 [m]")
    maximum_incidence: float = Field(
        default=float(np.deg2rad(75)), gt=0, lt=np.pi / 2, description="flatter beams may get lost on a surface [rad]"
    )
    shadow: float = Field(
        default=float(np.deg2rad(2)), gt=0, description="grid of the directions with something near [rad]"
    )


@dataclass(frozen=True, eq=False)
class Sight:
    """A scan's range image looked up in the direction of places."""

    distance: NDArray[np.float64]
    """(M,) from the scanner to the place [m]."""
    measured: NDArray[np.float64]
    """(M,) range in that direction [m]; NaN where nothing came back or nothing was sent."""
    in_view: Mask
    """(M,) the direction is within the field of view."""


def look(scan: PosedSample, places_in_world: NDArray[np.floating]) -> Sight:
    """Looks a scan's range image up in the direction of places (M, 3); the nearest beam answers."""
    sample = scan.sample
    x, y, z = transformed(places_in_world.astype(float), inverted(scan.world_from_scanner)).T
    distance = np.sqrt(x * x + y * y + z * z)
    row = _nearest(np.arctan2(z, np.hypot(x, y)), sample.elevations)
    pitch = float(sample.azimuths[1] - sample.azimuths[0])
    column = np.rint(((np.arctan2(y, x) - sample.azimuths[0]) % (2 * np.pi)) / pitch).astype(int)
    if abs(len(sample.azimuths) * pitch - 2 * np.pi) < 1.5 * pitch:  # a full turn closes
        column %= len(sample.azimuths)
    in_view = (row >= 0) & (row < len(sample.elevations)) & (column < len(sample.azimuths))
    measured = np.full(len(distance), np.nan)
    measured[in_view] = sample.ranges[row[in_view], column[in_view]]
    return Sight(distance=distance, measured=measured, in_view=in_view)


def looked_through(
    places_in_world: NDArray[np.floating],
    normals_in_world: NDArray[np.floating],
    scans: Sequence[PosedSample],
    *,
    behind: float,
    parameters: VisibilityParameters,
) -> Mask:
    """Tells which scans looked through places on surfaces, and met nothing until well behind the surface.

    A beam without a return went into the void, or met something nearer than the scanner's minimum range. It counts
    only if the place is farther than that, the surface not too oblique, nothing known stands close to the scanner
    there, and - as soon as there are other scans - one of them saw that the beam's first metres are free.

    Args:
        places_in_world: (M, 3) [m].
        normals_in_world: (M, 3) unit normals of the surfaces.
        scans: All scans that may have looked.
        behind: A beam has passed when it went on for this depth behind the surface [m].
        parameters: Limits.

    Returns:
        (S, M) True where scan s looked through place m.
    """
    passed = np.zeros((len(scans), len(places_in_world)), bool)
    shadows = [_near_directions(scan, scans, parameters) for scan in scans]
    for number, scan in enumerate(scans):
        sight = look(scan, places_in_world)
        towards = scan.scanner_in_world - places_in_world
        cosine = np.abs(np.sum(towards * normals_in_world, axis=1)) / np.maximum(sight.distance, 1e-9)
        passed[number] = sight.measured > sight.distance + behind / np.maximum(cosine, 1e-3)
        void = sight.in_view & np.isnan(sight.measured) & (sight.distance > parameters.minimum_range)
        void &= cosine > np.cos(parameters.maximum_incidence)
        void[void] = ~_shadowed(scan, places_in_world[void], shadows[number], parameters)
        others = [(other, shadow) for k, (other, shadow) in enumerate(zip(scans, shadows, strict=True)) if k != number]
        if others:
            void[void] = _free_near(scan, places_in_world[void], others, parameters)
        passed[number] |= void
    return passed


def _nearest(angles: NDArray[np.float64], axis: NDArray[np.float64]) -> NDArray[np.int_]:
    """Index of the nearest entry of an evenly spaced axis; outside it -1 or its length."""
    index = np.rint((angles - axis[0]) / (axis[1] - axis[0])).astype(int)
    return np.clip(index, -1, len(axis))


def _near_directions(scan: PosedSample, scans: Sequence[PosedSample], parameters: VisibilityParameters) -> Mask:
    """Grid of directions (elevation, azimuth) in which some scan found something too close for this one."""
    from scipy.ndimage import binary_dilation

    grid = np.zeros((int(np.pi / parameters.shadow) + 1, int(2 * np.pi / parameters.shadow) + 1), bool)
    reach = parameters.minimum_range + 0.1
    for other in scans:
        offset = other.points_in_world - scan.scanner_in_world.astype(np.float32)
        near = other.points_in_world[np.sum(offset**2, axis=1) < reach**2]
        grid[_direction_cells(scan, near, parameters)] = True
    around = np.concatenate([grid[:, -1:], grid, grid[:, :1]], axis=1)  # azimuth closes
    return binary_dilation(around, np.ones((3, 3), bool))[:, 1:-1]


def _direction_cells(
    scan: PosedSample, places: NDArray[np.floating], parameters: VisibilityParameters
) -> tuple[NDArray[np.int_], NDArray[np.int_]]:
    x, y, z = transformed(places.astype(float), inverted(scan.world_from_scanner)).T
    elevation, azimuth = np.arctan2(z, np.hypot(x, y)), np.arctan2(y, x)
    return (
        ((elevation + np.pi / 2) / parameters.shadow).astype(int),
        ((azimuth + np.pi) / parameters.shadow).astype(int),
    )


def _shadowed(scan: PosedSample, places: NDArray[np.floating], shadow: Mask, parameters: VisibilityParameters) -> Mask:
    return shadow[_direction_cells(scan, places, parameters)]


def _free_near(
    scan: PosedSample,
    places: NDArray[np.floating],
    others: Sequence[tuple[PosedSample, Mask]],
    parameters: VisibilityParameters,
) -> Mask:
    """Places (M,) whose beam's stretch within the minimum range was seen free by other scans.

    The first 0.4 m are free because the robot stands there.
    """
    origin = scan.scanner_in_world
    beams = places - origin
    beams = beams / np.sqrt(np.sum(beams**2, axis=1, keepdims=True))
    free = np.ones(len(places), bool)
    for reach in np.linspace(0.4, parameters.minimum_range, 5):
        spots = origin + reach * beams
        seen = np.zeros(len(places), bool)
        for other, shadow in others:
            sight = look(other, spots)
            void = sight.in_view & np.isnan(sight.measured) & (sight.distance > parameters.minimum_range)
            seen |= (sight.measured > sight.distance) | (void & ~_shadowed(other, spots, shadow, parameters))
        free &= seen
    return free
