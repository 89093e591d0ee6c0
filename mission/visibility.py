"""What a scan says of places without points: seen through, or not seen (section 3's Opening and Occluded)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from mission.rigid import inverted, transformed
from mission.samples import PosedSample
from sim.parameters import Parameters
from sim.scan import ScannerParameters

Mask = NDArray[np.bool_]


class VisibilityParameters(Parameters):
    """When a beam counts as having passed a place."""

    max_incidence: float = Field(
        default=math.radians(75), gt=0, lt=math.pi / 2, description="flatter beams may get lost on a surface [rad]"
    )
    shadow: float = Field(
        default=math.radians(2), ge=0.002, le=0.5, description="grid of the directions with something near [rad]"
    )


_STAND = 0.4
"""A scan's beams are free up to here [m]: the robot stands there."""


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
    """Look a scan's range image up in the direction of places (M, 3); the nearest beam answers."""
    sample = scan.sample
    distance, row, column = _beams(scan, places_in_world)
    in_view = (row >= 0) & (row < len(sample.elevations)) & (column < len(sample.azimuths))
    measured = np.full(len(distance), np.nan)
    measured[in_view] = sample.ranges[row[in_view], column[in_view]]
    return Sight(distance=distance, measured=measured, in_view=in_view)


class Visibility:
    """What several scans say together.

    A beam without a return went into the void, or met something nearer than the scanner's minimum range. It counts as
    having passed a place only if the place is farther than that, the surface there not too oblique, nothing known
    stands close to the scanner in that direction, and the beam's first metres are free: one of the other scans saw
    that, or, as long as there is no other, the same scan sees the floor below, on which a near thing would throw its
    shadow.

    Args:
        scans: All scans that may have looked.
        scanner: What took them: nothing nearer than its minimum range returns.
        parameters: Limits.
    """

    def __init__(
        self, scans: Sequence[PosedSample], scanner: ScannerParameters, parameters: VisibilityParameters | None = None
    ) -> None:
        self.scans = tuple(scans)
        self.parameters = parameters or VisibilityParameters()
        self._nearest = scanner.min_range
        self._shadows = [_near_directions(scan, scans, self._nearest, self.parameters) for scan in scans]

    def looked_through(
        self, places_in_world: NDArray[np.floating], normals_in_world: NDArray[np.floating], *, behind: float
    ) -> Mask:
        """Tell which scans looked through places on surfaces, and met nothing until well behind the surface.

        Args:
            places_in_world: (M, 3) [m].
            normals_in_world: (M, 3) unit normals of the surfaces, of either side.
            behind: A beam has passed when it went on for this depth behind the surface [m].

        Returns:
            (S, M) True where scan s looked through place m.
        """
        passed = np.zeros((len(self.scans), len(places_in_world)), bool)
        for number, scan in enumerate(self.scans):
            sight = look(scan, places_in_world)
            towards = scan.scanner_in_world - places_in_world
            cosine = np.abs(np.sum(towards * normals_in_world, axis=1)) / np.maximum(sight.distance, 1e-9)
            passed[number] = sight.measured > sight.distance + behind / np.maximum(cosine, 1e-3)
            steep = cosine > np.cos(self.parameters.max_incidence)
            void = self._void(number, places_in_world, sight) & steep
            if void.any():
                void[void] = self._free_near(number, places_in_world[void])
            passed[number] |= void
        return passed

    def _void(self, number: int, places: NDArray[np.floating], sight: Sight) -> Mask:
        """Places (M,) in whose direction nothing came back, although nothing known is too close to return."""
        void = sight.in_view & np.isnan(sight.measured) & (sight.distance > self._nearest)
        cells = _direction_cells(self.scans[number], places[void], self.parameters)
        void[void] = ~self._shadows[number][cells]
        return void

    def _free_near(self, number: int, places: NDArray[np.floating]) -> Mask:
        """Places (M,) whose beam's stretch within the minimum range was seen free by other scans.

        A lone scan sees at least whether the floor is there.
        """
        if self._nearest <= _STAND:
            return np.ones(len(places), bool)
        if len(self.scans) == 1:
            return _over_floor(self.scans[number], places)
        origin = self.scans[number].scanner_in_world
        beams = places - origin
        beams = beams / np.sqrt(np.sum(beams**2, axis=1, keepdims=True))
        free = np.ones(len(places), bool)
        for reach in np.linspace(_STAND, self._nearest, 5):
            spots = origin + reach * beams
            seen = np.zeros(len(places), bool)
            for other, scan in enumerate(self.scans):
                if other != number:
                    sight = look(scan, spots)
                    seen |= (sight.measured > sight.distance) | self._void(other, spots, sight)
            free &= seen
        return free


