"""What the joints of a scene say of its doors: truth, for the record only."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sim.door_truth import DoorTruth


def opening(door: DoorTruth) -> float:
    """How far a true door stands open: its wider leaf [rad], or its way along the slide [m]."""
    if door.kind == "sliding":
        return max(leaf.opening for leaf in door.leaves)
    return max(leaf.opening_angle for leaf in door.leaves)
