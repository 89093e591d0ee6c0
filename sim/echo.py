"""What comes back from the beams of a scan: how strong, how exact, and whether at all."""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.noise import normal_noise

# ---- The noise of the VZ-400, all of it. One standard deviation each.
# Range: 3 mm precision (data sheet, as quoted by Sylva), rising as the root of the signal where that is weak. The 5 mm
# accuracy of the same sheet is a bias of the instrument's calibration, shared by all scans, and is left out; so is the
# pointing error of 0.0005 deg, 0.1 mm at 10 m.
PRECISION = 0.003
"""[m]"""
WEAK_SIGNAL = 0.1
"""Signal, relative to a white target square to the beam, below which the precision falls."""
WORST_PRECISION = 4.0
"""Largest factor on the precision: 8 to 12 mm is what users report from hard places (field notes of VZ-400 users)."""
REFLECTANCE_NOISE_DB = 0.7
RANGE_STEPS = 4000.0
"""Ranges are whole multiples of 0.25 mm, as Riegl's RDB files keep coordinates [1/m]."""
REFLECTANCE_STEPS = 10.0
"""Reflectances are whole multiples of 0.1 dB, a seventh of their noise [1/dB]; RDB files keep 0.01 dB."""
# ---- Its reach.
MIN_RANGE = 1.5
"""[m] (HELIOS++ data/scanners_tls.xml)"""
MAX_RANGE = 600.0
"""[m] on a target of 90 % reflectance, long-range mode; falls with the root of the signal, to 280 m at 20 %."""
MAX_RANGE_REFLECTANCE = 0.9

_BAND = 32
"""Rows of a scan worked on at a time, so that they stay in the processor's cache."""


class Hits(NamedTuple):
    """What the beams of a panorama meet."""

    inverse_range: NDArray[np.float32]
    """(E, A) [1/m], 0 where there is nothing."""
    cosine: NDArray[np.float32]
    """(E, A) of the angle of incidence."""
    geoms: NDArray[np.int32]
    """(E, A) geom ids; -1 for nothing, and for a flex or skin."""


@dataclass(frozen=True)
class Receiver:
    """How beams are received."""

    precision: float
    """Range noise, one sigma [m]; 0 with a `reflectance_noise` of 0 switches all noise off."""
    reflectance_noise: float
    """[dB]"""
    min_range: float
    """[m]"""
    max_range: float
    """[m]"""


def receive(
    hits: Hits, albedo_db: NDArray[np.float32], receiver: Receiver, rng: np.random.Generator
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Turn what the beams meet into what the instrument reports.

    Args:
        hits: of (E, A) beams.
        albedo_db: (ngeom + 1,) reflectance of each geom, square to the beam; the last one is for what is none [dB].
        receiver: how beams are received.
        rng: source of the noise; results do not depend on the number of cores.

    Returns:
        (E, A) ranges [m] and (E, A) reflectances [dB]; NaN where nothing came back.
    """
    ranges, reflectance = np.empty_like(hits.inverse_range), np.empty_like(hits.inverse_range)
    bands = [slice(start, min(start + _BAND, len(ranges))) for start in range(0, len(ranges), _BAND)]
    seeds = rng.integers(2**63, size=len(bands))

    def band(rows: slice, seed: int) -> None:
        with np.errstate(divide="ignore"):  # nothing is infinitely far, and infinitely dark
            np.divide(1, hits.inverse_range[rows], out=ranges[rows])
            np.log(hits.cosine[rows], out=reflectance[rows])
            reflectance[rows] *= np.float32(10 / np.log(10))  # Lambert's law
            reflectance[rows] += albedo_db[hits.geoms[rows]]
            _detect(ranges[rows], reflectance[rows], receiver, int(seed))

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        list(pool.map(band, bands, seeds))
    return ranges, reflectance


def _detect(ranges: NDArray[np.float32], reflectance: NDArray[np.float32], receiver: Receiver, seed: int) -> None:
    """Add the noise and drop what is too near, too far or too dark, in place."""
    amplitude = np.exp(reflectance * np.float32(np.log(10) / 20))  # root of the signal
    if receiver.precision or receiver.reflectance_noise:
        noise = normal_noise(seed, (2, *ranges.shape))
        noise[0] *= np.clip(np.float32(np.sqrt(WEAK_SIGNAL)) / amplitude, 1, WORST_PRECISION)
        noise[0] *= np.float32(receiver.precision)
        noise[1] *= np.float32(receiver.reflectance_noise)
        ranges += noise[0]
        reflectance += noise[1]
        _round(ranges, RANGE_STEPS)
        _round(reflectance, REFLECTANCE_STEPS)
    reach = amplitude * np.float32(receiver.max_range / np.sqrt(MAX_RANGE_REFLECTANCE))
    lost = (ranges < receiver.min_range) | (ranges > reach)
    ranges[lost] = np.nan
    reflectance[lost] = np.nan


def _round(values: NDArray[np.float32], steps: float) -> None:
    """To whole multiples of 1 / steps, in place."""
    values *= np.float32(steps)
    np.rint(values, out=values)
    values += np.float32(0)  # there is no -0
    values /= np.float32(steps)
