"""Photographs per second of a full turn of the camera."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from mission.bench.speed.timing import Timing, in_turns
from mission.bench.speed.worlds import World
from sim.camera import Camera

COLOURS, FLOOR, OURS = "bare colour renders", "bare colour, depth and flash renders", "door-mission"


def time_photographs(world: World, repeats: int) -> tuple[int, dict[str, Timing]]:
    """How many photographs a turn has, and the time of a turn: its renders alone, and all of it."""
    camera = Camera(world.renderer)
    shots = camera.parameters.shots
    contenders: dict[str, Callable[[], object]] = {
        COLOURS: lambda: camera.bare_renders(world.data, world.world_from_scanner, colours_only=True),
        FLOOR: lambda: camera.bare_renders(world.data, world.world_from_scanner),
        OURS: lambda: camera.photograph(world.data, world.world_from_scanner, np.random.default_rng(0)),
    }
    return shots, in_turns(contenders, repeats)
