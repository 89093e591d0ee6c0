"""Photographs per second of a full turn of the camera."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from mission.bench.speed.floor import render_photographs
from mission.bench.speed.timing import Timing, in_turns
from mission.bench.speed.worlds import World
from sim.camera import Camera

COLOURS, FLOOR, OURS = "bare colour renders", "bare colour, depth and flash renders", "door-mission"


def time_photographs(world: World, repeats: int) -> tuple[int, dict[str, Timing]]:
    """How many photographs a turn has, and the time of a turn: its renders alone, and all of it."""
    camera = Camera(world.renderer)
    parameters = camera.parameters
    contenders: dict[str, Callable[[], object]] = {
        COLOURS: lambda: render_photographs(world, parameters, colours_only=True),
        FLOOR: lambda: render_photographs(world, parameters),
        OURS: lambda: camera.photograph(world.data, world.world_from_scanner, np.random.default_rng(0)),
    }
    return parameters.shots, in_turns(contenders, repeats)
