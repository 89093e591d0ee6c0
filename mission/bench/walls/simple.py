"""Simple scenes: ordinary doors, single and double, with posters, sockets, signs and windows beside them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from mission.bench.walls import fixtures
from mission.bench.walls.filling import judged_wall
from mission.bench.walls.interiors import lay_out, random_door, room
from mission.bench.walls.plans import DoorPlan, Maker, RoomPlan, Site, WallPlan


def plans(rng: np.random.Generator) -> tuple[RoomPlan, ...]:
    """10 doors in 7 walls of two rooms, at least two of them double."""
    first = room(rng, "simple", [_wall(2), _wall(2), _wall(1, double=True), _wall(1)])
    second = room(rng, "simple", [_wall(2), _wall(1, double=True), _wall(1)])
    return first, second


def _wall(count: int, *, double: bool = False) -> Maker:
    def make(rng: np.random.Generator, site: Site) -> WallPlan:
        doors = [_noticed(rng, random_door(rng, site.paint, double=double)) for _ in range(count)]
        placed = lay_out(rng, doors, site.length)
        return judged_wall(rng, site, placed, window=bool(rng.random() < 0.5))

    return make


def _noticed(rng: np.random.Generator, door: DoorPlan) -> DoorPlan:
    """Now and then with a notice or a sign on it."""
    if door.panel in ("glazed", "vision") or rng.random() < 0.65:
        return door
    thing = fixtures.random_notice(rng) if rng.random() < 0.5 else fixtures.random_sign(rng)
    return replace(door, notices=((float(rng.uniform(0.4, 0.6)), float(rng.uniform(1.45, 1.65)), thing),))
