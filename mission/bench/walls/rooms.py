"""The rooms of the walls benchmark: 27 walls with 35 doors in the paper's five categories, from a seed."""

from __future__ import annotations

import logging
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from mission.bench.walls import occlusion, semi_open, simple, specular, very_complex
from mission.bench.walls.building import Building, build
from mission.bench.walls.fitting import NoPlaceError, fit_occluders
from mission.bench.walls.hidden import Hidden, scanner_origins
from mission.bench.walls.plans import RoomPlan

logger = logging.getLogger(__name__)

_PLANS: Mapping[str, Callable[[np.random.Generator], tuple[RoomPlan, ...]]] = MappingProxyType(
    {
        "simple": simple.plans,
        "occlusion": occlusion.plans,
        "specular": specular.plans,
        "semi-open": semi_open.plans,
        "very complex": very_complex.plans,
    }
)
CATEGORIES: tuple[str, ...] = tuple(_PLANS)
_ATTEMPTS = 10
"""To plan a category so that all its doors are fair; about one plan in eight with occlusion fails."""


@dataclass(frozen=True)
class BenchDoor:
    """One judged door; a double door is one."""

    bodies: tuple[str, ...]
    """Names of the bodies of its leaves, left to right."""
    qpos: tuple[float, ...]
    """Joint position of each leaf at which it stands in the XML [rad; m for a slide]."""
    panel_hidden: float
    """Share of the panel that furniture hides from all scan places, 0..1."""
    frame_hidden: float
    """Likewise of the frame's left, upper and right side together."""
    sides_hidden: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """And of each."""
    corners_seen: bool = True
    """Whether for each upper corner there is a scan place that sees the last 15 cm of both sides that meet in it."""


@dataclass(frozen=True)
class BenchWall:
    """One judged wall face."""

    name: str
    """Such as "specular 1.2"."""
    category: str
    origin: tuple[float, float, float]
    """Bottom left corner as seen from inside, in world [m]."""
    end: tuple[float, float, float]
    """Bottom right corner [m]."""
    height: float
    """[m]"""
    doors: tuple[BenchDoor, ...]
    """Left to right."""


@dataclass(frozen=True)
class BenchRoom:
    """One generated room: up to four judged walls round a few scan places. Its floor is at z = 0."""

    name: str
    """Such as "specular 1"."""
    xml: str
    """Complete MJCF, without a robot; loaded as it is, all doors stand as they should."""
    assets: Mapping[str, bytes]
    """PNG bytes of the textures by the file names in the XML."""
    scan_places: tuple[tuple[float, float, float], ...]
    """x, y [m] and heading [rad] of the robot's base in world."""
    walls: tuple[BenchWall, ...]


def rooms(seed: int, categories: Collection[str] | None = None) -> list[BenchRoom]:
    """Generate the benchmark.

    Args:
        seed: varies sizes, colours, pictures, placement and clutter; the same seed gives the same rooms, category by
            category.
        categories: only these of `CATEGORIES`; None for all.

    Raises:
        ValueError: there is no such category.
    """
    unknown = sorted(set(categories or ()) - set(CATEGORIES))
    if unknown:
        raise ValueError(f"no category {unknown[0]!r}; there are: {', '.join(CATEGORIES)}")
    found = []
    for number, category in enumerate(CATEGORIES):
        if categories is None or category in categories:
            found += _fair_rooms(category, np.random.default_rng([seed, number]))
    return found


def _fair_rooms(category: str, rng: np.random.Generator) -> list[BenchRoom]:
    """A category's rooms, planned anew where furniture would hide too much of a door wherever it stood."""
    for _ in range(_ATTEMPTS - 1):
        try:
            return _rooms(category, rng)
        except NoPlaceError as error:
            logger.info("the %s rooms are planned anew: %s", category, error)
    return _rooms(category, rng)


def _rooms(category: str, rng: np.random.Generator) -> list[BenchRoom]:
    return [_room(plan, f"{category} {k}", rng) for k, plan in enumerate(_PLANS[category](rng), start=1)]


def _room(plan: RoomPlan, name: str, rng: np.random.Generator) -> BenchRoom:
    building = build(plan, rng)
    places = _scan_places(building)
    hidden = fit_occluders(building, scanner_origins(places))
    building.kit.spec.compile()  # with the occluders where they now are
    walls: list[BenchWall] = []
    for number, wall in enumerate(plan.walls):
        if not wall.is_judged:
            continue
        doors = tuple(
            _door(building.leaves[number, k], door.openings, hidden[number, k]) for k, door in enumerate(wall.doors)
        )
        start, end = building.to_world(plan.corners[[number, (number + 1) % len(plan.corners)]]).tolist()
        corners = (start[0], start[1], 0.0), (end[0], end[1], 0.0)
        walls.append(BenchWall(f"{name}.{len(walls) + 1}", plan.category, *corners, plan.height, doors))
    return BenchRoom(name, building.kit.spec.to_xml(), dict(building.kit.assets), places, tuple(walls))


def _door(bodies: tuple[str, ...], qpos: tuple[float, ...], hidden: Hidden) -> BenchDoor:
    return BenchDoor(bodies, qpos, hidden.panel, hidden.frame, hidden.sides, hidden.corners_seen)


def _scan_places(building: Building) -> tuple[tuple[float, float, float], ...]:
    places = np.array(building.plan.scan_places)
    spots = building.to_world(places[:, :2])
    return tuple(
        (float(x), float(y), float(yaw + building.turn)) for (x, y), yaw in zip(spots, places[:, 2], strict=True)
    )
