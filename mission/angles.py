"""Angles for people and for files: in degrees, rounded, and never -0; and shares of 1."""

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


def rounded_share(share: float | None, digits: int) -> float | None:
    """A share of 1; None where there is none."""
    return None if share is None or not math.isfinite(share) else round(share, digits) + 0.0


def share_text(share: float | None) -> str:
    """A share of 1 as "97 %", or "-" where there is none."""
    rounded = rounded_share(share, 2)
    return "-" if rounded is None else f"{rounded:.0%}".replace("%", " %")


def opening_text(angle: float | None, opened_fraction: float | None, *, unit: str = "") -> str:
    """How far a door stands open: "34.8" and the unit; or, if it slides, "45 %" of its doorway; or "-"."""
    is_hinged = rounded_share(opened_fraction, 2) is None
    return degrees_text(angle, unit=unit) if is_hinged else share_text(opened_fraction)
