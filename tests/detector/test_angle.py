"""Opening angles (section 6.3): a leaf of 0.9 x 2.0 m, seen with 3 mm of noise; the bar is 0.5 deg."""

from __future__ import annotations

import numpy as np
import pytest

from detector.angle import fit_leaf
from detector.parameters import DetectorParameters
from detector.result import Rectangle

DOORWAY = Rectangle(1.0, 0.0, 1.9, 2.0)
PARAMETERS = DetectorParameters()


def leaf_points(
    angle_deg: float, hinge: str, *, hinge_depth: float = 0.0, seen: float = 1.0, seed: int = 0
) -> np.ndarray:
    """(N, 3) points of a leaf's face; negative angles lead out of the room."""
    rng = np.random.default_rng(seed)
    r, v = rng.uniform(0, 0.9 * seen, 4000), rng.uniform(0, 2.0, 4000)
    along = np.deg2rad(angle_deg)
    sign, corner = (1, 1.0) if hinge == "left" else (-1, 1.9)
    points = np.stack([corner + sign * r * np.cos(along), v, hinge_depth + r * np.sin(along)], axis=1)
    return (points + rng.normal(0, 0.003, points.shape)).astype(np.float32)


def surroundings(seed: int = 1) -> np.ndarray:
    """(N, 3) the wall beside the doorway, its reveals, and a corridor wall 1.5 m behind."""
    rng = np.random.default_rng(seed)
    left = np.stack([rng.uniform(-0.5, 1.0, 3000), rng.uniform(0, 2.7, 3000), np.zeros(3000)], axis=1)
    right = left + [2.4, 0, 0]
    reveal = np.stack([np.full(800, 1.0), rng.uniform(0, 2, 800), rng.uniform(-0.12, 0, 800)], axis=1)
    corridor = np.stack([rng.uniform(0, 3, 4000), rng.uniform(0, 2.7, 4000), np.full(4000, -1.5)], axis=1)
    points = np.concatenate([left, right, reveal, reveal + [0.9, 0, 0], corridor])
    return (points + rng.normal(0, 0.003, points.shape)).astype(np.float32)


@pytest.mark.parametrize("hinge", ["left", "right"])
@pytest.mark.parametrize("angle_deg", [-100, -80, -60, -40, -20, -5, 5, 20, 40, 60, 80, 100])
def test_the_angle_of_a_leaf_is_within_half_a_degree(angle_deg: float, hinge: str) -> None:
    depth = 0.0 if angle_deg > 0 else -0.11  # a leaf that opens outward hangs on the far side of the wall
    points = np.concatenate([leaf_points(angle_deg, hinge, hinge_depth=depth), surroundings()])
    leaf, cover, _ = fit_leaf(points, DOORWAY, hinge, PARAMETERS)
    assert np.rad2deg(leaf.opening_angle) == pytest.approx(abs(angle_deg), abs=0.5)
    assert leaf.opens == ("inward" if angle_deg > 0 else "outward") and leaf.hinge == hinge
    assert cover > 0.8 and np.rad2deg(leaf.opening_angle_std) < 0.2


def test_a_leaf_that_is_half_hidden_has_the_same_angle() -> None:
    points = np.concatenate([leaf_points(50, "left", seen=0.5), surroundings()])
    leaf, cover, _ = fit_leaf(points, DOORWAY, "left", PARAMETERS)
    assert np.rad2deg(leaf.opening_angle) == pytest.approx(50, abs=0.7) and cover < 0.7


@pytest.mark.parametrize("hinge", ["left", "right"])
@pytest.mark.parametrize(("angle_deg", "depth"), [(-17, -0.07), (17, -0.02), (-4, -0.05)])
def test_a_slightly_open_leaf_hangs_at_the_end_that_lies_in_the_wall(
    angle_deg: float, depth: float, hinge: str
) -> None:
    # from the other jamb the same line starts 0.9 m * tan(17 deg) = 0.28 m off, where no hinge can be
    points = np.concatenate([leaf_points(angle_deg, hinge, hinge_depth=depth), surroundings()])
    fits = [fit_leaf(points, DOORWAY, side, PARAMETERS) for side in ("left", "right")]
    best = max((fit for fit in fits if fit is not None), key=lambda fit: fit.likelihood)
    assert best.leaf.hinge == hinge and best.leaf.opens == ("inward" if angle_deg > 0 else "outward")
    assert best.hinge_depth == pytest.approx(depth, abs=0.01)


def test_the_papers_slice_at_half_height_can_be_chosen() -> None:
    parameters = DetectorParameters(leaf_slice="half-height")
    points = np.concatenate([leaf_points(35, "right"), surroundings()])
    # everything but half height is moved: only the slice may count
    points[np.abs(points[:, 1] - 1.0) > 0.1, 2] += 3
    leaf, *_ = fit_leaf(points, DOORWAY, "right", parameters)
    assert np.rad2deg(leaf.opening_angle) == pytest.approx(35, abs=0.7)


def test_reveals_and_corridor_are_no_leaf() -> None:
    assert fit_leaf(surroundings(), DOORWAY, "left", PARAMETERS) is None


def test_a_partition_that_goes_on_behind_the_doorway_is_no_leaf() -> None:
    rng = np.random.default_rng(0)
    partition = np.stack([np.full(6000, 1.0), rng.uniform(0, 2.7, 6000), rng.uniform(-1.6, -0.1, 6000)], axis=1)
    assert fit_leaf(np.concatenate([partition, surroundings()]).astype(np.float32), DOORWAY, "left", PARAMETERS) is None


def test_no_points_are_no_leaf() -> None:
    assert fit_leaf(np.zeros((0, 3), np.float32), DOORWAY, "left", PARAMETERS) is None
