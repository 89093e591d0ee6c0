"""The Nikon D90 with its built-in flash, on top of the scanner: photographs of a full turn."""

from __future__ import annotations

import math
import os
from concurrent.futures import ThreadPoolExecutor

import mujoco
import numpy as np
from numpy.typing import NDArray

from sim.bands import bands
from sim.developing import Exposure, develop, linear
from sim.facets import picture
from sim.photo import CameraParameters, Photo
from sim.render import Renderer, View, looking_along
from sim.render.materials import materials_of
from sim.shading import Gloss, Window, flash_light, seen_from_flash
from sim.sight import Sight
from sim.surfaces import Surfaces

GUIDE_NUMBER = 17.0
"""Aperture x distance of a right exposure by the built-in flash at full power, ISO 200 [m]."""
APERTURES = 2.8, 22.0
"""Widest and narrowest aperture of the 14 mm lens."""
FLASH = -0.09, 0.0
"""Flash right of and above the lens [m]: held upright, the camera has its flash at the left side."""
BRIGHT_SHARE, BRIGHT_LEVEL = 0.98, 0.9
"""The turn is exposed so that this share of what it shows stays below this part of full scale in every channel."""
AMBIENT_DISTANCE = 3.0
"""Distance of the flash that ambient light is measured against [m]."""

SHEEN = 20.0
"""Exponent of a gloss lobe that has fallen to half its height 15 deg off the mirror direction. A wider one, as of matt
paint, lights a wall as evenly as matt light does, and is no highlight."""

_NEAREST = 0.5
"""Nearest surface that the flash's view covers up to the edge of the picture [m]."""
_CAMERA_FROM_VIEW = np.array([[0, 0, 1, 0], [0, -1, 0, 0], [1, 0, 0, 0], [0, 0, 0, 1]], float)
"""OpenCV's axes, right, down and forward, from those of a grid of beams: forward, up, right."""


