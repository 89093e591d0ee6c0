"""What a Riegl VZ-400 delivers, and how it is used: plain data, free of the simulator."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from sim.echo import MAX_RANGE, MIN_RANGE, PRECISION
from sim.parameters import Parameters

ELEVATION_TOP_DEG, ELEVATION_BOTTOM_DEG = 60.0, -40.0
"""Ends of the field of view (riegllms, riegl-vz driver)."""


class ScannerParameters(Parameters):
    """How the scanner is used."""

    pattern: Literal["panorama_40", "panorama_60", "draft"] = Field(default="panorama_60", description="grid of beams")
    noise: bool = Field(default=True, description="range and reflectance noise and rounding; off gives exact ranges")
    precision: float = Field(default=PRECISION, ge=0, le=0.1, description="range noise, one sigma [m] (data sheet)")
    min_range: float = Field(default=MIN_RANGE, ge=0.1, le=5, description="nearest range measured [m] (HELIOS++)")
    max_range: float = Field(
        default=MAX_RANGE, ge=10, le=900, description="farthest range on a 90 % target [m] (data sheet)"
    )

    @property
    def highest_elevation(self) -> float:
        """Upper end of the field of view [rad]."""
        return math.radians(ELEVATION_TOP_DEG)

    @property
    def lowest_elevation(self) -> float:
        """Lower end of the field of view [rad]."""
        return math.radians(ELEVATION_BOTTOM_DEG)


@dataclass(frozen=True, eq=False)
class Scan:
    """What the instrument delivers: a panorama in its own frame (x forward, z up, origin where the beams start)."""

    elevations: NDArray[np.float64]
    """(E,) elevation of each row, descending [rad]."""
    azimuths: NDArray[np.float64]
    """(A,) azimuth of each column, anticlockwise from x [rad]."""
    ranges: NDArray[np.float32]
    """(E, A) distance [m]; NaN = no return."""
    reflectance: NDArray[np.float32]
    """(E, A) reflectance relative to a white target square to the beam [dB]; NaN = no return."""
    duration: float
    """Time that the scan took [s]."""

    @property
    def hits(self) -> NDArray[np.bool_]:
        """(E, A) True where there was a return; `array[scan.hits]` is in the order of `points()`."""
        return ~np.isnan(self.ranges)

    def points(self) -> NDArray[np.float32]:
        """(N, 3) points of all returns in the scanner frame [m], row by row."""
        hits = self.hits
        points = np.empty((np.count_nonzero(hits), 3), np.float32)
        across = self.ranges * np.cos(self.elevations).astype(np.float32)[:, None]
        points[:, 0] = (across * np.cos(self.azimuths).astype(np.float32))[hits]
        points[:, 1] = (across * np.sin(self.azimuths).astype(np.float32))[hits]
        points[:, 2] = (self.ranges * np.sin(self.elevations).astype(np.float32)[:, None])[hits]
        return points
