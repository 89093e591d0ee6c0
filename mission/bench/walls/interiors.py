"""What the categories share: outlines, ordinary doors, and how builders and users fill the rest of a wall."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mission.bench.walls import finishes, fixtures, floor_plans, furniture
from mission.bench.walls.finishes import BRASS, DOOR_PAINTS, FROSTED, STEEL, WALL_PAINTS, WHITE, WOODS, Finish
from mission.bench.walls.hidden import scanner_origins
from mission.bench.walls.plans import (
    NO_FRAME,
    DoorPlan,
    Frame,
    Hung,
    RoomPlan,
    Stood,
    Thing,
    WallPlan,
    WindowPlan,
    free_spans,
)
from mission.bench.walls.shell import skirting_finish

_LEAF_WIDTHS = (0.62, 0.72, 0.82, 0.92, 1.02)
_CORNER = 0.95
"""Kept free at the left end of each wall, so that furniture does not meet round the corner [m]."""


@dataclass(frozen=True, eq=False)
class Site:
    """Where a wall is to be built."""

    length: float
    height: float
    paint: Finish
    """Of the room."""
    feet: tuple[float, ...]
    """Places along the wall that the scanner stands square to [m]."""


Maker = Callable[[np.random.Generator, Site], WallPlan]


def room(rng: np.random.Generator, category: str, makers: Sequence[Maker], paint: Finish | None = None) -> RoomPlan:
    """A room of a category whose judged walls the makers build, those that need most room first.

    Args:
        rng: source of chance.
        category: of the judged walls.
        makers: one for each judged wall, three or four.
        paint: of its walls; None for any.
    """
    corners = _outline(rng, len(makers))
    height = float(rng.uniform(2.55, 3.0))
    lengths = floor_plans.side_lengths(corners)
    judged = np.sort(np.argsort(-lengths, kind="stable")[: len(makers)])
    order = judged[np.argsort(-lengths[judged], kind="stable")]
    count = int(rng.choice([2, 3, 4], p=[0.2, 0.5, 0.3]))
    middle = _middle_table(rng, corners) if count > 2 and rng.random() < 0.4 else ()
    places = floor_plans.scan_places(
        *(rng, corners, count), seen=_watched(corners, judged), avoid=[(x, y, 1.25) for x, y, *_ in middle]
    )
    paint = paint or finishes.plaster(rng, finishes.pick(rng, WALL_PAINTS))
    skirting, tall = skirting_finish(rng), float(rng.uniform(0.06, 0.11))
    walls: list[WallPlan] = []
    for side in range(len(corners)):
        site = Site(float(lengths[side]), height, paint, _feet(corners, side, scanner_origins(places)))
        if side in judged:
            walls.append(makers[int(np.flatnonzero(order == side)[0])](rng, site))
        else:
            walls.append(blank_wall(rng, site))
    walls = [replace(wall, skirting=wall.skirting and skirting, skirting_height=tall) for wall in walls]
    ceiling = finishes.plain((0.92, 0.92, 0.91))
    return RoomPlan(category, corners, height, tuple(walls), finishes.floor(rng), ceiling, places, middle)


def random_door(rng: np.random.Generator, wall: Finish, *, double: bool = False) -> DoorPlan:
    """Any ordinary closed door that differs from its wall in colour or by its frame; its place is left open."""
    width = float(rng.uniform(1.25, 1.75) if double else rng.choice(_LEAF_WIDTHS) + rng.uniform(-0.02, 0.03))
    height = float(rng.choice([1.98, 2.03, 2.10, 2.20]) + rng.uniform(-0.02, 0.02))
    finish = door_finish(rng, wall)
    frame = random_frame(rng, finish)
    recess = {"none": rng.uniform(0.012, 0.06), "architrave": rng.uniform(0.0, 0.04), "block": rng.uniform(0.0, 0.02)}
    panel = rng.choice(["flat", "mouldings", "vision", "glazed"], p=[0.5, 0.25, 0.15, 0.1])
    handles = ["lever", "bar", "push bar"] if double else ["lever", "lever", "knob", "bar"]
    return DoorPlan(
        left=0.0,
        width=width,
        height=height,
        finish=finish,
        frame=frame,
        recess=float(recess[frame.style]),
        gap=float(rng.uniform(0.002, 0.004)),
        leaves=2 if double else 1,
        hinge="left" if rng.random() < 0.5 else "right",
        opens="inward" if rng.random() < 0.65 else "outward",
        openings=(0.0, 0.0) if double else (0.0,),
        panel=panel.item(),
        glass=FROSTED,
        handle=rng.choice(handles).item(),
        metal=STEEL if rng.random() < 0.75 else BRASS,
    )


def door_finish(rng: np.random.Generator, wall: Finish) -> Finish:
    """Veneer or paint, unlike the wall."""
    if rng.random() < 0.45:
        return finishes.wood(rng, finishes.unlike(rng, WOODS, wall.colour))
    paint = finishes.plain(finishes.unlike(rng, DOOR_PAINTS, wall.colour, 0.12))
    return finishes.glossy(rng, paint) if rng.random() < 0.3 else paint


def random_frame(rng: np.random.Generator, door: Finish) -> Frame:
    """A frame of the door's colour, white, or grey; or none."""
    style = rng.choice(["architrave", "block", "none"], p=[0.5, 0.25, 0.25]).item()
    if style == "none":
        return NO_FRAME
    grey = finishes.plain(finishes.jittered(rng, (0.5, 0.5, 0.5), 0.2))
    finish = (door, WHITE, grey)[rng.choice(3, p=[0.5, 0.3, 0.2])]
    if style == "architrave":
        return Frame("architrave", float(rng.uniform(0.05, 0.09)), float(rng.uniform(0.010, 0.02)), finish)
    return Frame("block", float(rng.uniform(0.04, 0.07)), float(rng.uniform(0.004, 0.012)), finish)


