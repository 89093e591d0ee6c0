"""What the mission keeps of a scan: a coarse range image, and points spread evenly over the surfaces, with normals."""

from __future__ import annotations

import math
import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray
from pydantic import Field

from mission.rigid import Pose, rotated, transformed
from sim.bands import bands
from sim.parameters import Parameters

if TYPE_CHECKING:
    from sim.scan import Scan

Image = NDArray[np.float64]


class SampleParameters(Parameters):
    """How a scan is thinned and where its normals come from."""

    step: float = Field(
        default=math.radians(0.24), ge=0.0005, le=0.02, description="pitch of the coarse range image [rad]"
    )
    window: float = Field(default=math.radians(1.7), ge=0.005, le=0.1, description="side of a normal's window [rad]")
    spacing: float = Field(default=0.03, ge=0.005, le=0.2, description="one point is kept in a cube of this side [m]")
    max_range: float = Field(default=30.0, gt=2, le=900, description="points beyond are not of this room [m]")
    roughness: float = Field(
        default=0.008, ge=0.001, le=0.1, description="largest residual (1 sigma) of a surface called flat [m]"
    )
    max_incidence: float = Field(
        default=math.radians(82), gt=0, lt=math.pi / 2, description="beyond it a normal is not trusted [rad]"
    )


@dataclass(frozen=True, eq=False)
class ScanSample:
    """A thinned scan, in the scanner frame."""

    points: NDArray[np.float32]
    """(N, 3) at most one point in a cube [m]; on flat surfaces drawn to the plane fitted there."""
    normals: NDArray[np.float32]
    """(N, 3) unit normals towards the scanner; NaN where the surface is not flat."""
    ranges: NDArray[np.float32]
    """(E, A) coarse range image [m], NaN where nothing came back."""
    elevations: NDArray[np.float64]
    """(E,) [rad], descending, evenly spaced."""
    azimuths: NDArray[np.float64]
    """(A,) [rad], ascending, evenly spaced."""

    def without_image(self) -> ScanSample:
        """The points alone: the range image has no rows."""
        return replace(self, ranges=self.ranges[:0].copy(), elevations=self.elevations[:0])


@dataclass(frozen=True, eq=False)
class PosedSample:
    """A scan sample at its place in the world."""

    sample: ScanSample
    world_from_scanner: Pose
    points_in_world: NDArray[np.float32]
    """(N, 3) [m]."""
    normals_in_world: NDArray[np.float32]
    """(N, 3) unit; NaN where the surface is not flat."""

    @property
    def scanner_in_world(self) -> NDArray[np.float64]:
        """(3,) origin of the beams [m]."""
        return self.world_from_scanner[:3, 3]


def place(sample: ScanSample, world_from_scanner: Pose) -> PosedSample:
    """Put a sample where its scan was taken."""
    return PosedSample(
        sample=sample,
        world_from_scanner=world_from_scanner,
        points_in_world=transformed(sample.points, world_from_scanner),
        normals_in_world=rotated(sample.normals, world_from_scanner),
    )


def sample_scan(scan: Scan, parameters: SampleParameters | None = None) -> ScanSample:
    """Thin a scan for registration, structure and voxels."""
    parameters = parameters or SampleParameters()
    rows = _stride(scan.elevations, parameters.step)
    columns = _stride(scan.azimuths, parameters.step)
    elevations = np.asarray(scan.elevations, float)[::rows]
    azimuths = np.asarray(scan.azimuths, float)[::columns]
    ranges = np.ascontiguousarray(scan.ranges[::rows, ::columns])

    smooth, normals = _planes(ranges, elevations, azimuths, parameters)
    seen = np.flatnonzero(np.isfinite(ranges) & (ranges < parameters.max_range))
    plane = smooth.ravel()[seen]
    flat = np.isfinite(plane)
    where = np.where(flat, plane, ranges.ravel()[seen])
    points = np.stack([axis.ravel()[seen] * where for axis in _directions(elevations, azimuths)], axis=1)
    kept = thinned(points, parameters.spacing, first=flat)
    return ScanSample(
        points=points[kept].astype(np.float32),
        normals=normals.reshape(-1, 3)[seen[kept]].astype(np.float32),
        ranges=ranges,
        elevations=elevations,
        azimuths=azimuths,
    )


def thinned(points: NDArray[np.floating], spacing: float, *, first: NDArray[np.bool_]) -> NDArray[np.intp]:
    """Ascending indices of one point a cube of side `spacing`: the earliest, but one of `first` where there is any."""
    count = len(points)
    if count == 0:
        return np.zeros(0, np.intp)
    key = np.zeros(count, np.int64)
    for axis in points.T:
        cube = np.floor(axis / spacing).astype(np.int64)
        cube -= cube.min()
        key *= cube.max() + 1
        key += cube
    order = np.argsort(key)
    key = key[order]
    cubes = np.flatnonzero(np.concatenate([[True], key[1:] != key[:-1]]))
    rank = np.arange(count) + count * ~first
    return np.sort(np.minimum.reduceat(rank[order], cubes) % count)


def _stride(angles: NDArray[np.floating], step: float) -> int:
    return max(1, int(round(step / abs(float(angles[1] - angles[0])))))


