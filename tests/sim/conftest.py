"""Worlds of a few geoms, compiled and ready."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import ExitStack

import mujoco
import numpy as np
import pytest
from numpy.typing import NDArray

from sim.render import Renderer

World = tuple[mujoco.MjModel, mujoco.MjData]


@pytest.fixture
def world() -> Callable[[str], World]:
    """Makes model and data from the inside of a worldbody, with assets before it if need be."""

    def build(geoms: str, assets: str = "") -> World:
        model = mujoco.MjModel.from_xml_string(
            f"<mujoco><asset>{assets}</asset><worldbody>{geoms}</worldbody></mujoco>"
        )
        data = mujoco.MjData(model)
        mujoco.mj_forward(model, data)
        return model, data

    return build


@pytest.fixture
def renderer_of() -> Iterator[Callable[..., Renderer]]:
    """Makes renderers that are closed after the test."""
    with ExitStack() as stack:
        yield lambda model, **kwargs: stack.enter_context(Renderer(model, **kwargs))


@pytest.fixture
def true_ranges() -> Callable[..., NDArray[np.float64]]:
    """Casts exact rays, past nothing: infinite where there is nothing."""

    def cast(world: World, origin: NDArray[np.float64], directions: NDArray[np.float64]) -> NDArray[np.float64]:
        model, data = world
        hit, ranges = np.empty(len(directions), np.int32), np.empty(len(directions))
        beams = np.ascontiguousarray(directions).ravel()
        mujoco.mj_multiRay(model, data, origin, beams, None, True, -1, hit, ranges, None, len(directions), 1e4)
        return np.where(hit < 0, np.inf, ranges)

    return cast
