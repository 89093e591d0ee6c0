"""The Riegl VZ-400: beam pattern, cast and noise."""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

import cv2
import mujoco
import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field

from sim.noise import normal_noise
from sim.render import Renderer, View, looking_along
from sim.render.jumps import blocks_across_jumps
from sim.render.materials import materials_of

# ---- Data of the instrument. Sources: HELIOS++ data/scanners_tls.xml (accuracy, minimum range), the VZ-400's data
# ---- sheet as quoted by Sylva and riegllms (precision, field of view, measurement rate, patterns).
ELEVATION_TOP_DEG = 60.0
"""Upper end of the field of view; the lower one is 100 deg below, at -40 deg."""
BEAMS_PER_SECOND = 122_000.0
"""Effective measurement rate in high-speed mode."""
WHITE_REFLECTANCE = 0.9
"""Reflectance of the target that the maximum range is stated for."""
# ---- Noise. One standard deviation; the 5 mm accuracy of the data sheet is a bias of the instrument's calibration,
# ---- shared by all beams of all scans, and is not simulated. Nor is the pointing error of 0.0005 deg: 0.1 mm at 10 m.
REFLECTANCE_NOISE_DB = 0.7
WEAK_RETURN = 0.1
"""Return, relative to a white target square to the beam, below which precision falls with the root of the signal."""
WORST_PRECISION = 4.0
"""Largest factor on the precision at weak returns: 8 to 12 mm is what users report from hard places."""
DARKEST, BRIGHTEST = 0.02, 0.95
"""Limits of the reflectance of real surfaces in the near infrared."""

_WEDGES = 6
"""A panorama is cast in six pictures of 60 deg each: all pixels of about the same size, and one table for all."""
_MARGIN_PX = 3
"""Pixels round a wedge that no beam needs, but its neighbours do."""
_DENSITY = 512, 1024
"""Fewest and most pixels per unit of tangent, which is per radian in the middle of a picture."""
_BAND = 32
"""Rows of a scan that are worked on at a time, so that they stay in the processor's cache."""


@dataclass(frozen=True)
class Pattern:
    """A regular grid of beams: azimuth all round, elevation from +60 to -40 deg."""

    rows: int
    """Beams from top to bottom."""
    columns: int
    """Beams all round; a multiple of 6."""

    def elevations(self) -> NDArray[np.float64]:
        """(rows,) elevation of each row, top first [rad]."""
        step = 2 * np.pi / self.columns
        return np.radians(ELEVATION_TOP_DEG) - (np.arange(self.rows) + 0.5) * step

    def azimuths(self) -> NDArray[np.float64]:
        """(columns,) azimuth of each column, anticlockwise from the scanner's x axis [rad]."""
        return np.arange(self.columns) * (2 * np.pi / self.columns)


PATTERNS: dict[str, Pattern] = {
    "panorama_40": Pattern(rows=2500, columns=9000),
    "panorama_60": Pattern(rows=1667, columns=6000),
    "draft": Pattern(rows=500, columns=1800),
}
"""Riegl's names give the step in millidegrees; draft has 0.2 deg, for tests."""


