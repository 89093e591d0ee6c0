"""The detector: a completed room in, the doors of each of its walls out (sections 4 to 6)."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from time import perf_counter

import numpy as np

from detector.confidence import judged
from detector.doors import doorway_rectangles, find_doors
from detector.gloss import compare_views
from detector.highlights import find_highlights
from detector.illumination import even_light
from detector.leaves import describe_door, join_leaves
from detector.looking import Look, look_at_walls
from detector.merging import merge
from detector.openings import find_openings, visibility
from detector.orthoimage import image_shape, nearest
from detector.outline import settle_sides
from detector.parallel import each
from detector.parameters import DetectorParameters
from detector.pivot import hinge_side
from detector.result import Door, Orthoimage, WallResult
from detector.room import Room, Wall
from detector.undercut import with_lower_edge
from detector.wall_area import find_wall_area


def detect_doors(room: Room, parameters: DetectorParameters | None = None) -> list[WallResult]:
    """Find the doors of a room.

    Args:
        room: One completed room; points that are NaN are left out.
        parameters: The paper's where not given.

    Returns:
        One result a wall, in the order of `Room.walls`. A wall that no view saw has empty images and no door.

    Raises:
        DetectorError: The room has no view or no floor, or a wall is malformed or too large for `pixel_size`.
    """
    parameters = parameters or DetectorParameters()
    looks = look_at_walls(room, parameters)
    each_look = (looks.pop(0) for _ in room.walls)  # a look is large, and gone with its wall
    return each(partial(judge_wall, parameters=parameters), each_look)


def detect_wall(room: Room, wall: Wall, parameters: DetectorParameters) -> WallResult:
    """All stages on one wall of a room, or on another rectangle in it."""
    return judge_wall(look_at_walls(replace(room, walls=(wall,)), parameters)[0], parameters)


def judge_wall(look: Look, parameters: DetectorParameters) -> WallResult:
    """All stages on one wall but the first, the orthoimages of its views."""
    clock, wall, floor = _Clock(), look.wall, look.floor
    clock.seconds.append(("orthoimages", look.seconds))
    with clock("highlights"):
        even = (
            even_light(look.views, look.cameras, wall.height, look.faces) if parameters.normalise_flash else look.views
        )
        highlights = each(
            lambda seen: find_highlights(*seen, wall.height, parameters), zip(even, look.cameras, strict=True)
        )
        if parameters.compare_views:
            highlights = compare_views(look.views, even, highlights, look.cameras, wall.height, parameters)
    with clock("merging"):
        merged = merge(even, highlights, look.cameras, wall.height, parameters) if even else _empty(wall, parameters)
    with clock("openings"):
        seen = visibility(merged, look.passed, look.blocked, wall)
        openings = find_openings(merged, seen, wall, floor, parameters)
    with clock("wall area"):
        area = find_wall_area(merged, parameters)
    with clock("doors"):
        search, scene = find_doors(merged, seen, look.face, area, (wall.height, floor), parameters)
        rectangles = settle_sides(doorway_rectangles(search), look.passed, scene, wall.height, parameters)
    with clock("angles"):
        bare = replace(merged, depth=nearest(merged.depth, ~scene.hidden))  # a leaf goes on behind furniture
        doors = [describe_door(r, bare, seen, look.around, wall.height, parameters) for r in rectangles]
        doors = [_at_hinge(d, look) for d in doors] if parameters.settle_sides else doors
        doors = [with_lower_edge(d, look.low, bare, wall.height, floor, parameters) for d in doors]
        doors = judged(doors, search, scene, wall.height)
    return WallResult(
        wall=wall,
        views=tuple(look.views),
        view_numbers=look.numbers,
        highlights=tuple(highlights),
        merged=merged,
        openings=openings,
        wall_area=area,
        search=search,
        doors=tuple(join_leaves(doors)),
        stage_seconds=tuple(clock.seconds),
    )


def _at_hinge(door: Door, look: Look) -> Door:
    """A single door with its hinge side where its leaf tells."""
    if door.kind != "single":
        return door
    return replace(door, rectangle=hinge_side(door.rectangle, door.leaves[0], look.around, look.cameras))


def _empty(wall: Wall, parameters: DetectorParameters) -> Orthoimage:
    """An orthoimage without a point."""
    shape = image_shape(wall, parameters)
    colour, coloured = np.zeros((*shape, 3), np.uint8), np.zeros(shape, bool)
    return Orthoimage(colour, coloured, np.full(shape, np.nan, np.float32), parameters.pixel_size)


class _Clock:
    """Seconds spent in each stage."""

    def __init__(self) -> None:
        self.seconds: list[tuple[str, float]] = []

    @contextmanager
    def __call__(self, stage: str) -> Iterator[None]:
        start = perf_counter()
        yield
        self.seconds.append((stage, perf_counter() - start))
