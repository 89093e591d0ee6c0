"""Scenes with occlusion: furniture, curtains and plants hide part of panels and frames."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType

import numpy as np

from mission.bench.walls import furniture
from mission.bench.walls.filling import judged_wall
from mission.bench.walls.finishes import seed
from mission.bench.walls.fitting import CORNER
from mission.bench.walls.fixtures import Cupboard
from mission.bench.walls.interiors import lay_out, random_door, room
from mission.bench.walls.plans import DoorPlan, Maker, Occluder, RoomPlan, Site, Thing, WallPlan

_SHARES: Mapping[str, tuple[float, float]] = MappingProxyType(
    {
        "locker": (0.30, 0.37),
        "curtain": (0.30, 0.37),
        "shelf": (0.15, 0.36),
        "sofa": (0.15, 0.36),
        "screens": (0.26, 0.35),
        "piles": (0.26, 0.35),
        "plant": (0.08, 0.18),
    }
)
"""Of the panel that each kind of occluder is to hide."""
_TALL = ("locker", "curtain")
"""They stand clear of the frame's uprights."""
_PAIRS = ("screens", "piles")
"""One stands before each of the frame's uprights; what stands alone hides at most one of them."""
_MORE = (-0.03, 0.03, 0.09)
"""Width in several sizes, beyond what would hide the share if the thing touched the wall: scanners see round it [m]."""
_MARGIN = CORNER + 0.25
"""Beside and between doors, for what reaches past their frames [m]."""


def plans(rng: np.random.Generator) -> tuple[RoomPlan, ...]:
    """7 doors in 6 walls of two rooms, each behind something else, some hidden about as much as the paper's most."""
    kinds = rng.permutation(list(_SHARES)).tolist()
    given = [(kind, float(rng.uniform(*_SHARES[kind]))) for kind in kinds]
    first = room(rng, "occlusion", [_wall(given[:2]), _wall(given[2:3]), _wall(given[3:4])])
    second = room(rng, "occlusion", [_wall(given[4:5]), _wall(given[5:6]), _wall(given[6:])])
    return _with_clear_walls(first), _with_clear_walls(second)


def _with_clear_walls(plan: RoomPlan) -> RoomPlan:
    """Nothing but the occluders stands at the walls: they could meet in a corner."""
    return replace(plan, walls=tuple(replace(wall, stood=()) for wall in plan.walls))


def _wall(given: list[tuple[str, float]]) -> Maker:
    """A wall with a door for each kind of occluder and the share that it is to hide."""

    def make(rng: np.random.Generator, site: Site) -> WallPlan:
        doors = [replace(random_door(rng, site.paint), panel="flat") for _ in given]
        placed = lay_out(rng, doors, site.length, margin=_MARGIN)
        occluders = tuple(_occluder(rng, kind, share, placed, number) for number, (kind, share) in enumerate(given))
        return replace(judged_wall(rng, site, placed, busy=0.3), occluders=occluders)

    return make


def _occluder(rng: np.random.Generator, kind: str, share: float, placed: Sequence[DoorPlan], number: int) -> Occluder:
    frame_share = 0.06 if kind in _TALL else 0.45 if kind in _PAIRS else 0.22
    away = 0.02 if kind in ("curtain", "plant") else float(rng.uniform(0.06, 0.10))
    return Occluder(number, away, _sizes(rng, kind, share, placed[number]), share, frame_share)


def _sizes(rng: np.random.Generator, kind: str, share: float, door: DoorPlan) -> tuple[Thing, ...]:
    """Things large enough to hide the share of the panel."""
    low = float(rng.uniform(0.52, 0.57)) * door.height  # of a frame's upright 60 % may be hidden
    wide = [share * door.width + more for more in _MORE]
    if kind in _PAIRS:
        wide = [share * door.width * door.height / low + more for more in _MORE]
        return _pairs(rng, kind, (door.width, low), wide)
    match kind:
        case "locker":
            height, depth = float(rng.uniform(0.9, 1.04)) * door.height, float(rng.uniform(0.28, 0.35))
            finish = furniture.wood_colour(rng)
            return tuple(Cupboard(width, height, depth, finish, plinth=0.06) for width in wide)
        case "curtain":
            cloth = furniture.fabric(rng)
            return tuple(furniture.Curtain(width, door.height + 0.12, 1.0, cloth) for width in wide)
        case "shelf":
            width, depth = float(rng.uniform(0.7, 0.9)), float(rng.uniform(0.28, 0.35))
            return (furniture.Shelf(width, low, depth, furniture.wood_colour(rng), seed(rng)),)
        case "plant":
            height, spread = float(rng.uniform(1.5, 1.75)), float(rng.uniform(0.33, 0.38))
            return (furniture.Plant(height, spread, seed(rng), leaves=110),)
    return (furniture.Sofa(float(rng.uniform(1.2, 1.5)), furniture.fabric(rng)),)


def _pairs(rng: np.random.Generator, kind: str, door: tuple[float, float], wide: Sequence[float]) -> tuple[Thing, ...]:
    """Low things on both sides of a doorway, so high as given, that stand before so much of its width together."""
    (width, height), beside = door, float(rng.uniform(0.2, 0.25))
    cloth, seeds = furniture.screen_cloth(rng), (seed(rng), seed(rng))
    pairs = []
    for before in wide:
        left, right = (
            furniture.Screen(before / 2 + beside, height, cloth)
            if kind == "screens"
            else furniture.Boxes(before / 2 + beside, height, number)
            for number in seeds
        )
        pairs.append(furniture.Pair(left, right, width - before))
    return tuple(pairs)
