"""The floor: what MuJoCo's renderer would need for the pictures that scans and photographs can be made from.

Of these, ours renders the colours only: the rest is drawn on the sensors' own grids.
"""

from __future__ import annotations

import numpy as np

from mission.bench.speed.worlds import World
from sim.camera import FLASH
from sim.photo import CameraParameters
from sim.render import View, looking_along
from sim.scanner import Pattern

WEDGES = 6
"""Pictures that hold a panorama, of 60 deg each: their pixels are of about the same size everywhere."""


def render_panorama(world: World, pattern: Pattern) -> None:
    """Render six depth pictures with one pixel a beam in the middle of each, and throw them away."""
    density = pattern.columns / (2 * np.pi)  # pixels per unit of tangent
    half_width = np.tan(np.pi / WEDGES)
    bottom, top = np.tan(pattern.elevations()[[-1, 0]]) / np.cos(np.pi / WEDGES)  # reached in the corners
    size = int(np.ceil(2 * density * half_width)), int(np.ceil(density * (top - bottom)))
    for number in range(WEDGES):
        pose = world.world_from_scanner @ looking_along(number * 2 * np.pi / WEDGES)
        world.renderer.depth(world.data, View(pose, -half_width, half_width, bottom, top, *size))


def render_photographs(world: World, parameters: CameraParameters, *, colours_only: bool = False) -> None:
    """Render the colours of a turn of photographs, their depth and that seen from the flash, and throw them away."""
    size = parameters.width, parameters.height
    right, top = np.array(size) / 2 / parameters.focal_px
    for number in range(parameters.shots):
        pose = world.world_from_scanner @ looking_along(number * 2 * np.pi / parameters.shots)
        pose[2, 3] += parameters.rise
        world.renderer.albedo(world.data, View(pose, -right, right, -top, top, *size))
        if not colours_only:
            world.renderer.depth(world.data, View(pose, -right, right, -top, top, *size))
            pose[:3, 3] += FLASH[0] * pose[:3, 0] - FLASH[1] * pose[:3, 1]
            world.renderer.depth(world.data, View(pose, -right, right, -top, top, *size))
