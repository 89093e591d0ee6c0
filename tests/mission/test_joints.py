"""What the joints say of a door."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np

from mission.joints import opening


def door(kind: str, *leaves: tuple[float, float]) -> Any:
    angles = [SimpleNamespace(opening_angle=angle, opening=way) for angle, way in leaves]
    return SimpleNamespace(kind=kind, leaves=tuple(angles))


def test_a_double_door_is_as_open_as_its_wider_leaf() -> None:
    assert opening(door("hinged", (0.2, np.nan), (0.9, np.nan))) == 0.9


def test_a_sliding_door_is_open_by_metres() -> None:
    assert opening(door("sliding", (np.nan, 0.4))) == 0.4
