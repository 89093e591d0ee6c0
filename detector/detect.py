"""The detector: a completed room in, the doors of each of its walls out (sections 4 to 6)."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from time import perf_counter

import numpy as np

from detector.doors import doorway_rectangles, find_doors
from detector.edges import wall_face
from detector.highlights import find_highlights
from detector.illumination import equalised, without_falloff
from detector.leaves import describe_door, join_leaves
from detector.merging import merge
from detector.openings import find_openings, visibility
from detector.orthoimage import WallPoints, crop, image_shape, mark, orthoimage, sampling_gap
from detector.outline import settle_sides
from detector.parameters import DetectorParameters
from detector.result import Door, Orthoimage, WallResult
from detector.room import DetectorError, Room, Wall
from detector.wall_area import find_wall_area


def detect_doors(room: Room, parameters: DetectorParameters | None = None) -> list[WallResult]:
    """Find the doors of a room.

    Args:
        room: One completed room; points that are NaN are left out.
        parameters: The paper's where not given.

    Returns:
        One result a wall, in the order of `Room.walls`. A wall that no view saw has empty images and no door.

    Raises:
        DetectorError: The room has no view, or a wall is malformed or too large for `pixel_size`.
    """
    parameters = parameters or DetectorParameters()
    if not room.views:
        raise DetectorError("Room.views: expected at least one view, got none")
    return [detect_wall(room, wall, parameters) for wall in room.walls]


def detect_wall(room: Room, wall: Wall, parameters: DetectorParameters) -> WallResult:
    """All stages on one wall."""
    clock = _Clock()
    check_wall(wall)
    shape = image_shape(wall, parameters)
    floor = float(np.clip(room.floor_height - wall.origin[2], 0, wall.height))
    with clock("orthoimages"):
        crops = [crop(view, wall, floor, parameters) for view in room.views]
        points = [c for c in crops if c is not None]
        gaps = [sampling_gap(p, parameters) for p in points]
        views = [orthoimage(p, wall, g, parameters) for p, g in zip(points, gaps, strict=True)]
        passed = np.zeros(shape, bool)
        blocked = np.zeros(shape, bool)
        face = np.any([wall_face(view, parameters) for view in views], axis=0) if views else np.zeros(shape, bool)
        for p, g in zip(points, gaps, strict=True):
            passed |= mark(p.passed, wall, g, parameters)
            blocked |= mark(p.blocked, wall, parameters.max_gap_px, parameters)
    with clock("highlights"):
        even = even_light(views, points, wall.height, parameters)
        highlights = [find_highlights(i, p.camera, wall.height, parameters) for i, p in zip(even, points, strict=True)]
    with clock("merging"):
        cameras = [p.camera for p in points]
        merged = merge(even, highlights, cameras, wall.height, parameters) if views else _empty(shape, parameters)
    with clock("openings"):
        seen = visibility(merged, passed, blocked, wall)
        openings = find_openings(merged, seen, wall, floor, parameters)
    with clock("wall area"):
        area = find_wall_area(merged, parameters)
    with clock("doors"):
        search, scene = find_doors(merged, seen, face, area, (wall.height, floor), parameters)
        rectangles = settle_sides(doorway_rectangles(search), passed, scene, wall.height)
    with clock("angles"):
        around = np.concatenate([p.around for p in points]) if points else np.zeros((0, 3), np.float32)
        doors: list[Door] = [describe_door(r, merged, seen, around, wall.height, parameters) for r in rectangles]
    return WallResult(
        wall=wall,
        views=tuple(views),
        view_numbers=tuple(i for i, c in enumerate(crops) if c is not None),
        highlights=tuple(highlights),
        merged=merged,
        openings=openings,
        wall_area=area,
        search=search,
        doors=tuple(join_leaves(doors)),
        stage_seconds=tuple(clock.seconds),
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


def even_light(
    views: list[Orthoimage], points: list[WallPoints], height: float, parameters: DetectorParameters
) -> list[Orthoimage]:
    """The views brought to one brightness, unless `normalise_flash` is off."""
    if not parameters.normalise_flash:
        return views
    faces = [np.abs(np.nan_to_num(v.depth, nan=np.inf)) < parameters.face_tolerance for v in views]
    flat = [without_falloff(v, p, height, f) for v, p, f in zip(views, points, faces, strict=True)]
    return equalised(flat, faces)


def _empty(shape: tuple[int, int], parameters: DetectorParameters) -> Orthoimage:
    """An orthoimage without a point."""
    nothing = np.zeros(shape, bool)
    return Orthoimage(
        np.zeros((*shape, 3), np.uint8), nothing, np.full(shape, np.nan, np.float32), parameters.pixel_size
    )


class _Clock:
    """Seconds spent in each stage."""

    def __init__(self) -> None:
        self.seconds: list[tuple[str, float]] = []

    @contextmanager
    def __call__(self, stage: str) -> Iterator[None]:
        start = perf_counter()
        yield
        self.seconds.append((stage, perf_counter() - start))