def lay_out(
    rng: np.random.Generator, doors: Sequence[DoorPlan], length: float, margin: float = 0.4
) -> tuple[DoorPlan, ...]:
    """Places doors along a wall, left to right, the free length between and beside them shared by chance."""
    wide = [door.reach[1] - door.reach[0] for door in doors]
    spare = length - sum(wide) - margin * (len(doors) + 1)
    if spare < 0:
        raise ValueError(f"{len(doors)} doors of {sum(wide):.2f} m do not fit in a wall of {length:.2f} m")
    shares = rng.dirichlet(np.full(len(doors) + 1, 2.0))
    placed, x = [], 0.0
    for door, width, share in zip(doors, wide, shares, strict=False):
        x += margin + float(spare * share)
        placed.append(replace(door, left=x + (door.left - door.reach[0])))
        x += width
    return tuple(placed)


def thickness(rng: np.random.Generator) -> float:
    """Of a wall [m]."""
    return float(rng.uniform(0.12, 0.28))


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
    wall = WallPlan(finish or site.paint, thickness(rng), tuple(doors), windows, skirting=WHITE, behind=behind)
    wall = _filled(rng, wall, free_spans(taken, site.length, 0.25), busy)
    return replace(wall, hung=wall.hung + _at_doors(rng, doors, site) + _below(windows))


def blank_wall(rng: np.random.Generator, site: Site) -> WallPlan:
    """A wall without doors, not judged."""
    windows = _window(rng, [], site) if site.length > 2.5 and rng.random() < 0.7 else ()
    spans = free_spans([(w.left - 0.1, w.left + w.width + 0.1) for w in windows], site.length, 0.25)
    wall = WallPlan(
        site.paint,
        thickness(rng),
        windows=windows,
        hung=_below(windows),
        skirting=WHITE,
        behind="yard",
        is_judged=False,
    )
    return _filled(rng, wall, spans, 1.0)


def _outline(rng: np.random.Generator, sides: int) -> NDArray[np.float64]:
    width, depth = float(rng.uniform(6.3, 7.6)), float(rng.uniform(5.3, 6.2))
    kind = rng.choice(["rectangle", "trapezoid", "chamfered", "angled"], p=[0.3, 0.25, 0.2, 0.25])
    if kind == "trapezoid":
        return floor_plans.trapezoid(width, depth, float(rng.uniform(-0.9, 0.9)))
    if kind == "chamfered":
        return floor_plans.chamfered(width, depth, float(rng.uniform(0.9, 1.2)))
    if kind == "angled" and sides < 4:
        return floor_plans.angled(width, depth, (float(rng.uniform(1.2, 1.8)), float(rng.uniform(1.2, 1.8))))
    return floor_plans.rectangle(width, depth)


def _watched(corners: NDArray[np.float64], judged: NDArray[np.int_]) -> NDArray[np.float64]:
    """(N, 2) points just before both ends of each judged wall."""
    starts, ends = corners[judged], np.roll(corners, -1, axis=0)[judged]
    along = (ends - starts) / np.linalg.norm(ends - starts, axis=1, keepdims=True)
    before = 0.05 * np.column_stack([along[:, 1], -along[:, 0]])  # the room is on the right
    return np.concatenate([starts + 0.3 * along + before, ends - 0.3 * along + before])


def _feet(corners: NDArray[np.float64], side: int, scanners: NDArray[np.float64]) -> tuple[float, ...]:
    start, end = corners[side], corners[(side + 1) % len(corners)]
    along = (end - start) / np.linalg.norm(end - start)
    return tuple(float((np.array([x, y]) - start) @ along) for x, y, _ in scanners)


def _middle_table(
    rng: np.random.Generator, corners: NDArray[np.float64]
) -> tuple[tuple[float, float, float, Thing], ...]:
    """A small table with chairs in the middle of the room."""
    x, y = (corners[:4].mean(axis=0) + rng.uniform(-0.4, 0.4, 2)).tolist()
    turn = float(rng.uniform(-np.pi, np.pi))
    table = furniture.Table(float(rng.uniform(0.9, 1.2)), 0.7, 0.73, furniture.wood_colour(rng), finishes.seed(rng))
    c, s = np.cos(turn), np.sin(turn)
    chair = furniture.Chair(furniture.fabric(rng))
    return (
        (x - 0.35 * s, y + 0.35 * c, turn, table),
        (x - 0.75 * s, y + 0.75 * c, turn, chair),
        (x + 0.75 * s, y - 0.75 * c, turn + np.pi, chair),
    )


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
            kind = rng.choice(["poster", "board", "extinguisher", "socket", "tall", "low", "clock"], p=_MIX)
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


_MIX = (0.3, 0.1, 0.08, 0.16, 0.13, 0.18, 0.05)


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