class Camera:
    """A D90 in one world.

    Glass is let through, like everything less than half opaque. Vignetting counts as corrected by the raw converter.
    """

    def __init__(self, renderer: Renderer, parameters: CameraParameters | None = None) -> None:
        """Take a camera into use.

        Args:
            renderer: of the world; what it hides, the camera does not see.
            parameters: how to photograph.
        """
        self.parameters = parameters or CameraParameters()
        self._renderer = renderer
        self._surfaces = Surfaces(renderer.model, renderer.hidden_bodies)
        self._materials = materials_of(renderer.model)
        across, up = (tangents.astype(np.float32) for tangents in _tangents(self.parameters))
        self._window = Window(*self.parameters.focal_px, across[None], up[:, None])

    def photograph(
        self, data: mujoco.MjData, world_from_scanner: NDArray[np.float64], rng: np.random.Generator
    ) -> tuple[Photo, ...]:
        """Photograph once all round, anticlockwise from the scanner's x axis, all with one exposure.

        Args:
            data: state of the world.
            world_from_scanner: (4, 4) true pose of the scanner under the camera.
            rng: source of the sensor noise.
        """
        shots = self.parameters.shots
        seeds = rng.integers(2**63, size=shots)
        poses = [self._scanner_from_camera(2 * np.pi * k / shots) for k in range(shots)]
        with ThreadPoolExecutor(os.cpu_count()) as pool:  # shots are lit while the next one's colours are rendered
            turn = [world_from_scanner @ pose for pose in poses]
            pending = [pool.submit(self._expose, self._albedo(data, pose), data, pose) for pose in turn]
            exposed = [shot.result() for shot in pending]
            gain = _gain(exposed)
            return tuple(pool.map(lambda k: self._develop(exposed[k], gain, poses[k], int(seeds[k])), range(shots)))

    def _scanner_from_camera(self, azimuth: float) -> NDArray[np.float64]:
        pose = looking_along(azimuth)
        pose[2, 3] = self.parameters.rise
        return pose

    def _albedo(self, data: mujoco.MjData, world_from_camera: NDArray[np.float64]) -> NDArray[np.uint8]:
        """(H, W, 3) sRGB of the surfaces, top row first."""
        size = self.parameters.width, self.parameters.height
        right, top = np.array(size) / 2 / self.parameters.focal_px
        return self._renderer.albedo(data, View(world_from_camera, -right, right, -top, top, *size))[::-1].copy()

    def _expose(
        self, albedo: NDArray[np.uint8], data: mujoco.MjData, world_from_camera: NDArray[np.float64]
    ) -> Exposure:
        """Light a shot; in any thread, as no two shots share anything."""
        world_from_flash = world_from_camera.copy()
        world_from_flash[:3, 3] += world_from_camera[:3, :3] @ [FLASH[0], -FLASH[1], 0]  # OpenCV's y is down
        rows = slice(0, self.parameters.height + 2 * self._margin[1])
        flash_inverse_depth = self._sight(data, world_from_flash, self._margin).inverse_ranges(rows)
        lens = self._sight(data, world_from_camera)
        materials, ambient = self._materials, np.float32(self.parameters.ambient / AMBIENT_DISTANCE**2)
        light, gloss = np.empty((2, *albedo.shape[:2]), np.float32)
        mirrors = np.empty(albedo.shape[:2], bool)
        for rows in bands(albedo.shape):
            seen, window = lens.seen(rows), self._window.part(rows)
            first = self._margin[0], self._margin[1] + rows.start
            reached = seen_from_flash(seen.inverse_range, flash_inverse_depth, FLASH, window, first)
            shine = Gloss(*(table.take(seen.geoms, mode="wrap") for table in (materials.specular, materials.exponent)))
            lit = flash_light(seen, reached, FLASH, window, shine)
            light[rows], gloss[rows], mirrors[rows] = lit.diffuse + ambient, lit.gloss, shine.exponent > SHEEN
        return Exposure(albedo, light, gloss, mirrors)

    def _sight(
        self, data: mujoco.MjData, world_from_camera: NDArray[np.float64], margin: tuple[int, int] = (0, 0)
    ) -> Sight:
        """The rows of a picture, larger than a photograph by a margin, as columns of beams."""
        across, up = _tangents(self.parameters, margin)
        return Sight(self._surfaces, data, world_from_camera @ _CAMERA_FROM_VIEW, picture(up, across))

    @property
    def _margin(self) -> tuple[int, int]:
        """Columns and rows of parallax between lens and flash at the nearest surface [px]."""
        focal_x, focal_y = self.parameters.focal_px
        return math.ceil(focal_x * abs(FLASH[0]) / _NEAREST) + 1, math.ceil(focal_y * abs(FLASH[1]) / _NEAREST) + 1

    def _develop(self, exposed: Exposure, gain: float, scanner_from_camera: NDArray[np.float64], seed: int) -> Photo:
        image, true_gloss = develop(exposed, gain, seed if self.parameters.noise else None)
        focal_x, focal_y = self.parameters.focal_px
        height, width = true_gloss.shape
        intrinsics = np.array([[focal_x, 0, width / 2], [0, focal_y, height / 2], [0, 0, 1]])
        return Photo(image, intrinsics, scanner_from_camera, true_gloss)


def _tangents(
    parameters: CameraParameters, margin: tuple[int, int] = (0, 0)
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Of the pixels' centres, columns to the right and rows upward, so many more of them to either side."""
    (focal_x, focal_y), (width, height) = parameters.focal_px, (parameters.width, parameters.height)
    across = (np.arange(-margin[0], width + margin[0], dtype=np.float64) + 0.5 - width / 2) / focal_x
    up = (height / 2 - 0.5 - np.arange(-margin[1], height + margin[1], dtype=np.float64)) / focal_y
    return across, up


def _gain(shots: list[Exposure]) -> float:
    """Part of full scale that a white surface square to the full flash at 1 m would fill: (guide number / aperture)^2.

    Colours of several photographs are merged, so all shots of a turn share it. The light of the gloss is left out: it
    may clip, as in life.
    """
    samples = [linear(shot.albedo[::8, ::8].max(axis=2)) * shot.light[::8, ::8] for shot in shots]
    brightness = np.concatenate([sample[sample > 0] for sample in samples])
    lowest, highest = ((GUIDE_NUMBER / aperture) ** 2 for aperture in reversed(APERTURES))
    if not len(brightness):
        return highest
    return float(np.clip(BRIGHT_LEVEL / np.quantile(brightness, BRIGHT_SHARE), lowest, highest))
