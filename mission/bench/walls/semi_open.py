"""Scenes with semi-open doors: inward and outward, hinged left and right, and one that slides.

The paper's semi-open doors have "closing percentages from 1 % to 70 %" (section 7.2.2), which can be read in two ways:
as written, a door 1 % to 70 % closed stands 89 to 27 deg open; as the part by which it is open, 1 to 63 deg. Its
simulated doors (Table 3) stand at 2.25 and 3.54 deg, too. So three of the hinged doors here spread over the first
reading, and one is open by so little that only the second one holds.
"""

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
LITTLE_OPEN = (np.radians(3.0), np.radians(25.0))
"""How far the door that is hardly open stands open [rad]."""
_RECESSES = (0.06, -0.045, 0.165)
"""Of a sliding leaf's face: in a pocket, before the wall's inner face, behind its outer one [m]."""


def plans(rng: np.random.Generator) -> tuple[RoomPlan, ...]:
    """5 doors in 4 walls of a room: all four kinds of hinged doors and a sliding one."""
    closings = [rng.uniform(0.01, 0.05), rng.uniform(0.15, 0.55), rng.uniform(0.6, 0.7)]
    little = np.exp(rng.uniform(*np.log(LITTLE_OPEN)))  # as many below 9 deg as above
    angles = rng.permutation([*((1 - closing) * _OPEN for closing in closings), little]).tolist()
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
    recess = _RECESSES[rng.integers(3)]
    opening = float(rng.uniform(0.3, 0.7)) * door.width
    return replace(door, slides=True, frame=NO_FRAME, recess=recess, openings=(opening,), gap=-0.01, panel="flat")
