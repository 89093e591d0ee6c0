"""What the views of a room show of its walls: all that the detector takes from the points themselves (section 4)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from time import perf_counter
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from detector.edges import wall_face
from detector.orthoimage import crop, image_shape, mark, orthoimage, sampling_gap
from detector.parallel import each
from detector.parameters import DetectorParameters
from detector.result import Mask, Orthoimage
from detector.room import DetectorError, Room, View, Wall


@dataclass(frozen=True, eq=False)
class Look:
    """What the views of a room show of one wall."""

    wall: Wall
    floor: float
    """Height of the floor along v [m]."""
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
    seconds: float
    """Time that all this took: for people, not part of any result [s]."""


class _ViewLook(NamedTuple):
    """One view's part in a `Look`."""

    view: Orthoimage
    camera: NDArray[np.float64]
    face: Mask
    passed: Mask
    blocked: Mask
    around: NDArray[np.float32]
    low: NDArray[np.float32]


def look_at_walls(room: Room, parameters: DetectorParameters) -> list[Look]:
    """What the views show of each wall, in the order of `Room.walls`; the views are read one after another, once.

    Raises:
        DetectorError: The room has no view or no floor, or a wall is malformed or too large for `pixel_size`.
    """
    if not room.views:
        raise DetectorError("Room.views: expected at least one view, got none")
    if not np.isfinite(room.floor_height):
        raise DetectorError(f"Room.floor_height: expected a height, got {room.floor_height}")
    for wall in room.walls:
        check_wall(wall)
        image_shape(wall, parameters)
    seeing: list[dict[int, _ViewLook]] = [{} for _ in room.walls]
    seconds = [0.0] * len(room.walls)
    for number in range(len(room.views)):  # no name for the view: it is gone before the next is made
        looks = each(partial(_look_from, room.views[number], room.floor_height, parameters=parameters), room.walls)
        for k, (look, time) in enumerate(looks):
            seconds[k] += time
            if look is not None:
                seeing[k][number] = look
    return [
        _together(wall, _floor(wall, room.floor_height), seeing.pop(0), time, parameters)
        for wall, time in zip(room.walls, seconds, strict=True)
    ]


def _floor(wall: Wall, floor_height: float) -> float:
    """Height of the floor along v [m]."""
    return float(np.clip(floor_height - wall.origin[2], 0, wall.height))


def _look_from(
    view: View, floor_height: float, wall: Wall, *, parameters: DetectorParameters
) -> tuple[_ViewLook | None, float]:
    """What one view shows of the wall, None if nothing, and how long it took [s]."""
    start = perf_counter()
    points = crop(view, wall, _floor(wall, floor_height), parameters)
    if points is None:
        return None, perf_counter() - start
    gap = sampling_gap(points, parameters)
    image = orthoimage(points, wall, gap, parameters)
    look = _ViewLook(
        view=image,
        camera=points.camera,
        face=wall_face(image, parameters),
        passed=mark(points.passed, wall, gap, parameters),
        blocked=mark(points.blocked, wall, parameters.max_gap_px, parameters),
        around=points.around,
        low=points.low,
    )
    return look, perf_counter() - start


def _together(
    wall: Wall, floor: float, seeing: dict[int, _ViewLook], seconds: float, parameters: DetectorParameters
) -> Look:
    """The parts of all views that saw a wall."""
    nothing, looks = np.zeros(image_shape(wall, parameters), bool), list(seeing.values())
    return Look(
        wall=wall,
        floor=floor,
        numbers=tuple(seeing),
        views=[look.view for look in looks],
        cameras=[look.camera for look in looks],
        faces=[look.face for look in looks],
        face=np.any([nothing, *(look.face for look in looks)], axis=0),
        passed=np.any([nothing, *(look.passed for look in looks)], axis=0),
        blocked=np.any([nothing, *(look.blocked for look in looks)], axis=0),
        around=np.concatenate([np.zeros((0, 3), np.float32), *(look.around for look in looks)]),
        low=np.concatenate([np.zeros((0, 3), np.float32), *(look.low for look in looks)]),
        seconds=seconds,
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
