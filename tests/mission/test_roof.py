"""What is overhead, from points on surfaces of known height."""

from __future__ import annotations

import numpy as np
import pytest

from mission.roof import Roof


def surface(x: tuple[float, float], y: tuple[float, float], z: float, slope: float = 0.0) -> np.ndarray:
    """(N, 3) points every 3 cm, rising by `slope` along x."""
    at = np.stack(np.meshgrid(np.arange(*x, 0.03), np.arange(*y, 0.03)), axis=-1).reshape(-1, 2)
    return np.column_stack([at, z + slope * (at[:, 0] - x[0])])


def roof_of(points: np.ndarray, up: float = -1.0) -> Roof:
    return Roof(points, np.tile([0, 0, up], (len(points), 1)), lowest=1.8, least_area=1.0)


def test_a_sloping_roof_has_its_height_at_every_place() -> None:
    heights = roof_of(surface((0, 4), (0, 4), 2.0, slope=0.5)).height_over(np.array([[1.0, 2.0], [3.0, 2.0], [6, 2]]))

    # 2.5 and 3.5 m; the lowest within 35 cm is up to 0.35 x 0.5 lower
    assert 2.3 < heights[0] <= 2.5 and 3.3 < heights[1] <= 3.5
    assert heights[2] == np.inf


def test_the_underside_of_a_lintel_is_no_roof() -> None:
    ceiling, lintel = surface((0, 4), (0, 4), 2.6), surface((1, 2), (-0.4, 0.0), 2.1)  # 16 and 0.4 m2
    heights = roof_of(np.concatenate([ceiling, lintel])).height_over(np.array([[1.5, 0.1], [1.5, -0.4]]))

    assert heights[0] == pytest.approx(2.6)
    assert heights[1] == np.inf


def test_the_top_of_a_cabinet_is_no_roof() -> None:
    assert roof_of(surface((0, 2), (0, 2), 2.0), up=1.0).height_over(np.array([[1.0, 1.0]]))[0] == np.inf
