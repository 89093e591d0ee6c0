"""Very complex scenes: doors in their wall's plane and nearly its colour, tiles, panelling, glass, baits."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from mission.bench.walls import finishes, textures
from mission.bench.walls.filling import judged_wall
from mission.bench.walls.finishes import FROSTED, GLASS, WALL_PAINTS, WOODS, Finish
from mission.bench.walls.fixtures import Cupboard
from mission.bench.walls.interiors import lay_out, random_door, room
from mission.bench.walls.plans import NO_FRAME, DoorPlan, Hung, Maker, RoomPlan, Site, Stood, WallPlan, free_spans

LEAST_DIFFERENCE = (0.0509, 0.0196, 0.0118)
"""In red, green and blue between door and wall, in parts of full scale (section 7.2.2)."""
WALL_VARIATION = 0.28
"""Of colour within one wall, in parts of full scale (section 7.2.2)."""


def plans(rng: np.random.Generator) -> tuple[RoomPlan, ...]:
    """9 doors in 7 walls of two rooms."""
    first = room(rng, "very complex", [_coplanar(2), _stained, _tiled, _glazed(1)])
    second = room(rng, "very complex", [_glazed(2) if rng.random() < 0.5 else _coplanar(2), _panelled, _baited])
    return first, second


def flush(rng: np.random.Generator, wall: Finish, *, more: float = 0.0, double: bool = False) -> DoorPlan:
    """A frameless door in the wall's plane; its colour differs by the paper's least, and by so much more in all."""
    sign = -1.0 if wall.colour[0] > 0.5 else 1.0
    r, g, b = (sign * (part + more) for part in LEAST_DIFFERENCE)
    finish = finishes.shifted(wall, (r, g, b))
    door = random_door(rng, wall, double=double)
    return replace(door, finish=finish, frame=NO_FRAME, recess=0.0, panel="flat", opens="inward")


def _coplanar(count: int) -> Maker:
    def make(rng: np.random.Generator, site: Site) -> WallPlan:
        doors = [flush(rng, site.paint, more=more * float(rng.random())) for more in (0.0, 0.05)[:count]]
        return judged_wall(rng, site, lay_out(rng, doors, site.length), window=True, busy=0.4)

    return make


def _stained(rng: np.random.Generator, site: Site) -> WallPlan:
    """Uneven paint, and a door in its mean colour or a little off."""
    colour = finishes.jittered(rng, (0.72, 0.68, 0.58), 0.06)
    finish = Finish(colour, textures.mottled, WALL_VARIATION, (site.length, site.height), finishes.seed(rng))
    even = finishes.plaster(rng, colour)
    door = replace(flush(rng, even, more=0.02), recess=float(rng.uniform(0.0, 0.012)))
    return judged_wall(rng, site, lay_out(rng, [door], site.length), finish=finish, busy=0.3)


def _tiled(rng: np.random.Generator, site: Site) -> WallPlan:
    """Tiles of slightly different colours, and a plain door in their plane."""
    colour = finishes.pick(rng, WALL_PAINTS)
    period = 4 * float(rng.uniform(0.15, 0.3))
    variation = float(rng.uniform(0.06, 0.12))
    finish = finishes.glossy(rng, Finish(colour, textures.tiles, variation, (period, period), finishes.seed(rng)))
    door = flush(rng, finishes.plaster(rng, colour, 0.02), more=float(rng.uniform(0.0, 0.08)))
    return judged_wall(rng, site, lay_out(rng, [door], site.length), finish=finish, busy=0.3)


def _glazed(count: int) -> Maker:
    """Doors with windows in them, otherwise like the wall, and something in front of it."""

    def make(rng: np.random.Generator, site: Site) -> WallPlan:
        doors = []
        for _ in range(count):
            door = flush(rng, site.paint, more=float(rng.uniform(0.02, 0.1)))
            door = replace(
                door, panel="glazed" if rng.random() < 0.6 else "vision", recess=float(rng.uniform(0.0, 0.01))
            )
            doors.append(replace(door, glass=GLASS if rng.random() < 0.5 else FROSTED))
        return judged_wall(rng, site, lay_out(rng, doors, site.length), busy=0.8)

    return make


def _panelled(rng: np.random.Generator, site: Site) -> WallPlan:
    """Wooden panelling with a double door of the same boards."""
    colour = finishes.pick(rng, WOODS)
    pitch = 6 * float(rng.uniform(0.16, 0.3))
    finish = Finish(colour, textures.boards, 0.12, (pitch, 2.6), finishes.seed(rng))
    door = flush(rng, finish, more=float(rng.uniform(0.0, 0.02)), double=True)
    return replace(judged_wall(rng, site, lay_out(rng, [door], site.length), finish=finish, busy=0.15), skirting=None)


def _baited(rng: np.random.Generator, site: Site) -> WallPlan:
    """Cupboards in the wall's colour beside a door that hardly differs from it."""
    door = flush(rng, site.paint, more=float(rng.uniform(0.0, 0.04)))
    placed = lay_out(rng, [door], site.length, margin=0.5)
    wall = judged_wall(rng, site, placed, busy=0.0)
    cupboards = _cupboards(rng, site, placed)
    above = tuple(
        Hung(stood.x, 2.15, Cupboard(stood.thing.width, 0.35, 0.3, site.paint))
        for stood in cupboards[:1]
        if site.height > 2.6
    )
    return replace(wall, stood=tuple(cupboards), hung=wall.hung + above)


def _cupboards(rng: np.random.Generator, site: Site, doors: Sequence[DoorPlan]) -> list[Stood]:
    found = []
    for low, high in free_spans([door.reach for door in doors], site.length, 1.2):
        low = max(low, 0.95)
        depth = float(rng.uniform(0.3, 0.5))
        width = min(float(rng.uniform(0.55, 1.2)), high - low - 2 * 0.35)
        if width < 0.5:
            continue
        x = float(rng.uniform(low + 0.35 + width / 2, high - 0.35 - width / 2))
        found.append(Stood(x, 0.0, Cupboard(width, float(rng.uniform(1.75, 2.0)), depth, site.paint, plinth=0.08)))
    return found
