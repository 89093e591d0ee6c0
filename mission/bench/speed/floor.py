"""The floor: what MuJoCo's renderer needs for the depth pictures that hold a panorama."""

from __future__ import annotations

import numpy as np

from mission.bench.speed.worlds import World
from sim.render import View, looking_along
from sim.scanner import Pattern

WEDGES = 6
"""Pictures of 60 deg: their pixels are of about the same size everywhere."""


def bare_renders(world: World, pattern: Pattern) -> None:
    """Render six depth pictures with one pixel a beam in the middle of each, and throw them away."""
    density = pattern.columns / (2 * np.pi)  # pixels per unit of tangent
    half_width = np.tan(np.pi / WEDGES)
    bottom, top = np.tan(pattern.elevations()[[-1, 0]]) / np.cos(np.pi / WEDGES)  # reached in the corners
    size = int(np.ceil(2 * density * half_width)), int(np.ceil(density * (top - bottom)))
    for number in range(WEDGES):
        pose = world.world_from_scanner @ looking_along(number * 2 * np.pi / WEDGES)
        world.renderer.depth(world.data, View(pose, -half_width, half_width, bottom, top, *size))
