"""Colours for the points of a scan, from the photographs that see them."""

from __future__ import annotations

import os
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING

import cv2
import numpy as np
from numpy.typing import NDArray

from detector.room import View
from mission.errors import MissionError
from mission.rigid import Pose, inverted

if TYPE_CHECKING:
    from sim.photo import Photo
    from sim.scan import Scan

Mask = NDArray[np.bool_]
Coordinates = NDArray[np.float32]

_SPLAT = 2.5
"""Side of a depth cell in beam spacings: wide enough that a surface that the scanner saw leaves no hole."""
_TOLERANCE = 0.05
"""A point this much behind the nearest one of its depth cell is still on the same surface [m]."""
_STEEPEST = float(np.tan(np.deg2rad(80)))
"""Depth that an oblique surface may span in a depth cell, per width of the cell."""


def colour_scan(scan: Scan, photos: Sequence[Photo], world_from_scanner: Pose) -> View:
    """Give each returned point the colour of the photograph that sees it best.

    The best photograph is the one nearest in azimuth (of several, the one with the point nearest to its optical axis).
    The camera sits above the scanner, so it does not see all that the scanner sees: a depth buffer of the scan's own
    points, splatted into each photograph at the scan's resolution, tells. A point that no photograph sees stays
    uncoloured.

    Args:
        scan: Range image on the scanner's grid.
        photos: One turn of the camera; all share one camera centre. May be empty.
        world_from_scanner: Registered pose of the scan.

    Raises:
        MissionError: The photographs do not share one camera centre.
    """
    colours = np.zeros((*scan.ranges.shape, 3), np.uint8)
    coloured = np.zeros(scan.ranges.shape, bool)
    centre = _camera_centre(photos)
    kept = np.flatnonzero(np.isfinite(scan.ranges))
    points = np.empty((len(kept), 3), np.float32)
    with ThreadPoolExecutor(os.cpu_count()) as pool:  # no two tasks write to one place, so their order is of no matter
        painting = [
            pool.submit(_paint_sector, scan, rivals, columns, colours, coloured)
            for columns, rivals in _sectors(scan, photos)
        ]
        moving = [pool.submit(_move_axis, scan, world_from_scanner, kept, axis, points) for axis in range(3)]
        for task in painting + moving:
            task.result()
    return View(
        points_in_world=points,
        colours=colours.reshape(-1, 3).take(kept, axis=0),
        coloured=coloured.ravel().take(kept),
        scanner_in_world=world_from_scanner[:3, 3].copy(),
        camera_in_world=world_from_scanner[:3, :3] @ centre + world_from_scanner[:3, 3],
    )


def _camera_centre(photos: Sequence[Photo]) -> NDArray[np.float64]:
    """(3,) in the scanner frame; the scanner's own origin if there is no photograph."""
    if not photos:
        return np.zeros(3)
    centres = np.array([photo.scanner_from_camera[:3, 3] for photo in photos])
    if np.ptp(centres, axis=0).max() > 1e-3:
        raise MissionError(
            f"photographs of one turn share one camera centre, but these differ by {np.ptp(centres, 0)} m"
        )
    return centres[0]


def _sectors(scan: Scan, photos: Sequence[Photo]) -> list[tuple[NDArray[np.intp], list[Photo]]]:
    """Columns of the scan, and the photographs nearest to them in azimuth (more than one where the camera tilts)."""
    if not photos:
        return []
    axes = np.array([photo.scanner_from_camera[:3, 2] for photo in photos])
    headings = np.arctan2(axes[:, 1], axes[:, 0])
    off = np.abs((scan.azimuths[None, :] - headings[:, None] + np.pi) % (2 * np.pi) - np.pi)
    same = np.abs((headings[:, None] - headings[None, :] + np.pi) % (2 * np.pi) - np.pi) < np.deg2rad(1)
    leaders = np.argmax(same, axis=1)
    nearest = leaders[np.argmin(off, axis=0)]
    return [
        (np.flatnonzero(nearest == leader), [photos[k] for k in range(len(photos)) if leaders[k] == leader])
        for leader in np.unique(leaders)
        if np.any(nearest == leader)
    ]


def _paint_sector(
    scan: Scan, photos: Sequence[Photo], columns: NDArray[np.intp], colours: NDArray[np.uint8], coloured: Mask
) -> None:
    """Colour the points of some columns from the photographs that look there, in place."""
    best = np.full((len(scan.elevations), len(columns)), np.inf, np.float32)
    for photo in photos:
        _paint(scan, photo, columns, best, colours, coloured)


