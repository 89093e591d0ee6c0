"""How MoPAD, a Robotnik Guardian, is used, and what it looks like: plain data, free of the simulator."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from pydantic import Field

from sim.parameters import Parameters


class RobotParameters(Parameters):
    """How MoPAD drives and how well it knows it."""

    max_speed: float = Field(0.3, ge=0.01, le=1.5, description="Guardian navigation: 0.1-0.3 m/s, at most 1.5 [m/s]")
    max_turn_rate: float = Field(0.7, ge=0.01, le=1.0, description="Guardian: 0.7 rad/s [rad/s]")
    max_acceleration: float = Field(0.5, ge=0.01, le=5, description="Guardian navigation: 0.5 m/s2 [m/s^2]")
    max_turn_acceleration: float = Field(1.0, ge=0.01, le=10, description="so that it turns without a jerk [rad/s^2]")
    wheel_radius: float = Field(0.18, ge=0.05, le=0.5, description="Guardian code: diameter 0.355-0.360 [m]")
    track_width: float = Field(
        0.46,
        ge=0.1,
        le=2,
        description="effective in odometry: 0.448 theoretical on tracks, 3 % more by slip (measured here) [m]",
    )
    encoder_scale_error: float = Field(0.01, ge=0, le=0.2, description="1 sigma of each side's rolling radius [1]")
    track_width_error: float = Field(0.02, ge=0, le=0.2, description="1 sigma: slip differs from floor to floor [1]")
    control_period: float = Field(0.02, ge=0.001, le=0.2, description="of the speed ramp and the odometry [s]")
    settling_time: float = Field(0.5, ge=0, le=10, description="standing still after being set down [s]")


@dataclass(frozen=True)
class RobotShape:
    """Triangles of the robot as it is drawn."""

    vertices: np.ndarray
    """(V, 3) float32 in the base frame [m]."""
    triangles: np.ndarray
    """(T, 3) int32 indices of vertices, anticlockwise seen from outside."""
    colours: np.ndarray
    """(V, 3) uint8 sRGB."""
