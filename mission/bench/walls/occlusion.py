"""Scenes with occlusion: furniture, curtains and plants hide part of panels and frames."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from mission.bench.walls import furniture
from mission.bench.walls.filling import judged_wall
from mission.bench.walls.finishes import seed
from mission.bench.walls.fixtures import Cupboard
from mission.bench.walls.interiors import lay_out, random_door, room
from mission.bench.walls.plans import DoorPlan, Maker, Occluder, RoomPlan, Site, Thing, WallPlan

_KINDS = ("cupboard", "shelf", "curtain", "plant", "sofa", "screen", "boxes")


def plans(rng: np.random.Generator) -> tuple[RoomPlan, ...]:
    """7 doors in 6 walls of two rooms, each behind something else, some hidden about as much as the paper's most."""
    kinds = rng.permutation(_KINDS).tolist()
    shares = rng.uniform(0.08, 0.33, len(kinds))
    shares[[k for k, kind in enumerate(kinds) if kind in ("cupboard", "curtain")]] = rng.uniform(0.30, 0.38, 2)
    given = list(zip(kinds, shares.tolist(), strict=True))
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
        placed = lay_out(rng, doors, site.length, margin=0.75)
        occluders = tuple(_occluder(rng, kind, share, placed, number) for number, (kind, share) in enumerate(given))
        return replace(judged_wall(rng, site, placed, busy=0.3), occluders=occluders)

    return make


def _occluder(rng: np.random.Generator, kind: str, share: float, doors: tuple[DoorPlan, ...], number: int) -> Occluder:
    door = doors[number]
    thing, away = _thing(rng, kind, door)
    return Occluder(number, away, thing, share, most=1.0 if kind == "sofa" else 0.48)


def _thing(rng: np.random.Generator, kind: str, door: DoorPlan) -> tuple[Thing, float]:
    """The thing and how far its back is from the wall [m]."""
    near = float(rng.uniform(0.05, 0.12))
    match kind:
        case "cupboard":
            size = float(rng.uniform(0.7, 0.9)), float(rng.uniform(1.8, 2.1)), float(rng.uniform(0.4, 0.5))
            return Cupboard(*size, furniture.wood_colour(rng), plinth=0.06), near
        case "shelf":
            size = float(rng.uniform(0.7, 0.9)), float(rng.uniform(1.6, 2.0)), float(rng.uniform(0.28, 0.35))
            return furniture.Shelf(*size, furniture.wood_colour(rng), seed(rng)), near
        case "curtain":
            height = door.height + 0.12
            return furniture.Curtain(float(rng.uniform(0.5, 0.7)), height, 1.0, furniture.fabric(rng)), 0.02
        case "plant":
            return furniture.Plant(
                float(rng.uniform(1.5, 1.9)), float(rng.uniform(0.3, 0.36)), seed(rng), leaves=70
            ), 0.02
        case "sofa":
            return furniture.Sofa(float(rng.uniform(1.2, 1.5)), furniture.fabric(rng)), near
        case "screen":
            width, height = float(rng.uniform(0.8, 1.1)), float(rng.uniform(1.5, 1.7))
            return furniture.Screen(width, height, furniture.screen_cloth(rng)), 0.02
    return furniture.Boxes(float(rng.uniform(0.6, 0.8)), float(rng.uniform(1.0, 1.5)), seed(rng)), near
