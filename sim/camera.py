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
from sim.photo import CameraParameters, Photo
from sim.render import Depth, Renderer, View, looking_along
from sim.render.materials import materials_of
from sim.shading import NEIGHBOURS, Gloss, Window, flash_light, seen_from_flash

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
        self._materials = materials_of(renderer.model)
        self._window = _window(self.parameters)

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
        with ThreadPoolExecutor(os.cpu_count()) as pool:  # shading goes on while the next shot is rendered
            pending = [pool.submit(self._shade, *self._render(data, world_from_scanner @ pose)) for pose in poses]
            exposed = [shot.result() for shot in pending]
            gain = _gain(exposed)
            return tuple(pool.map(lambda k: self._develop(exposed[k], gain, poses[k], int(seeds[k])), range(shots)))

    def bare_renders(
        self, data: mujoco.MjData, world_from_scanner: NDArray[np.float64], *, colours_only: bool = False
    ) -> None:
        """Render the pictures that `photograph` works on, and throw them away: what none can do without.

        Args:
            data: state of the world.
            world_from_scanner: (4, 4) pose of the scanner under the camera.
            colours_only: leave out the depth from the lens and from the flash.
        """
        for k in range(self.parameters.shots):
            pose = world_from_scanner @ self._scanner_from_camera(2 * np.pi * k / self.parameters.shots)
            if colours_only:
                self._renderer.albedo(data, self._view(pose, margin=(0, 0)))
            else:
                self._render(data, pose)

    def _scanner_from_camera(self, azimuth: float) -> NDArray[np.float64]:
        pose = looking_along(azimuth)
        pose[2, 3] = self.parameters.rise
        return pose

    def _render(
        self, data: mujoco.MjData, world_from_camera: NDArray[np.float64]
    ) -> tuple[NDArray[np.uint8], Depth, Depth]:
        """Albedo and depth from the lens, and depth from the flash through a window wider by the margin."""
        lens = self._view(world_from_camera, margin=(0, 0))
        world_from_flash = world_from_camera.copy()
        world_from_flash[:3, 3] += world_from_camera[:3, :3] @ [FLASH[0], -FLASH[1], 0]  # OpenCV's y is down
        flash = self._view(world_from_flash, margin=self._margin)
        renderer = self._renderer
        return renderer.albedo(data, lens), renderer.depth(data, lens), renderer.depth(data, flash)

    def _view(self, world_from_view: NDArray[np.float64], margin: tuple[int, int]) -> View:
        width, height = self.parameters.width + 2 * margin[0], self.parameters.height + 2 * margin[1]
        focal_x, focal_y = self.parameters.focal_px
        across, up = width / 2 / focal_x, height / 2 / focal_y
        return View(world_from_view, -across, across, -up, up, width, height)

    @property
    def _margin(self) -> tuple[int, int]:
        """Columns and rows of parallax between lens and flash at the nearest surface [px]."""
        focal_x, focal_y = self.parameters.focal_px
        return math.ceil(focal_x * abs(FLASH[0]) / _NEAREST) + 1, math.ceil(focal_y * abs(FLASH[1]) / _NEAREST) + 1

    def _shade(self, albedo: NDArray[np.uint8], lens: Depth, flash: Depth) -> Exposure:
        """Light a rendered shot, band by band; in any thread, as no two shots share anything."""
        scale = np.float32(self._renderer.inverse_depth_scale)
        offset = np.float32(self._renderer.inverse_depth_offset)
        specular, exponent = self._materials.specular[lens.geom_ids], self._materials.exponent[lens.geom_ids]
        flash_inverse_depth = flash.raw * scale + offset
        ambient = np.float32(self.parameters.ambient / AMBIENT_DISTANCE**2)
        height, width = lens.raw.shape
        light, gloss = np.empty((2, height, width), np.float32)
        mirrors = np.empty((height, width), bool)
        for rows in bands(lens.raw.shape):
            near = slice(max(rows.start - NEIGHBOURS, 0), rows.stop + NEIGHBOURS)
            inner = slice(rows.start - near.start, rows.stop - near.start)
            inverse_depth = lens.raw[near] * scale + offset
            window = self._window.part(near)
            first = self._margin[0], self._margin[1] + near.start
            seen = seen_from_flash(inverse_depth, flash_inverse_depth, FLASH, window, first)
            shine = Gloss(specular.take(lens.segments[near]), exponent.take(lens.segments[near]))
            lit = flash_light(inverse_depth, seen, FLASH, window, shine)
            light[rows], gloss[rows] = lit.diffuse[inner] + ambient, lit.gloss[inner]
            mirrors[rows] = shine.exponent[inner] > SHEEN
        return Exposure(albedo, light, gloss, mirrors)

    def _develop(self, exposed: Exposure, gain: float, scanner_from_camera: NDArray[np.float64], seed: int) -> Photo:
        image, true_gloss = develop(exposed, gain, seed if self.parameters.noise else None)
        focal_x, focal_y = self.parameters.focal_px
        height, width = true_gloss.shape
        intrinsics = np.array([[focal_x, 0, width / 2], [0, focal_y, height / 2], [0, 0, 1]])
        return Photo(image, intrinsics, scanner_from_camera, true_gloss)


def _window(parameters: CameraParameters) -> Window:
    focal_x, focal_y = parameters.focal_px
    across = (np.arange(parameters.width) + 0.5 - parameters.width / 2) / focal_x
    up = (np.arange(parameters.height) + 0.5 - parameters.height / 2) / focal_y
    return Window(focal_x, focal_y, across.astype(np.float32)[None], up.astype(np.float32)[:, None])


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
