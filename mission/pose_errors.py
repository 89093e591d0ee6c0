"""How far the registered poses are off: within each room, and over the whole building. Truth, for the report only."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from mission.events import Registered
from mission.rigid import Pose, angle_between, inverted


@dataclass(frozen=True)
class PoseError:
    """Of one registered scan."""

    scan: int
    within_room: float
    """Translation against the room's first scan [m]."""
    translation: float
    """In the map [m]."""
    rotation: float
    """In the map [rad]."""


def pose_errors(registrations: Sequence[Registered], world_from_room: Mapping[int, Pose]) -> list[PoseError]:
    """Compare every accepted scan's pose with the true one.

    Args:
        registrations: In the order of the mission.
        world_from_room: (4, 4) of each room, as the links tell at the end.
    """
    first: dict[int, Registered] = {}
    errors = []
    for event in registrations:
        if not event.accepted:
            continue
        start = first.setdefault(event.room, event)
        estimate = world_from_room[event.room] @ event.world_from_scanner
        moved = inverted(start.world_from_scanner) @ event.world_from_scanner
        true_moved = inverted(start.true_world_from_scanner) @ event.true_world_from_scanner
        errors.append(
            PoseError(
                scan=event.scan_number,
                within_room=_apart(moved, true_moved),
                translation=_apart(estimate, event.true_world_from_scanner),
                rotation=angle_between(event.true_world_from_scanner, estimate),
            )
        )
    return errors


def _apart(one: Pose, other: Pose) -> float:
    return float(np.linalg.norm(one[:3, 3] - other[:3, 3]))