class ScannerParameters(BaseModel):
    """How the scanner is used."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    pattern: Literal["panorama_40", "panorama_60", "draft"] = Field("panorama_60", description="Grid of beams.")
    noise: bool = Field(True, description="Range and reflectance noise; off gives exact ranges.")
    precision: float = Field(0.003, ge=0, le=0.1, description="Range noise, one sigma [m] (data sheet).")
    range_min: float = Field(1.5, gt=0.1, description="Nearest range measured [m] (HELIOS++).")
    range_max: float = Field(600.0, le=900, description="Farthest range on a 90 % target, long-range mode [m].")


@dataclass(frozen=True, eq=False)
class Scan:
    """What the instrument delivers: a panorama in its own frame (x forward, z up, origin where the beams start)."""

    elevations: NDArray[np.float64]
    """(E,) elevation of each row, descending [rad]."""
    azimuths: NDArray[np.float64]
    """(A,) azimuth of each column, anticlockwise from x [rad]."""
    ranges: NDArray[np.float32]
    """(E, A) distance [m]; NaN = no return."""
    reflectance: NDArray[np.float32]
    """(E, A) reflectance relative to a white target square to the beam [dB]; NaN = no return."""
    duration: float
    """Time that the scan took [s]."""

    @property
    def hits(self) -> NDArray[np.bool_]:
        """(E, A) True where there was a return; `array[scan.hits]` is in the order of `points()`."""
        return ~np.isnan(self.ranges)

    def points(self) -> NDArray[np.float32]:
        """(N, 3) points of all returns in the scanner frame [m], row by row."""
        hits = self.hits
        points = np.empty((np.count_nonzero(hits), 3), np.float32)
        across = self.ranges * np.cos(self.elevations).astype(np.float32)[:, None]
        points[:, 0] = (across * np.cos(self.azimuths).astype(np.float32))[hits]
        points[:, 1] = (across * np.sin(self.azimuths).astype(np.float32))[hits]
        points[:, 2] = (self.ranges * np.sin(self.elevations).astype(np.float32)[:, None])[hits]
        return points


class Scanner:
    """A VZ-400 in one world."""

    def __init__(self, renderer: Renderer, parameters: ScannerParameters | None = None) -> None:
        """Takes a scanner into use.

        Args:
            renderer: of the world; what it hides, the scanner does not see.
            parameters: how to scan.
        """
        self.parameters = parameters or ScannerParameters()
        self._renderer = renderer
        self._albedo_db = _albedo_db(renderer.model)

    def scan(self, data: mujoco.MjData, world_from_scanner: NDArray[np.float64], rng: np.random.Generator) -> Scan:
        """Scans once all round.

        Args:
            data: state of the world; it stands still during the scan.
            world_from_scanner: (4, 4) pose of the beams' origin.
            rng: source of the noise; the same state gives the same scan on any number of cores.
        """
        pattern = PATTERNS[self.parameters.pattern]
        inverse_range, albedo_db = self._cast(data, world_from_scanner, pattern)
        ranges, reflectance = _measure(inverse_range, albedo_db, pattern, self.parameters, rng)
        duration = pattern.rows * pattern.columns / BEAMS_PER_SECOND
        return Scan(pattern.elevations(), pattern.azimuths(), ranges, reflectance, duration)

    def _cast(
        self, data: mujoco.MjData, world_from_scanner: NDArray[np.float64], pattern: Pattern
    ) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """(E, A) inverse range [1/m], exact; and (E, A) reflectance of what was hit, square to the beam [dB]."""
        wedge = _wedge(pattern)
        renderer = self._renderer
        inverse_range = np.empty((pattern.rows, pattern.columns), np.float32)
        reflectance = np.empty_like(inverse_range)
        for k in range(_WEDGES):
            columns = slice(k * wedge.columns, (k + 1) * wedge.columns)
            depth = renderer.depth(data, wedge.view(world_from_scanner, k))
            raw = wedge.sample(depth.raw)
            raw += np.float32(renderer.inverse_depth_offset / renderer.inverse_depth_scale)
            inverse_range[:, columns] = cv2.multiply(raw, wedge.cosine, scale=renderer.inverse_depth_scale)
            segments = cv2.remap(depth.segments, wedge.map_x, wedge.map_y, cv2.INTER_NEAREST)
            reflectance[:, columns] = self._albedo_db[depth.geom_ids][segments]
        return inverse_range, reflectance


@dataclass(frozen=True, eq=False)
class _Wedge:
    """A sixth of a panorama as a picture: where each beam pierces it."""

    columns: int
    azimuth: float
    """Of the middle of the first wedge [rad]."""
    half_width: float
    """Of the window at unit distance."""
    bottom: float
    top: float
    width: int
    """[px]"""
    height: int
    """[px]"""
    map_x: NDArray[np.float32]
    """(E, columns) column of each beam in the picture, pixel centres at whole numbers [px]."""
    map_y: NDArray[np.float32]
    """(E, columns) row, counted from the bottom [px]."""
    cosine: NDArray[np.float32]
    """(E, columns) of the angle between beam and optical axis."""
    block: NDArray[np.int32]
    """(E, columns) flat index of the lower left of the four pixels round the beam."""

    def view(self, world_from_scanner: NDArray[np.float64], number: int) -> View:
        pose = world_from_scanner @ looking_along(self.azimuth + number * 2 * np.pi / _WEDGES)
        return View(pose, -self.half_width, self.half_width, self.bottom, self.top, self.width, self.height)

    def sample(self, raw: NDArray[np.float32]) -> NDArray[np.float32]:
        """(E, columns) raw depth at the beams: bilinear on a surface, the nearest pixel's where two surfaces meet."""
        values = cv2.remap(raw, self.map_x, self.map_y, cv2.INTER_LINEAR)
        at_jump = np.flatnonzero(blocks_across_jumps(raw).ravel()[self.block])
        x, y = np.rint(self.map_x.ravel()[at_jump]), np.rint(self.map_y.ravel()[at_jump])
        values.ravel()[at_jump] = raw[y.astype(np.intp), x.astype(np.intp)]
        return values


