"""Walls as masons leave them: the slab with its holes, windows, skirting, and what lies behind."""

from __future__ import annotations

import numpy as np

from mission.bench.walls import finishes
from mission.bench.walls.finishes import DOOR_PAINTS, GLASS, WALL_PAINTS, Finish
from mission.bench.walls.fixtures import random_poster
from mission.bench.walls.furniture import random_low, random_tall
from mission.bench.walls.kit import Body, Hole, Kit
from mission.bench.walls.plans import WallPlan, WindowPlan, free_spans

_OVERLAP = 0.1
"""By which a wall reaches below the floor and above the ceiling [m]."""
_SKIRTING_DEPTH = 0.014


def build_shell(kit: Kit, body: Body, wall: WallPlan, size: tuple[float, float], beyond: tuple[float, float]) -> None:
    """Add a wall without its doors.

    Args:
        kit: the world.
        body: in whose frame the wall stands.
        wall: what to build.
        size: length and height of its face [m].
        beyond: how far it goes on behind the neighbours at its left and right end [m].
    """
    length, height = size
    holes = [door.hole for door in wall.doors] + [window.hole for window in wall.windows]
    pocket = next((door for door in wall.doors if door.slides and 0 < door.recess < wall.thickness - 0.04), None)
    skins = [(0.0, wall.thickness)]
    if pocket:  # the leaf is between two
        skins = [(0.0, pocket.recess - 0.008), (pocket.recess + 0.048, wall.thickness)]
    for near, far in skins:
        for bottom, top, finish in _painted(wall, -_OVERLAP, height + _OVERLAP):
            kit.slab(body, (-beyond[0], near, bottom), (length + beyond[1], far, top), finish, holes)
    for window in wall.windows:
        _build_window(kit, body, window, wall.thickness)
    if wall.skirting:
        taken = [door.reach if door.frame.style != "none" else (door.left, door.right) for door in wall.doors]
        for low, high in free_spans(taken, length, 0.02):
            kit.box(body, (low, -_SKIRTING_DEPTH, 0), (high, 0, wall.skirting_height), wall.skirting)


def _painted(wall: WallPlan, bottom: float, top: float) -> list[tuple[float, float, Finish]]:
    """Lower and upper end [m] and finish of each stretch of a wall, from the bottom up."""
    found, z = [], bottom
    for band in wall.bands:
        if band.bottom > z:
            found.append((z, band.bottom, wall.finish))
        found.append((band.bottom, band.top, band.finish))
        z = band.top
    return [*found, (z, top, wall.finish)]


def build_beyond(kit: Kit, body: Body, wall: WallPlan, size: tuple[float, float], rng: np.random.Generator) -> None:
    """Add what is seen through the wall's openings: a corridor, another room or a yard, with a few things in it."""
    length, height = size
    near = wall.thickness - 0.02
    depth = {"corridor": rng.uniform(1.6, 2.2), "room": rng.uniform(2.8, 3.8), "yard": 6.0}[wall.behind]
    far = near + depth
    top = height if wall.behind == "yard" else float(rng.uniform(2.45, 2.8))
    top = max([top, *(door.height + 0.15 for door in wall.doors)])
    paint = finishes.plaster(rng, finishes.pick(rng, WALL_PAINTS))
    if wall.behind == "yard":
        paint = Finish((0.62, 0.40, 0.32), finishes.textures.bricks, 0.15, (1.0, 0.6), finishes.seed(rng))
    kit.slab(body, (0, far, -0.1), (length, far + 0.1, top), paint)
    for x in (-0.1, length):
        kit.slab(body, (x, near, -0.1), (x + 0.1, far + 0.1, top), paint)
    floor = finishes.floor(rng)
    kit.prism(body, np.array([[0, far], [length, far], [length, near], [0, near]]), -0.1, 0.0, floor)
    if wall.behind != "yard":
        kit.box(body, (-0.1, near, top), (length + 0.1, far + 0.1, top + 0.1), finishes.WHITE)
    _furnish(kit, body, (length, far), rng, is_room=wall.behind == "room")


def _furnish(kit: Kit, body: Body, corner: tuple[float, float], rng: np.random.Generator, *, is_room: bool) -> None:
    """Things along the far wall behind the opening, which face back."""
    length, far = corner
    for share in (0.3, 0.75):
        x = float(np.clip(rng.normal(share, 0.1) * length, 0.5, length - 0.5))
        poster = random_poster(rng)
        poster.build(kit, body.add_body(pos=[x, far, 1.6]))
        if is_room:
            thing = random_tall(rng) if rng.random() < 0.5 else random_low(rng)
            thing.build(kit, body.add_body(pos=[x, far, 0]))


def _build_window(kit: Kit, body: Body, window: WindowPlan, thickness: float) -> None:
    hole, bar = window.hole, 0.05
    near, far = thickness * 0.4, thickness * 0.4 + 0.06
    finish = window.finish
    inner = Hole(hole.left + bar, hole.bottom + bar, hole.right - bar, hole.top - bar)
    kit.box(body, (hole.left, near, hole.bottom), (inner.left, far, hole.top), finish)
    kit.box(body, (inner.right, near, hole.bottom), (hole.right, far, hole.top), finish)
    kit.box(body, (inner.left, near, hole.bottom), (inner.right, far, inner.bottom), finish)
    kit.box(body, (inner.left, near, inner.top), (inner.right, far, hole.top), finish)
    for k in range(window.mullions):
        x = inner.left + (inner.right - inner.left) * (k + 1) / (window.mullions + 1)
        kit.box(body, (x - 0.025, near, inner.bottom), (x + 0.025, far, inner.top), finish)
    middle = (near + far) / 2
    kit.box(body, (inner.left, middle - 0.003, inner.bottom), (inner.right, middle + 0.003, inner.top), GLASS)
    kit.box(body, (hole.left - 0.04, -0.05, hole.bottom - 0.03), (hole.right + 0.04, near, hole.bottom), finish)


def skirting_finish(rng: np.random.Generator) -> Finish:
    """Paint or wood for skirting boards."""
    return finishes.WHITE if rng.random() < 0.4 else finishes.plain(finishes.pick(rng, finishes.WOODS + DOOR_PAINTS))
