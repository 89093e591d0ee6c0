"""What a Hokuyo URG-04LX-UG01 delivers, and how it is used: plain data, free of the simulator."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from sim.parameters import Parameters


class HokuyoParameters(Parameters):
    """How the small laser is used."""

    noise: bool = Field(default=True, description="Range noise and rounding to 1 mm.")
    min_range: float = Field(default=0.02, ge=0, le=0.5, description="[m] (SCIP manual)")
    max_range: float = Field(default=5.6, ge=1, le=60, description="[m] (SCIP manual)")
    noise_near: float = Field(
        default=0.01, ge=0, le=0.2, description="One sigma up to 1 m [m]: a third of the stated 30 mm."
    )
    noise_far: float = Field(
        default=0.01, ge=0, le=0.2, description="One sigma beyond 1 m, over range: a third of the stated 3 %."
    )


@dataclass(frozen=True, eq=False)
class LaserScan:
    """One sweep in the laser's frame: x forward, z up."""

    base_from_laser: NDArray[np.float64]
    """(4, 4) where the laser sits on the robot."""
    angles: NDArray[np.float64]
    """(682,) direction of each beam, anticlockwise from x, ascending [rad]."""
    ranges: NDArray[np.float32]
    """(682,) distance [m]; NaN = no return."""
    time: int
    """Mission time of the sweep [ns]."""

    def points_in_base(self, *, up_to: float = np.inf) -> NDArray[np.float64]:
        """(N, 3) points of all returns up to a range, in the robot's frame [m]."""
        kept = self.ranges <= up_to  # NaN compares false
        angles, ranges = self.angles[kept], self.ranges[kept].astype(np.float64)
        in_laser = np.stack([ranges * np.cos(angles), ranges * np.sin(angles), np.zeros_like(ranges)], axis=1)
        return in_laser @ self.base_from_laser[:3, :3].T + self.base_from_laser[:3, 3]