def _paint(
    scan: Scan,
    photo: Photo,
    columns: NDArray[np.intp],
    best: Coordinates,
    colours: NDArray[np.uint8],
    coloured: Mask,
) -> None:
    """Colour the points of some columns that the photo sees closer to its axis than `best` (E, C), in place."""
    camera_from_scanner = inverted(photo.scanner_from_camera)
    x, y, depth = (_coordinate(scan, camera_from_scanner, columns, axis) for axis in range(3))
    height, width = photo.image.shape[:2]
    k = photo.intrinsics.astype(np.float32)
    with np.errstate(divide="ignore", invalid="ignore"):
        x /= depth
        y /= depth
        u = x * k[0, 0] + (k[0, 2] - np.float32(0.5))  # of the pixel's index: centres are at +0.5
        v = y * k[1, 1] + (k[1, 2] - np.float32(0.5))
        inside = (depth > 0) & (u >= 0) & (u <= width - 1) & (v >= 0) & (v <= height - 1)  # False where NaN
    off_axis = np.square(x, out=x) + np.square(y, out=y)
    pitch = max(abs(scan.azimuths[1] - scan.azimuths[0]), abs(scan.elevations[1] - scan.elevations[0]))
    cell = max(1.0, _SPLAT * pitch * float(k[0, 0]))  # pixels
    seen = inside & (off_axis < best)
    if not seen.any():
        return
    seen &= _in_front(inside, (u, v, depth), cell=cell, focal=float(k[0, 0]))
    sampled = cv2.remap(photo.image, u, v, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    painted = np.flatnonzero(seen)
    rows, places = np.divmod(painted.astype(np.int32), np.int32(len(columns)))
    beams = rows * np.intp(len(scan.azimuths)) + columns.take(places)
    colours.reshape(-1, 3)[beams] = sampled.reshape(-1, 3).take(painted, axis=0)
    coloured.reshape(-1)[beams] = True
    np.copyto(best, off_axis, where=seen)


def _move_axis(scan: Scan, world_from_scanner: Pose, kept: NDArray[np.intp], axis: int, points: Coordinates) -> None:
    """One coordinate of the end points (N, 3) of the kept beams, row by row, in place [m]."""
    points[:, axis] = _coordinate(scan, world_from_scanner, np.s_[:], axis).ravel().take(kept)


def _coordinate(scan: Scan, pose: Pose, columns: NDArray[np.intp] | slice, axis: int) -> Coordinates:
    """One coordinate (E, C) of beams' end points in the frame that `pose` leads to [m].

    A beam is (cos e cos a, cos e sin a, sin e) times its range, so the turned beam separates into rows and columns.
    """
    azimuths = scan.azimuths[columns]
    level = np.cos(scan.elevations).astype(np.float32)[:, None]
    up = np.sin(scan.elevations).astype(np.float32)[:, None]
    along = (pose[axis, 0] * np.cos(azimuths) + pose[axis, 1] * np.sin(azimuths)).astype(np.float32)
    beam = level * along
    beam += up * np.float32(pose[axis, 2])
    beam *= scan.ranges[:, columns]
    beam += np.float32(pose[axis, 3])
    return beam


def _in_front(
    splatted: Mask, pixels: tuple[Coordinates, Coordinates, Coordinates], *, cell: float, focal: float
) -> Mask:
    """Splatted points that no other one hides: none much nearer in the depth cell at (u, v, depth) [px, px, m]."""
    places = np.flatnonzero(splatted)
    u, v, depth = (coordinate.ravel().take(places) for coordinate in pixels)
    wide = int(u.max() / cell) + 1
    index = (v / np.float32(cell)).astype(np.intp) * wide + (u / np.float32(cell)).astype(np.intp)
    nearest = np.full(int(index.max()) + 1, np.inf)
    np.minimum.at(nearest, index, depth.astype(np.float64))  # ten times as fast as in 32 bits (numpy 2.4)
    steep = depth * np.float32(_STEEPEST * cell / focal)
    result = np.zeros(splatted.shape, bool)
    result.ravel()[places] = depth <= nearest.astype(np.float32).take(index) + np.float32(_TOLERANCE) + steep
    return result
