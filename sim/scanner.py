"""The Riegl VZ-400: beam patterns and scans."""

from __future__ import annotations

import math
from collections.abc import Collection
from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from sim.beams import BeamCaster
from sim.echo import REFLECTANCE_NOISE_DB, Receiver, receive
from sim.render.materials import materials_of
from sim.scan import ELEVATION_TOP_DEG, Scan, ScannerParameters

BEAMS_PER_SECOND = 122_000.0
"""Effective measurement rate in high-speed mode (data sheet)."""
DARKEST, BRIGHTEST = 0.02, 0.95
"""Limits of the reflectance of real surfaces in the near infrared."""


@dataclass(frozen=True)
class Pattern:
    """A regular grid of beams: azimuth all round, elevation from +60 to -40 deg."""

    rows: int
    """Beams from top to bottom."""
    columns: int
    """Beams all round."""

    def elevations(self) -> NDArray[np.float64]:
        """(rows,) elevation of each row, top first [rad]."""
        step = 2 * np.pi / self.columns
        top = math.radians(ELEVATION_TOP_DEG) - step / 2
        return np.linspace(top, top - (self.rows - 1) * step, self.rows)

    def azimuths(self) -> NDArray[np.float64]:
        """(columns,) azimuth of each column, anticlockwise from the scanner's x axis [rad]."""
        return np.arange(self.columns, dtype=np.float64) * (2 * np.pi / self.columns)


PATTERNS: dict[str, Pattern] = {
    "panorama_40": Pattern(rows=2500, columns=9000),
    "panorama_60": Pattern(rows=1667, columns=6000),
    "draft": Pattern(rows=500, columns=1800),
}
"""Riegl's names give the step in millidegrees; draft has 0.2 deg, for tests."""


class Scanner:
    """A VZ-400 in one world."""

    def __init__(
        self,
        model: mujoco.MjModel,
        parameters: ScannerParameters | None = None,
        *,
        hidden_bodies: Collection[int] = (),
    ) -> None:
        """Take a scanner into use.

        Args:
            model: the compiled world; shapes and colours are taken as they are now.
            parameters: how to scan.
            hidden_bodies: ids of bodies never seen, such as the robot that carries the scanner.
        """
        self.parameters = parameters or ScannerParameters()
        self._caster = BeamCaster(model, hidden_bodies)
        self._albedo_db = _albedo_db(model)
        self._receiver = Receiver(
            precision=self.parameters.precision if self.parameters.noise else 0.0,
            reflectance_noise=REFLECTANCE_NOISE_DB if self.parameters.noise else 0.0,
            min_range=self.parameters.min_range,
            max_range=self.parameters.max_range,
        )

    def scan(self, data: mujoco.MjData, world_from_scanner: NDArray[np.float64], rng: np.random.Generator) -> Scan:
        """Scan once all round.

        Args:
            data: state of the world, after `mj_kinematics` or more; it stands still during the scan.
            world_from_scanner: (4, 4) pose of the beams' origin.
            rng: source of the noise; the same state gives the same scan on any number of cores.
        """
        pattern = PATTERNS[self.parameters.pattern]
        elevations, azimuths = pattern.elevations(), pattern.azimuths()
        hits = self._caster.cast(data, world_from_scanner, elevations, azimuths)
        ranges, reflectance = receive(hits, self._albedo_db, self._receiver, rng)
        return Scan(elevations, azimuths, ranges, reflectance, ranges.size / BEAMS_PER_SECOND)


def _albedo_db(model: mujoco.MjModel) -> NDArray[np.float32]:
    """(ngeom + 1,) reflectance of each geom, square to the beam [dB]; the last one is for flexes and skins.

    An MJCF does not say how bright a surface is in the near infrared; the luminance of the geom's mean colour stands
    for it, one value a geom.
    """
    luminance = materials_of(model).colour @ np.array([0.2126, 0.7152, 0.0722], np.float32)
    return 10 * np.log10(np.clip(luminance, DARKEST, BRIGHTEST))
