"""Colours for the points of a scan, from the photographs that see them."""

from __future__ import annotations

import os
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

import cv2
import numpy as np
from numpy.typing import NDArray

from detector.room import View
from mission.errors import MissionError
from mission.rigid import Pose, inverted
from sim.bands import bands

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


class RangeImage(Protocol):
    """What a scan's points follow from."""

    @property
    def elevations(self) -> NDArray[np.float64]:
        """(E,) elevation of each row [rad]."""

    @property
    def azimuths(self) -> NDArray[np.float64]:
        """(A,) azimuth of each column [rad]."""

    @property
    def ranges(self) -> NDArray[np.float32]:
        """(E, A) [m]; NaN = no return."""


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
    centre = _camera_centre(photos)
    colours = np.zeros((*scan.ranges.shape, 3), np.uint8)
    coloured = np.zeros(scan.ranges.shape, bool)
    returned = np.isfinite(scan.ranges)
    with ThreadPoolExecutor(os.cpu_count()) as pool:  # no two tasks write to one place, so their order is of no matter
        painting = [
            pool.submit(_paint_sector, scan, rivals, columns, colours, coloured)
            for columns, rivals in _sectors(scan, photos)
        ]
        points = _points(scan, world_from_scanner, returned, pool)
        for task in painting:
            task.result()
    return View(
        points_in_world=points,
        colours=_of_pixels(colours, returned),
        coloured=coloured[returned],
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
    ranges = scan.ranges.take(columns, axis=1)
    best = np.full(ranges.shape, np.inf, np.float32)
    painted = np.zeros((*ranges.shape, 3), np.uint8)
    pitch = max(abs(scan.azimuths[1] - scan.azimuths[0]), abs(scan.elevations[1] - scan.elevations[0]))
    for photo in photos:
        beams = _Beams.of(scan, inverted(photo.scanner_from_camera), columns)
        _paint(ranges, beams, photo, pitch, best, painted)
    seen = np.isfinite(best)
    start = 0
    for run in np.split(columns, np.flatnonzero(np.diff(columns) > 1) + 1):  # a slice is written faster than columns
        here, there = slice(start, start + len(run)), slice(run[0], run[-1] + 1)
        colours[:, there], coloured[:, there] = painted[:, here], seen[:, here]
        start += len(run)


def _paint(
    ranges: Coordinates,
    beams: _Beams,
    photo: Photo,
    pitch: float,
    best: Coordinates,
    painted: NDArray[np.uint8],
) -> None:
    """Paint the beams (E, C) of a sector that the photo sees closer to its axis than `best`, in place."""
    height, width = photo.image.shape[:2]
    k = photo.intrinsics.astype(np.float32)
    cells = _DepthCells(width, height, side=max(1.0, _SPLAT * pitch * float(k[0, 0])))
    u, v, depth, off_axis = np.empty((4, *ranges.shape), np.float32)
    cell = np.empty(ranges.shape, np.intp)
    seen = np.empty(ranges.shape, bool)
    for rows in bands(ranges.shape):
        x, y, z = beams.end_points(ranges, rows)
        with np.errstate(divide="ignore", invalid="ignore"):
            x /= z
            y /= z
            u[rows] = x * k[0, 0] + (k[0, 2] - np.float32(0.5))  # of the pixel's index: centres are at +0.5
            v[rows] = y * k[1, 1] + (k[1, 2] - np.float32(0.5))
            inside = (z > 0) & (u[rows] >= 0) & (u[rows] <= width - 1) & (v[rows] >= 0) & (v[rows] <= height - 1)
            cell[rows] = cells.splat(u[rows], v[rows], z, inside)  # where NaN, nothing is inside
        depth[rows] = z
        np.add(np.square(x, out=x), np.square(y, out=y), out=off_axis[rows])
        np.logical_and(inside, off_axis[rows] < best[rows], out=seen[rows])
    if not seen.any():
        return
    deepest = cells.nearest.astype(np.float32) + np.float32(_TOLERANCE)
    steepest = np.float32(_STEEPEST * cells.side / float(k[0, 0]))
    for rows in bands(ranges.shape):
        seen[rows] &= depth[rows] <= deepest.take(cell[rows]) + depth[rows] * steepest
    sampled = cv2.remap(photo.image, u, v, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    cv2.copyTo(sampled, seen.view(np.uint8), painted)
    cv2.copyTo(off_axis, seen.view(np.uint8), best)


class _DepthCells:
    """The nearest point in each square cell of a photograph: what is well behind it is hidden."""

    def __init__(self, width: int, height: int, side: float) -> None:
        self.side = side
        """[px]"""
        self._wide = int((width - 1) / side) + 1
        self._elsewhere = self._wide * (int((height - 1) / side) + 1)
        self.nearest = np.full(self._elsewhere + 1, np.inf)
        """Depth of the nearest point by cell [m]; the last one is for points that are in none."""

    def splat(self, u: Coordinates, v: Coordinates, depth: Coordinates, inside: Mask) -> NDArray[np.intp]:
        """Put points at (u, v, depth) [px, px, m] into their cells, and say which these are."""
        side = np.float32(self.side)
        cell = (v / side).astype(np.intp) * self._wide + (u / side).astype(np.intp)
        cell[~inside] = self._elsewhere
        np.minimum.at(self.nearest, cell.ravel(), depth.ravel().astype(np.float64))  # 10 x as fast as in 32 bits
        return cell


def end_points(scan: RangeImage, world_from_scanner: Pose) -> Coordinates:
    """(N, 3) points of all returns in the world, row by row [m]: those of the view that the scan is coloured to."""
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        return _points(scan, world_from_scanner, np.isfinite(scan.ranges), pool)


def _points(scan: RangeImage, world_from_scanner: Pose, returned: Mask, pool: ThreadPoolExecutor) -> Coordinates:
    """(N, 3) end points of the beams that returned (E, A), row by row [m]."""
    beams = _Beams.of(scan, world_from_scanner, np.arange(len(scan.azimuths)))
    rows = bands(returned.shape)
    ends = np.cumsum([np.count_nonzero(returned[band]) for band in rows])
    points = np.empty((ends[-1], 3), np.float32)

    def move(band: slice, end: int) -> None:
        kept = _of_pixels(cv2.merge(beams.end_points(scan.ranges, band)), returned[band])
        points[end - len(kept) : end] = kept

    list(pool.map(move, rows, ends))
    return points


@dataclass(frozen=True, eq=False)
class _Beams:
    """Beams of a scan in another frame.

    A beam is (cos e cos a, cos e sin a, sin e) times its range, so the turned beam separates into rows and columns.
    """

    level: Coordinates
    """(E, 1) cosine of the elevation."""
    up: Coordinates
    """(E, 1) sine of the elevation."""
    along: Coordinates
    """(3, C) direction of level beams in the other frame."""
    pose: Pose
    """Of the scan in the other frame."""

    @classmethod
    def of(cls, scan: RangeImage, pose: Pose, columns: NDArray[np.intp]) -> _Beams:
        """Some columns of a scan, in the frame that the pose leads to."""
        azimuths = scan.azimuths[columns]
        along = pose[:3, 0, None] * np.cos(azimuths) + pose[:3, 1, None] * np.sin(azimuths)
        elevations = scan.elevations[:, None]
        return cls(
            np.cos(elevations).astype(np.float32),
            np.sin(elevations).astype(np.float32),
            along.astype(np.float32),
            pose.astype(np.float32),
        )

    def end_points(self, ranges: Coordinates, rows: slice) -> list[Coordinates]:
        """Three coordinates (rows, C) of where beams of some ranges (E, C) end [m]."""
        return [self._coordinate(ranges, rows, axis) for axis in range(3)]

    def _coordinate(self, ranges: Coordinates, rows: slice, axis: int) -> Coordinates:
        beam = self.level[rows] * self.along[axis]
        beam += self.up[rows] * self.pose[axis, 2]
        beam *= ranges[rows]
        beam += self.pose[axis, 3]
        return beam


def _of_pixels(picture: NDArray[Any], chosen: Mask) -> NDArray[Any]:
    """(N, 3) chosen pixels of a picture (H, W, 3), row by row, each moved in one piece."""
    pixels = picture.view(np.dtype((np.void, 3 * picture.itemsize)))[..., 0]
    return pixels[chosen].view(picture.dtype).reshape(-1, 3)
