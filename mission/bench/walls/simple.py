"""Simple scenes: ordinary doors, single and double, posters, sockets, signs and windows, a wall of several colours."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from mission.bench.walls import finishes, fixtures
from mission.bench.walls.filling import judged_wall
from mission.bench.walls.finishes import DADO_PAINTS
from mission.bench.walls.interiors import lay_out, random_door, room
from mission.bench.walls.plans import Band, DoorPlan, Maker, RoomPlan, Site, WallPlan


def plans(rng: np.random.Generator) -> tuple[RoomPlan, ...]:
    """10 doors in 7 walls of two rooms, at least two of them double; one wall is painted in several colours."""
    first = room(rng, "simple", [_wall(2), _wall(2), _wall(1, double=True), _wall(1)])
    second = room(rng, "simple", [_wall(2), _wall(1, double=True), _banded])
    return first, second


def _wall(count: int, *, double: bool = False) -> Maker:
    def make(rng: np.random.Generator, site: Site) -> WallPlan:
        doors = [_noticed(rng, random_door(rng, site.paint, double=double)) for _ in range(count)]
        placed = lay_out(rng, doors, site.length)
        return judged_wall(rng, site, placed, window=bool(rng.random() < 0.5))

    return make


def _banded(rng: np.random.Generator, site: Site) -> WallPlan:
    """A wall with a door and a dado, a stripe at the height of hands, or both."""
    own = rng.spawn(1)[0]  # what comes after does not depend on the paint
    wall = _wall(1)(rng, site)
    colour = finishes.unlike(own, DADO_PAINTS, wall.doors[0].finish.colour, 0.12)
    height = float(own.uniform(1.0, 1.3))
    stripe = Band(height, height + float(own.uniform(0.06, 0.2)), finishes.plaster(own, colour, 0.03))
    dado = Band(0.0, height, finishes.plaster(own, finishes.mixed(colour, site.paint.colour), 0.04))
    bands = ((replace(stripe, bottom=0.0),), (stripe,), (dado, stripe))
    return replace(wall, bands=bands[own.integers(3)])


def _noticed(rng: np.random.Generator, door: DoorPlan) -> DoorPlan:
    """Now and then with a notice or a sign on it."""
    if door.panel in ("glazed", "vision") or rng.random() < 0.65:
        return door
    thing = fixtures.random_notice(rng) if rng.random() < 0.5 else fixtures.random_sign(rng)
    return replace(door, notices=((float(rng.uniform(0.4, 0.6)), float(rng.uniform(1.45, 1.65)), thing),))
