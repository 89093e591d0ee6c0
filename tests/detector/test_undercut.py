"""The lower edge of a leaf from the heights of points near its plane: 20 points a millimetre, 1 mm of noise."""

from __future__ import annotations

import numpy as np
import pytest

from detector.undercut import lower_edge


def heights(undercut: float, *, floor_points: int = 800) -> np.ndarray:
    """(N,) points of a leaf from its undercut up to 0.12 m [m], and of the floor at its foot."""
    rng = np.random.default_rng(1)
    leaf = rng.uniform(undercut, 0.12, round(20e3 * (0.12 - undercut)))
    floor = np.zeros(floor_points)
    return (np.concatenate([leaf, floor]) + rng.normal(0, 0.001, len(leaf) + floor_points)).astype(np.float32)


@pytest.mark.parametrize("undercut", [0.005, 0.008, 0.015, 0.03])
def test_the_lower_edge_of_a_leaf_is_found_to_a_millimetre(undercut: float) -> None:
    assert lower_edge(heights(undercut)) == pytest.approx(undercut, abs=0.001)


def test_where_the_floor_is_hidden_the_leaf_alone_shows_its_edge() -> None:
    assert lower_edge(heights(0.01, floor_points=0)) == pytest.approx(0.01, abs=0.001)


def test_a_leaf_of_too_few_points_tells_nothing() -> None:
    assert lower_edge(heights(0.01)[::10]) is None


def test_an_open_doorway_without_points_above_the_floor_tells_nothing() -> None:
    assert lower_edge(np.zeros(500, np.float32)) is None


@pytest.mark.parametrize("undercut", [0.052, 0.06, 0.08])
def test_a_leaf_whose_lowest_part_is_hidden_tells_nothing(undercut: float) -> None:
    assert lower_edge(heights(undercut)) is None
