"""Whether two events, or parts of them, hold the same to the last bit, what they took of the machine aside."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np

from mission.recording.kinds import WALL_CLOCK


def differences(one: Any, other: Any, name: str = "event") -> list[str]:
    """Where they differ; empty if they do not. NaN is like NaN."""
    one, other = (value.item() if isinstance(value, np.generic) else value for value in (one, other))
    if type(one) is not type(other):
        return [f"{name}: {type(one).__name__}, {type(other).__name__}"]
    if isinstance(one, np.ndarray):
        alike = one.dtype == other.dtype and one.shape == other.shape
        return [] if alike and np.array_equal(one, other, equal_nan=one.dtype.kind == "f") else [name]
    if dataclasses.is_dataclass(one):
        names = [field.name for field in dataclasses.fields(one) if field.name not in WALL_CLOCK]
        one, other = ({name: getattr(value, name) for name in names} for value in (one, other))
    elif isinstance(one, tuple | list):
        one, other = dict(enumerate(one)), dict(enumerate(other))
    if isinstance(one, dict):
        if list(one) != list(other):
            return [f"{name}: {list(one)}, {list(other)}"]
        return [found for key in one for found in differences(one[key], other[key], f"{name}.{key}")]
    return [] if one == other or (one != one and other != other) else [f"{name}: {one}, {other}"]
