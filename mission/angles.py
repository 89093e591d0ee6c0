"""Angles for people and for files: in degrees, rounded, and never -0."""

from __future__ import annotations

import math


def rounded_degrees(angle: float | None, digits: int) -> float | None:
    """An angle [rad] in degrees; None where there is none."""
    if angle is None or not math.isfinite(angle):
        return None
    return round(math.degrees(angle), digits) + 0.0  # + 0.0 makes 0.0 of -0.0


def degrees_text(angle: float | None, *, digits: int = 1, unit: str = "") -> str:
    """An angle [rad] as "34.8" and the unit, or "-" where there is none."""
    rounded = rounded_degrees(angle, digits)
    return "-" if rounded is None else f"{rounded:.{digits}f}{unit}"
