"""Scenes with semi-open doors: 1 % to 70 % closed, inward and outward, hinged left and right, and one that slides."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Literal

import numpy as np

from mission.bench.walls.filling import judged_wall
from mission.bench.walls.interiors import lay_out, random_door, room
from mission.bench.walls.plans import NO_FRAME, DoorPlan, Maker, RoomPlan, Side, Site, WallPlan

DoorMaker = Callable[[np.random.Generator, Site], DoorPlan]

_OPEN = np.pi / 2


def plans(rng: np.random.Generator) -> tuple[RoomPlan, ...]:
    """5 doors in 4 walls of a room: all four kinds of hinged doors and a sliding one."""
    closings = [rng.uniform(0.01, 0.05), rng.uniform(0.1, 0.35), rng.uniform(0.35, 0.6), rng.uniform(0.6, 0.7)]
    angles = rng.permutation([(1 - closing) * _OPEN for closing in closings]).tolist()
    first: Side = "left" if rng.random() < 0.5 else "right"
    other: Side = "right" if first == "left" else "left"
    # of two doors in one wall none swings into the room
    outward = [_hinged(first, "outward", angles[0]), _hinged(other, "outward", angles[1])]
    inward = [[_hinged(first, "inward", angles[2])], [_hinged(other, "inward", angles[3])]]
    return (room(rng, "semi-open", [_wall(outward), *map(_wall, inward), _wall([_sliding])]),)


def _wall(kinds: Sequence[DoorMaker]) -> Maker:
    def make(rng: np.random.Generator, site: Site) -> WallPlan:
        doors = [kind(rng, site) for kind in kinds]
        margin = 0.9 if any(door.slides or door.opens == "inward" for door in doors) else 0.5
        placed = lay_out(rng, doors, site.length, margin=margin)
        wall = replace(judged_wall(rng, site, placed, busy=0.4), stood=())
        if doors[0].slides:
            wall = replace(wall, thickness=0.16, hung=(), behind="corridor")
        return replace(wall, behind="room" if wall.behind == "yard" else wall.behind)

    return make


def _hinged(hinge: Side, opens: Literal["inward", "outward"], angle: float) -> DoorMaker:
    def door(rng: np.random.Generator, site: Site) -> DoorPlan:
        plain = random_door(rng, site.paint)
        return replace(
            plain, hinge=hinge, opens=opens, openings=(angle,), panel="flat" if plain.panel == "glazed" else plain.panel
        )

    return door


def _sliding(rng: np.random.Generator, site: Site) -> DoorPlan:
    """In a pocket in the wall, or along its inner or outer face."""
    door = random_door(rng, site.paint)
    recess = (0.06, -0.045, 0.165)[rng.integers(3)]
    opening = float(rng.uniform(0.3, 0.7)) * door.width
    return replace(door, slides=True, frame=NO_FRAME, recess=recess, openings=(opening,), gap=-0.01, panel="flat")