def _directions(elevations: NDArray[np.float64], azimuths: NDArray[np.float64]) -> tuple[Image, Image, Image]:
    """Unit vectors of the beams: three coordinates (E, A)."""
    level, up = np.cos(elevations)[:, None], np.sin(elevations)[:, None]
    return level * np.cos(azimuths), level * np.sin(azimuths), np.repeat(up, len(azimuths), axis=1)


def _planes(
    ranges: NDArray[np.float32],
    elevations: NDArray[np.float64],
    azimuths: NDArray[np.float64],
    parameters: SampleParameters,
) -> tuple[Image, Image]:
    """Ranges (E, A) of the planes fitted round each beam, and normals (E, A, 3); NaN where no plane fits.

    On a plane n.p = h a beam of direction d has the range h / (n.d): inverse range is linear in d, and the normal
    equations depend on the pattern alone (Badino et al., Fast and accurate computation of surface normals from range
    images, ICRA 2011). All is done in the frame of the beam's own azimuth, where they depend on the row alone.
    """
    pitch = abs(float(azimuths[1] - azimuths[0]))
    half = max(1, int(round(parameters.window / pitch / 2)))
    full_turn = abs(len(azimuths) * pitch - 2 * np.pi) < 1.5 * pitch
    around: NDArray[np.float64] = pitch * np.arange(-half, half + 1, dtype=np.float64)
    solver = _inverse_normal_matrices(elevations, around)
    smooth, normals = np.empty(ranges.shape), np.empty((*ranges.shape, 3))

    def fit(rows: slice) -> None:
        near = slice(max(rows.start - half, 0), rows.stop + half)
        inner = slice(rows.start - near.start, rows.stop - near.start)
        sums = [image[inner] for image in _window_sums(ranges[near], elevations[near], around, full_turn=full_turn)]
        smooth[rows], slopes = _fitted(sums, solver[rows], ranges[rows], elevations[rows], parameters, len(around))
        x, y, z = slopes
        c, s = np.cos(azimuths), np.sin(azimuths)
        for axis, component in enumerate((c * x - s * y, s * x + c * y, z)):
            normals[rows, :, axis] = component

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        list(pool.map(fit, bands(ranges.shape)))
    return smooth, normals


def _window_sums(
    ranges: NDArray[np.float32], elevations: NDArray[np.float64], around: NDArray[np.float64], *, full_turn: bool
) -> list[Image]:
    """Sums over the window of each beam: of inverse range x direction, of its square, and the number of returns."""
    from scipy.ndimage import correlate1d

    ones = np.ones(len(around))

    def windowed(image: Image, weights: NDArray[np.float64]) -> Image:
        rows = correlate1d(image, ones, axis=0, mode="constant")
        return correlate1d(rows, weights, axis=1, mode="wrap" if full_turn else "constant")

    inverse = np.nan_to_num(1 / ranges.astype(float), nan=0.0)
    level = inverse * np.cos(elevations)[:, None]
    return [
        windowed(level, np.cos(around)),
        windowed(level, np.sin(around)),
        windowed(inverse * np.sin(elevations)[:, None], ones),
        windowed(inverse**2, ones),
        windowed((inverse > 0).astype(float), ones),
    ]


def _fitted(
    sums: list[Image],
    solver: Image,
    ranges: NDArray[np.float32],
    elevations: NDArray[np.float64],
    parameters: SampleParameters,
    side: int,
) -> tuple[Image, list[Image]]:
    """Ranges of the planes, and their normals in the frame of each beam's azimuth; NaN where no plane fits."""
    *right, squares, returns = sums
    slopes = [sum(solver[:, k, i, None] * right[i] for i in range(3)) for k in range(3)]
    residual = squares - (slopes[0] * right[0] + slopes[1] * right[1] + slopes[2] * right[2])
    sigma = np.sqrt(np.maximum(residual, 0)) / side
    fitted = slopes[0] * np.cos(elevations)[:, None] + slopes[2] * np.sin(elevations)[:, None]
    length = np.sqrt(slopes[0] ** 2 + slopes[1] ** 2 + slopes[2] ** 2)
    with np.errstate(divide="ignore", invalid="ignore"):
        smooth = 1 / fitted
        flat = (sigma * smooth**2 < parameters.roughness) & (np.abs(smooth - ranges) < 4 * parameters.roughness)
        flat &= (returns > side**2 - 0.5) & (fitted > np.cos(parameters.max_incidence) * length)
        length[~flat] = np.nan
        return np.where(flat, smooth, np.nan), [-slope / length for slope in slopes]


def _inverse_normal_matrices(elevations: NDArray[np.float64], around: NDArray[np.float64]) -> Image:
    """(E, 3, 3) inverse of the sum of d d^T over the window of a beam in each row."""
    rows = sliding_window_view(np.pad(elevations, len(around) // 2, mode="reflect", reflect_type="odd"), len(around))
    e, a = rows[:, :, None], around[None, None, :]
    d = np.stack(np.broadcast_arrays(np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)), axis=-1)
    return np.linalg.inv(np.einsum("eijk,eijl->ekl", d, d))
