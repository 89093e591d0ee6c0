"""Leaves that slide (figure 11): a hole of 0.9 x 2.0 m in a wall of 4 x 2.5 m, seen with 3 mm of noise."""

from __future__ import annotations

import numpy as np
import pytest

from detector.detect import detect_doors
from detector.leaves import describe_door
from detector.openings import Visibility
from detector.parameters import DetectorParameters
from detector.result import Door, Orthoimage, Rectangle
from detector.sliding import Slide, find_slide
from tests.detector.conftest import COARSE, STEP_DEG
from tests.detector.synthetic import Box, DoorSpec, Layout, make_room

HOLE = Rectangle(1.5, 0.0, 2.4, 2.0)
HEIGHT = 2.5
PX = 0.005


def seen(outline: Rectangle, *panels: tuple[Rectangle, float]) -> tuple:
    """What `find_slide` is given of a wall with the hole and panels at their depths before or behind it."""
    rng = np.random.default_rng(0)
    u, v = np.meshgrid((np.arange(800) + 0.5) * PX, (np.arange(500)[::-1] + 0.5) * PX)
    depth = np.where(_within(HOLE, u, v), np.nan, 0.0)
    for panel, at in panels:
        depth[_within(panel, u, v) & ((at > 0) | np.isnan(depth))] = at
    depth = (depth + rng.normal(0, 0.003, depth.shape)).astype(np.float32)
    data = np.isfinite(depth)
    image = Orthoimage(np.full((*depth.shape, 3), 128, np.uint8), data, depth, PX)
    points = np.stack([u[data], v[data], depth[data]], axis=1).astype(np.float32)
    return outline, image, np.where(data, Visibility.DATA, Visibility.THROUGH).astype(np.uint8), points, HEIGHT


def _within(r: Rectangle, u: np.ndarray, v: np.ndarray) -> np.ndarray:
    return (u > r.left) & (u < r.right) & (v > r.bottom) & (v < r.top)


def described(*panels: tuple[Rectangle, float], outline: Rectangle = HOLE) -> Door:
    """The door in an outline."""
    outline, image, visibility, points, height = seen(outline, *panels)
    return describe_door(outline, image, visibility, points, height, DetectorParameters())


@pytest.mark.parametrize("to_right", [False, True])
def test_a_leaf_before_the_wall_gives_the_doorway_its_own_width(to_right: bool) -> None:
    # closed it covers the hole of 0.9 x 2 m by 2 cm on each side and above; it slid by 0.4 m
    left = 1.88 if to_right else 1.08
    leaf = Rectangle(left, 0.0, left + 0.94, 2.02)
    outline = Rectangle(1.5, 0.0, 2.82, 2.02) if to_right else Rectangle(1.08, 0.0, 2.4, 2.02)
    slide = find_slide(*seen(outline, (leaf, 0.05)))
    assert slide is not None and not slide.is_beside
    assert slide.way == pytest.approx(0.4 if to_right else -0.4, abs=0.005)
    assert (slide.doorway.left, slide.doorway.right) == pytest.approx((1.48, 2.42), abs=0.006)
    assert slide.doorway.top == pytest.approx(2.02, abs=0.005)


@pytest.mark.parametrize(("depth", "left"), [(-0.06, 1.8), (-0.17, 1.8), (-0.06, 1.2)])
def test_a_leaf_behind_the_face_leaves_the_hole_the_doorway(depth: float, left: float) -> None:
    # 0.92 m wide: from 1.8 m it fills the hole but for a third, from 1.2 m on all but 0.28 m
    slide = find_slide(*seen(HOLE, (Rectangle(left, 0.0, left + 0.92, 2.02), depth)))
    assert slide == Slide(HOLE, pytest.approx(0.3 if left > 1.5 else -0.28, abs=PX))


def test_its_door_says_how_much_of_the_doorway_is_open() -> None:
    door = described((Rectangle(1.8, 0.0, 2.72, 2.02), -0.06))
    assert (door.kind, door.state, door.opening_angle) == ("sliding", "semi-open", 0.0)
    assert door.opened_fraction == pytest.approx(1 / 3, abs=0.01)  # 0.3 of 0.9 m


def test_a_closed_door_has_no_opened_fraction() -> None:
    leaf = Rectangle(1.49, 0.0, 2.41, 2.02)
    door = described((leaf, 0.05), outline=leaf)
    assert (door.kind, door.state, door.rectangle) == ("single", "closed", leaf)
    assert np.isnan(door.opened_fraction)


def test_a_leaf_folded_back_beside_its_hole_leaves_the_hole_open() -> None:
    # as wide as the hole and quite beside it: it slid, or it turned by 180 deg
    door = described((Rectangle(0.6, 0.0, 1.5, 2.0), 0.05), outline=Rectangle(0.6, 0.0, 2.4, 2.0))
    assert (door.kind, door.state) == ("single", "open") and np.isnan(door.opening_angle)
    assert (door.rectangle.left, door.rectangle.right) == pytest.approx((1.5, 2.4), abs=0.005)


@pytest.mark.parametrize("depth", [-0.06, 0.04])
def test_a_pane_of_glass_is_no_opening(depth: float) -> None:
    # stiles of 8 cm on both sides of panes over almost the whole height
    stiles = [(Rectangle(left, 0.0, right, 2.0), depth) for left, right in ((1.5, 1.9), (2.32, 2.4))]
    assert find_slide(*seen(HOLE, *stiles)) is None


def test_one_closed_leaf_of_a_double_door_does_not_slide() -> None:
    # in the wall's own plane, where it has nowhere to go
    assert find_slide(*seen(HOLE, (Rectangle(1.5, 0.0, 1.95, 2.0), -0.01))) is None


def test_what_slopes_does_not_slide() -> None:
    # 0.5 m wide, and 0.1 m nearer at its free end: a leaf that turned by 11 deg
    steps = [(Rectangle(1.5 + 0.05 * k, 0.0, 1.55 + 0.05 * k, 2.0), 0.03 + 0.01 * k) for k in range(10)]
    assert find_slide(*seen(HOLE, *steps)) is None


@pytest.mark.parametrize("depths", [(0.05, 0.01), (-0.05, -0.09)])
def test_a_sliding_door_half_open_is_found_as_one(depths: tuple[float, float]) -> None:
    # a leaf of 0.92 m, 0.45 m to the right of where it covers a hole of 0.9 m by 1 cm, before the wall or in it
    near, far = depths
    leaf = Box((2.94 + 0.46, 1.025, (near + far) / 2), (0.46, 1.025, (near - far) / 2), (0.3, 0.4, 0.6))
    hole = DoorSpec(left=2.5, height=2.03, has_leaf=False)
    (door,) = detect_doors(make_room(Layout(doors=[hole], extra=[leaf]), step_deg=STEP_DEG), COARSE)[0].doors
    assert (door.kind, door.state) == ("sliding", "semi-open")
    assert door.opened_fraction == pytest.approx(0.49, abs=0.03)
    assert (door.rectangle.left, door.rectangle.right) == pytest.approx((2.49, 3.41), abs=0.025)  # two pixels
