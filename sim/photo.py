"""What the Nikon D90 delivers, and how it is used: plain data, free of the simulator."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from sim.parameters import Parameters

SENSOR = 0.0158, 0.0236
"""Width and height of the sensor, upright [m] (manual, p. 248)."""


class CameraParameters(Parameters):
    """How the camera is used."""

    width: int = Field(default=712, ge=16, le=2848, description="Picture width, upright [px]; the D90 has 2848.")
    height: int = Field(default=1072, ge=16, le=4288, description="Picture height [px]; the D90 has 4288.")
    shots: int = Field(default=10, ge=7, le=36, description="Photographs a turn: 7 overlap by 10 %, 10 by 39 %.")
    focal_length: float = Field(default=0.014, ge=0.010, le=0.085, description="[m]")
    rise: float = Field(
        default=0.20, ge=0, le=1, description="Camera centre above the scanner's beams, on its axis [m]."
    )
    ambient: float = Field(default=0.5, ge=0, le=100, description="Light in the room, relative to the flash's at 3 m.")
    noise: bool = Field(default=True, description="Photon and read noise.")

    @property
    def focal_px(self) -> tuple[float, float]:
        """Focal length over the pixel pitch, horizontally and vertically [px]."""
        return self.focal_length / SENSOR[0] * self.width, self.focal_length / SENSOR[1] * self.height


@dataclass(frozen=True, eq=False)
class Photo:
    """One photograph, with the calibration that a user of the camera knows."""

    image: NDArray[np.uint8]
    """(H, W, 3) sRGB, top row first."""
    intrinsics: NDArray[np.float64]
    """(3, 3) pinhole matrix [px] in OpenCV's axes: x right, y down, z forward; the centre of the first pixel is at
    (0.5, 0.5)."""
    scanner_from_camera: NDArray[np.float64]
    """(4, 4) pose of the camera in the scanner's frame at this shot."""
    true_gloss: NDArray[np.uint8]
    """(H, W) levels by which the mirror image of the flash brightens the picture, in the mean of the channels: 0 where
    there is none, where the matt light alone is white, and on sheen. Truth, for tests and benchmarks only."""