def _beams(
    scan: PosedSample, places: NDArray[np.floating]
) -> tuple[NDArray[np.float64], NDArray[np.int_], NDArray[np.int_]]:
    """Distance [m], and row and column of the nearest beam, of places (M, 3); outside the image where none was sent."""
    sample = scan.sample
    x, y, z = transformed(places.astype(float), inverted(scan.world_from_scanner)).T
    row = _nearest(np.arctan2(z, np.hypot(x, y)), sample.elevations)
    pitch = float(sample.azimuths[1] - sample.azimuths[0])
    column = np.rint(((np.arctan2(y, x) - sample.azimuths[0]) % (2 * np.pi)) / pitch).astype(int)
    if abs(len(sample.azimuths) * pitch - 2 * np.pi) < 1.5 * pitch:  # a full turn closes
        column %= len(sample.azimuths)
    return np.sqrt(x * x + y * y + z * z), row, column


def _over_floor(scan: PosedSample, places: NDArray[np.floating]) -> Mask:
    """Places (M,) in whose azimuth something comes back to the lowest beams (5 deg)."""
    lowest = scan.sample.elevations < scan.sample.elevations[-1] + np.deg2rad(5)
    floor = np.isfinite(scan.sample.ranges[lowest]).mean(axis=0) > 0.5
    return floor[_beams(scan, places)[2]]


def _nearest(angles: NDArray[np.float64], axis: NDArray[np.float64]) -> NDArray[np.int_]:
    """Index of the nearest entry of an evenly spaced axis; outside it -1 or its length."""
    index = np.rint((angles - axis[0]) / (axis[1] - axis[0])).astype(int)
    return np.clip(index, -1, len(axis))


def _near_directions(
    scan: PosedSample, scans: Sequence[PosedSample], nearest: float, parameters: VisibilityParameters
) -> Mask:
    """Grid of directions (elevation, azimuth) in which some scan found something too near for this one to measure."""
    from scipy.ndimage import binary_dilation

    rows, columns = _grid_shape(parameters)
    grid = np.zeros((rows, columns), bool)
    reach = nearest + 0.1
    for other in scans:
        x, y, z = (other.points_in_world - scan.scanner_in_world.astype(np.float32)).T
        near = other.points_in_world[x * x + y * y + z * z < reach**2]
        grid[_direction_cells(scan, near, parameters)] = True
    around = np.concatenate([grid[:, -1:], grid, grid[:, :1]], axis=1)  # azimuth closes
    return binary_dilation(around, np.ones((3, 3), bool))[:, 1:-1]


def _grid_shape(parameters: VisibilityParameters) -> tuple[int, int]:
    """Rows of elevation and columns of azimuth; a whole number of columns, so that the last meets the first."""
    return int(np.pi / parameters.shadow) + 1, round(2 * np.pi / parameters.shadow)


def _direction_cells(
    scan: PosedSample, places: NDArray[np.floating], parameters: VisibilityParameters
) -> tuple[NDArray[np.int_], NDArray[np.int_]]:
    x, y, z = transformed(places.astype(float), inverted(scan.world_from_scanner)).T
    elevation, azimuth = np.arctan2(z, np.hypot(x, y)), np.arctan2(y, x)
    columns = _grid_shape(parameters)[1]
    return (
        ((elevation + np.pi / 2) / parameters.shadow).astype(int),
        ((azimuth + np.pi) / (2 * np.pi) * columns).astype(int) % columns,
    )
