"""The detector: a completed room in, the doors of each of its walls out (sections 4 to 6)."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import partial
from time import perf_counter
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from detector.confidence import judged
from detector.doors import doorway_rectangles, find_doors
from detector.edges import wall_face
from detector.gloss import compare_views
from detector.highlights import find_highlights
from detector.illumination import even_light
from detector.leaves import describe_door, join_leaves
from detector.merging import merge
from detector.openings import find_openings, visibility
from detector.orthoimage import crop, image_shape, mark, nearest, orthoimage, sampling_gap
from detector.outline import settle_sides
from detector.parallel import each
from detector.parameters import DetectorParameters
from detector.pivot import hinge_side
from detector.result import Door, Mask, Orthoimage, WallResult
from detector.room import DetectorError, Room, View, Wall
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
    if not room.views:
        raise DetectorError("Room.views: expected at least one view, got none")
    if not np.isfinite(room.floor_height):
        raise DetectorError(f"Room.floor_height: expected a height, got {room.floor_height}")
    return each(partial(detect_wall, room, parameters=parameters), room.walls)


def detect_wall(room: Room, wall: Wall, parameters: DetectorParameters) -> WallResult:
    """All stages on one wall."""
    clock = _Clock()
    check_wall(wall)
    floor = float(np.clip(room.floor_height - wall.origin[2], 0, wall.height))
    with clock("orthoimages"):
        look = look_at(room, wall, floor, parameters)
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


@dataclass(frozen=True, eq=False)
class Look:
    """What the views of a room show of one wall."""

    numbers: tuple[int, ...]
    """Index into `Room.views` of each view that saw the wall; the lists below are in this order."""
    views: list[Orthoimage]
    """J_CD^k."""
    cameras: list[NDArray[np.float64]]
    """(3,) centre of each camera in wall coordinates [m]."""
    faces: list[Mask]
    """(H, W) where each view shows the wall's face."""
    face: Mask
    """(H, W) where any view does."""
    passed: Mask
    """(H, W) where beams went through the wall's face."""
    blocked: Mask
    """(H, W) where beams ended well before the wall."""
    around: NDArray[np.float32]
    """(N, 3) points up to a leaf's width from the wall, in wall coordinates [m]."""
    low: NDArray[np.float32]
    """(M, 3) points of the slab at the floor and just above it, in wall coordinates [m]."""


def look_at(room: Room, wall: Wall, floor: float, parameters: DetectorParameters) -> Look:
    """Everything that is read from the points themselves, view by view (section 4)."""
    nothing = np.zeros(image_shape(wall, parameters), bool)
    looks = each(lambda view: _look_from(view, wall, floor, parameters), room.views)
    seeing = {i: look for i, look in enumerate(looks) if look is not None}
    return Look(
        numbers=tuple(seeing),
        views=[look.view for look in seeing.values()],
        cameras=[look.camera for look in seeing.values()],
        faces=[look.face for look in seeing.values()],
        face=np.any([nothing, *(look.face for look in seeing.values())], axis=0),
        passed=np.any([nothing, *(look.passed for look in seeing.values())], axis=0),
        blocked=np.any([nothing, *(look.blocked for look in seeing.values())], axis=0),
        around=np.concatenate([np.zeros((0, 3), np.float32), *(look.around for look in seeing.values())]),
        low=np.concatenate([np.zeros((0, 3), np.float32), *(look.low for look in seeing.values())]),
    )


class _ViewLook(NamedTuple):
    """One view's part in a `Look`."""

    view: Orthoimage
    camera: NDArray[np.float64]
    face: Mask
    passed: Mask
    blocked: Mask
    around: NDArray[np.float32]
    low: NDArray[np.float32]


def _look_from(view: View, wall: Wall, floor: float, parameters: DetectorParameters) -> _ViewLook | None:
    """What one view shows of the wall; None if nothing."""
    points = crop(view, wall, floor, parameters)
    if points is None:
        return None
    gap = sampling_gap(points, parameters)
    image = orthoimage(points, wall, gap, parameters)
    return _ViewLook(
        view=image,
        camera=points.camera,
        face=wall_face(image, parameters),
        passed=mark(points.passed, wall, gap, parameters),
        blocked=mark(points.blocked, wall, parameters.max_gap_px, parameters),
        around=points.around,
        low=points.low,
    )


def check_wall(wall: Wall) -> None:
    """Refuse a wall whose axes or labels make no sense.

    Raises:
        DetectorError: Naming the field.
    """
    for name, axis in (("u", wall.u), ("v", wall.v)):
        if np.shape(axis) != (3,) or not np.isclose(np.linalg.norm(axis), 1, atol=1e-3):
            raise DetectorError(f"Wall.{name}: expected a unit vector of shape (3,), got {axis}")
    if np.shape(wall.origin) != (3,) or not np.isfinite(wall.origin).all():
        raise DetectorError(f"Wall.origin: expected three finite coordinates, got {wall.origin}")
    if abs(float(wall.u @ wall.v)) > 1e-3:
        raise DetectorError("Wall.u: expected to be perpendicular to Wall.v")
    if wall.voxel_labels.ndim != 2 or 0 in wall.voxel_labels.shape:
        raise DetectorError(f"Wall.voxel_labels: expected rows x columns, got shape {wall.voxel_labels.shape}")
    if not (np.isfinite(wall.voxel_size) and wall.voxel_size > 0):
        raise DetectorError(f"Wall.voxel_size: expected a positive length, got {wall.voxel_size}")


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
