"""How builders and users fill a wall round its doors: windows, radiators, switches, posters, furniture."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from mission.bench.walls import fixtures, furniture
from mission.bench.walls.finishes import WHITE, Finish
from mission.bench.walls.plans import (
    DoorPlan,
    Hung,
    Site,
    Stood,
    Thing,
    WallPlan,
    WindowPlan,
    free_spans,
)

_CORNER = 0.95
"""Kept free at the left end of each wall, so that furniture does not meet round the corner [m]."""
_KINDS = ("poster", "board", "extinguisher", "socket", "tall", "low", "clock")
_MIX = (0.3, 0.1, 0.08, 0.16, 0.13, 0.18, 0.05)
"""How often each comes."""


def judged_wall(
    rng: np.random.Generator,
    site: Site,
    doors: Sequence[DoorPlan],
    *,
    finish: Finish | None = None,
    window: bool = False,
    busy: float = 1.0,
) -> WallPlan:
    """A wall with doors already placed, and the usual things between them.

    Args:
        rng: source of chance.
        site: where.
        doors: left to right.
        finish: of the wall; None for the room's paint.
        window: whether it gets one if there is room.
        busy: how full the rest is, 0 to 1.
    """
    taken = [door.reach for door in doors]
    windows = _window(rng, taken, site) if window else ()
    taken = taken + [(w.left - 0.1, w.left + w.width + 0.1) for w in windows]
    behind = rng.choice(["corridor", "room", "yard"], p=[0.5, 0.35, 0.15]).item()
    wall = WallPlan(finish or site.paint, _thickness(rng), tuple(doors), windows, skirting=WHITE, behind=behind)
    wall = _filled(rng, wall, free_spans(taken, site.length, 0.25), busy)
    return replace(wall, hung=wall.hung + _at_doors(rng, doors, site) + _below(windows))


def blank_wall(rng: np.random.Generator, site: Site) -> WallPlan:
    """A wall without doors, not judged."""
    windows = _window(rng, [], site) if site.length > 2.5 and rng.random() < 0.7 else ()
    spans = free_spans([(w.left - 0.1, w.left + w.width + 0.1) for w in windows], site.length, 0.25)
    wall = WallPlan(
        site.paint,
        _thickness(rng),
        windows=windows,
        hung=_below(windows),
        skirting=WHITE,
        behind="yard",
        is_judged=False,
    )
    return _filled(rng, wall, spans, 1.0)


def _thickness(rng: np.random.Generator) -> float:
    """Of a wall [m]."""
    return float(rng.uniform(0.12, 0.28))


def _window(rng: np.random.Generator, taken: Sequence[tuple[float, float]], site: Site) -> tuple[WindowPlan, ...]:
    spans = [(low + 0.25, high - 0.25) for low, high in free_spans(taken, site.length, 1.3)]
    if not spans:
        return ()
    low, high = max(spans, key=lambda span: span[1] - span[0])
    width = min(float(rng.uniform(0.8, 1.6)), high - low)
    bottom = float(rng.uniform(0.9, 1.1))
    height = min(float(rng.uniform(0.9, 1.3)), site.height - 0.3 - bottom)
    left = float(rng.uniform(low, high - width))
    return (WindowPlan(left, width, bottom, height, WHITE, mullions=int(width > 1.1)),)


def _below(windows: Sequence[WindowPlan]) -> tuple[Hung, ...]:
    return tuple(Hung(w.left + w.width / 2, 0.45, fixtures.Radiator(w.width * 0.9, 0.6)) for w in windows)


def _at_doors(rng: np.random.Generator, doors: Sequence[DoorPlan], site: Site) -> tuple[Hung, ...]:
    """Light switches beside doors and signs over them."""
    hung = []
    for k, door in enumerate(doors):
        low, high = door.reach
        x = high + 0.11 if door.hinge == "left" else low - 0.11
        others = [other.reach for other in doors if other is not doors[k]]
        if 0.1 < x < site.length - 0.1 and not any(a - 0.1 < x < b + 0.1 for a, b in others) and rng.random() < 0.7:
            hung.append(Hung(x, 1.12, fixtures.Socket(1)))
        if site.height - door.height > 0.5 and rng.random() < 0.35:
            hung.append(Hung((low + high) / 2, door.height + 0.32, fixtures.random_sign(rng)))
    return tuple(hung)


def _filled(rng: np.random.Generator, wall: WallPlan, spans: Sequence[tuple[float, float]], busy: float) -> WallPlan:
    """Things on and before the free stretches of a wall, one after the other from the left."""
    hung, stood = list(wall.hung), list(wall.stood)
    for low, high in spans:
        x = low + 0.22
        while x < high - 0.3:
            if rng.random() > busy:
                x += 0.6
                continue
            kind = rng.choice(_KINDS, p=_MIX)
            thing, z = _hanging(rng, kind.item())
            if thing is not None:
                if x + thing.width < high - 0.22:
                    hung.append(Hung(x + thing.width / 2, z, thing))
                    x += thing.width
            else:
                standing = furniture.random_tall(rng) if kind == "tall" else furniture.random_low(rng)
                start = max(x, _CORNER, low + 0.1 + 0.5 * standing.depth)
                if start + standing.width < high - 0.1 - 0.5 * standing.depth:
                    stood.append(Stood(start + standing.width / 2, 0.03, standing))
                    x = start + standing.width
            x += float(rng.uniform(0.15, 0.5))
    return replace(wall, hung=tuple(hung), stood=tuple(stood))


def _hanging(rng: np.random.Generator, kind: str) -> tuple[Thing | None, float]:
    """A thing for the wall and the height of its middle; None for kinds that stand."""
    match kind:
        case "poster":
            return fixtures.random_poster(rng), float(rng.uniform(1.35, 1.7))
        case "board":
            return fixtures.random_board(rng), float(rng.uniform(1.4, 1.6))
        case "extinguisher":
            return fixtures.Extinguisher(), 0.95
        case "socket":
            return fixtures.Socket(int(rng.integers(1, 4))), 0.32
        case "clock":
            return fixtures.Clock(), 2.05
    return None, 0.0
