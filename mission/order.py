"""What a mission was asked to do: kept beside its recording from the first second, so that it can be done again."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from mission.config import MissionConfig, changed_config
from mission.errors import UsageError
from mission.report import write_json

FILE = "order.json"
"""In the folder of the results."""


@dataclass(frozen=True)
class Order:
    """A mission as the command line has it."""

    scene: Path
    seed: int
    config: MissionConfig
    door_angles: Mapping[str, float]
    """Openings of doors by their names [rad]."""
    keyframe: str | None
    obstacles: Sequence[tuple[float, float, float | None]]
    """x, y [m] and time [s] of each."""


def write_order(folder: Path, order: Order) -> None:
    """Keep an order in a folder."""
    content = {
        "scene": str(order.scene.resolve()),
        "seed": order.seed,
        "door_angles": dict(order.door_angles),
        "keyframe": order.keyframe,
        "obstacles": [list(obstacle) for obstacle in order.obstacles],
        "config": order.config.model_dump(mode="json"),
    }
    write_json(folder / FILE, content)


def read_order(folder: Path) -> Order:
    """The order that is kept in a folder.

    Raises:
        UsageError: There is none, or it is none.
    """
    path = folder / FILE
    try:
        content: dict[str, Any] = json.loads(path.read_text())
        return Order(
            scene=Path(content["scene"]),
            seed=int(content["seed"]),
            config=changed_config(content["config"], ()),
            door_angles={str(name): _finite(angle) for name, angle in content["door_angles"].items()},
            keyframe=None if content["keyframe"] is None else str(content["keyframe"]),
            obstacles=[
                (_finite(x), _finite(y), None if time is None else _finite(time)) for x, y, time in content["obstacles"]
            ],
        )
    except FileNotFoundError as error:
        raise UsageError(f"no mission was begun in this folder (it has no {FILE}): {folder}") from error
    except OSError as error:
        raise UsageError(f"{error.strerror}: {path}") from error
    except (ValueError, TypeError, KeyError, AttributeError) as error:
        raise UsageError(f"not the order of a mission: {path}") from error


def _finite(value: Any) -> float:
    number = float(value)
    if not math.isfinite(number):
        raise ValueError(f"{value} is no number")
    return number
