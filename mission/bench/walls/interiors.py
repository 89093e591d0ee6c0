"""What the categories share: rooms with their outlines and scan places, and ordinary doors."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from mission.bench.walls import finishes, floor_plans, furniture
from mission.bench.walls.filling import blank_wall
from mission.bench.walls.finishes import BRASS, DOOR_PAINTS, FROSTED, STEEL, WALL_PAINTS, WHITE, WOODS, Finish
from mission.bench.walls.hidden import scanner_origins
from mission.bench.walls.plans import NO_FRAME, DoorPlan, Frame, Maker, RoomPlan, Site, Thing, WallPlan
from mission.bench.walls.shell import skirting_finish

_LEAF_WIDTHS = (0.62, 0.72, 0.82, 0.92, 1.02)


def room(
    rng: np.random.Generator,
    category: str,
    makers: Sequence[Maker],
    paint: Finish | None = None,
    places: int | None = None,
) -> RoomPlan:
    """A room of a category whose judged walls the makers build, those that need most room first.

    Args:
        rng: source of chance.
        category: of the judged walls.
        makers: one for each judged wall, three or four.
        paint: of its walls; None for any.
        places: to scan from; None for 2 to 4.
    """
    corners = _outline(rng, len(makers))
    height = float(rng.uniform(2.55, 3.0))
    lengths = floor_plans.side_lengths(corners)
    judged = np.sort(np.argsort(-lengths, kind="stable")[: len(makers)])
    order = judged[np.argsort(-lengths[judged], kind="stable")]
    count = places or int(rng.choice([2, 3, 4], p=[0.2, 0.5, 0.3]))
    middle = _middle_table(rng, corners) if count > 2 and rng.random() < 0.4 else ()
    scan_places = floor_plans.scan_places(
        *(rng, corners, count), seen=_watched(corners, judged), avoid=[(x, y, 1.25) for x, y, *_ in middle]
    )
    paint = paint or finishes.plaster(rng, finishes.pick(rng, WALL_PAINTS))
    skirting, tall = skirting_finish(rng), float(rng.uniform(0.06, 0.11))
    walls: list[WallPlan] = []
    for side in range(len(corners)):
        site = Site(float(lengths[side]), height, paint, _feet(corners, side, scanner_origins(scan_places)))
        if side in judged:
            walls.append(makers[int(np.flatnonzero(order == side)[0])](rng, site))
        else:
            walls.append(blank_wall(rng, site))
    walls = [replace(wall, skirting=wall.skirting and skirting, skirting_height=tall) for wall in walls]
    ceiling = finishes.plain((0.92, 0.92, 0.91))
    return RoomPlan(category, corners, height, tuple(walls), finishes.floor(rng), ceiling, scan_places, middle)


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
    """Place doors along a wall, left to right, the free length between and beside them shared by chance."""
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
