"""The truth about doors as they stand: plain data, free of the simulator."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np


@dataclass(frozen=True)
class LeafTruth:
    """One leaf as it stands now."""

    name: str
    """Of the body, else of the joint."""
    opening_angle: float
    """From closed [rad], at least 0; NaN for a sliding leaf."""
    opening: float
    """Way from closed [m], at least 0; NaN for a hinged leaf."""
    swing_normal: np.ndarray
    """(3,) horizontal unit vector towards which the free edge leaves the closed leaf's plane; for a slide, the way."""
    corners_in_world: np.ndarray
    """(4, 3) mid-plane of the leaf now: hinge bottom, free bottom, free top, hinge top [m]."""


@dataclass(frozen=True)
class DoorTruth:
    """One doorway with its leaf or its two leaves."""

    name: str
    """The leaf's name; of a double door, both joined with `+`."""
    kind: Literal["hinged", "sliding"]
    leaf_names: tuple[str, ...]
    corners_in_world: np.ndarray
    """(4, 3) rectangle on the mid-plane that the closed leaves fill: bottom left, bottom right, top right, top left,
    seen from the side that `normal` points to [m]."""
    normal: np.ndarray
    """(3,) horizontal unit normal of the closed leaf, towards the side to which the (first) leaf opens."""
    outlines_in_world: tuple[np.ndarray, np.ndarray]
    """(4, 3) each, like `corners_in_world`: the doorway as it shows from the side that `normal` points to, and from the
    other: the closed leaf, and of one that slides what the wall does not cover [m]."""
    leaves: tuple[LeafTruth, ...]