@lru_cache(maxsize=2)
def _wedge(pattern: Pattern) -> _Wedge:
    """The tables of a pattern; they depend on nothing else."""
    columns = pattern.columns // _WEDGES
    azimuths = pattern.azimuths()[:columns]
    middle = float(azimuths.mean())
    cos_azimuth, tan_azimuth = np.cos(azimuths - middle), np.tan(azimuths - middle)
    elevations = pattern.elevations()[:, None]
    heights = np.tan(elevations) / cos_azimuth
    density = np.clip(pattern.columns / (2 * np.pi), *_DENSITY)  # pixels per unit of tangent: one a beam, in the middle
    width = 2 * int(np.ceil(density * tan_azimuth.max() + _MARGIN_PX))
    bottom, top = (int(np.ceil(density * edge + _MARGIN_PX)) for edge in (-heights.min(), heights.max()))
    map_x = np.broadcast_to(width / 2 - density * tan_azimuth - 0.5, heights.shape)  # azimuth runs to the left
    map_y = bottom + density * heights - 0.5  # -0.5: from pixel edges, as OpenGL counts, to OpenCV's centres
    return _Wedge(
        columns=columns,
        azimuth=middle,
        half_width=width / 2 / density,
        bottom=-bottom / density,
        top=top / density,
        width=width,
        height=bottom + top,
        map_x=map_x.astype(np.float32),
        map_y=map_y.astype(np.float32),
        cosine=(np.cos(elevations) * cos_azimuth).astype(np.float32),
        block=(np.floor(map_y).astype(np.int32) * width + np.floor(map_x).astype(np.int32)),
    )


def _albedo_db(model: mujoco.MjModel) -> NDArray[np.float32]:
    """(ngeom + 1,) reflectance of each geom, square to the beam [dB].

    The near infrared is not in an MJCF; the luminance of the geom's mean colour stands for it.
    """
    luminance = materials_of(model).colour @ np.float32([0.2126, 0.7152, 0.0722])
    return 10 * np.log10(np.clip(luminance, DARKEST, BRIGHTEST))


def _measure(
    inverse_range: NDArray[np.float32],
    albedo_db: NDArray[np.float32],
    pattern: Pattern,
    parameters: ScannerParameters,
    rng: np.random.Generator,
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """(E, A) ranges [m] and reflectances [dB] as the instrument reports them, from the exact picture."""
    ranges = np.empty_like(inverse_range)
    seeds = rng.integers(2**63, size=-(-pattern.rows // _BAND))
    cos_elevations = np.cos(pattern.elevations()).astype(np.float32)[:, None]

    def band(number: int) -> None:
        rows = slice(number * _BAND, min((number + 1) * _BAND, pattern.rows))
        spread = _incidence_tan2(inverse_range, rows, cos_elevations[rows], 2 * np.pi / pattern.columns)
        reflectance = albedo_db[rows] - np.float32(5 / np.log(10)) * np.log1p(spread)  # 10 log10(rho cos i)
        ranges[rows], albedo_db[rows] = _deliver(1 / inverse_range[rows], reflectance, parameters, int(seeds[number]))

    with ThreadPoolExecutor(os.cpu_count()) as pool:  # a seed a band: no result depends on who works it out
        list(pool.map(band, range(len(seeds))))
    return ranges, albedo_db


def _incidence_tan2(
    inverse_range: NDArray[np.float32], rows: slice, cos_elevations: NDArray[np.float32], step: float
) -> NDArray[np.float32]:
    """(rows, A) squared tangent of the incidence angle.

    On a plane with normal n at distance d the inverse range is n.dir / d, so that its slopes over elevation and
    azimuth are the tangential components of n. Of the two one-sided differences the smaller one stays on the surface.
    """
    here = inverse_range[rows]
    up, down = max(rows.start - 1, 0), min(rows.stop + 1, len(inverse_range))
    rise = np.abs(np.diff(inverse_range[up:down], axis=0))
    rise = np.vstack([rise[:1]] * (up == rows.start) + [rise] + [rise[-1:]] * (down == rows.stop))
    run = np.abs(here - np.roll(here, 1, axis=1))
    rise = np.minimum(rise[:-1], rise[1:])
    run = np.minimum(run, np.roll(run, -1, axis=1))
    run /= cos_elevations
    rise *= rise
    run *= run
    run += rise
    run /= here * here * np.float32(step**2)
    return run


def _deliver(
    ranges: NDArray[np.float32],
    reflectance: NDArray[np.float32],
    parameters: ScannerParameters,
    seed: int,
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Adds the noise and drops what is too near, too far or too dark to return."""
    amplitude = np.exp(reflectance * np.float32(np.log(10) / 20))  # root of the signal
    reach = amplitude * np.float32(parameters.range_max / np.sqrt(WHITE_REFLECTANCE))
    if parameters.noise:
        loss = np.clip(np.float32(np.sqrt(WEAK_RETURN)) / amplitude, 1, WORST_PRECISION)
        noise = normal_noise(seed, (2, *ranges.shape))
        loss *= noise[0]
        loss *= np.float32(parameters.precision)
        ranges += loss
        noise[1] *= np.float32(REFLECTANCE_NOISE_DB)
        reflectance += noise[1]
    lost = (ranges < parameters.range_min) | (ranges > reach)
    ranges[lost] = np.nan
    reflectance[lost] = np.nan
    return ranges, reflectance
