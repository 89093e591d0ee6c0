"""The doorway's sides to the pixel: a doorway of 0.9 x 2.0 m in a wall of 3 x 2.5 m, in pixels of 1 cm."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from detector.outline import HALF_GAP, _settled
from detector.parameters import DetectorParameters
from detector.result import Mask, Orthoimage, Rectangle
from detector.subpixel import components, edge_centre
from tests.detector.conftest import plain_image

DOORWAY = Rectangle(1.0, 0.0, 1.9, 2.0)
HEIGHT = 2.5
WALL = plain_image((250, 300), pixel_size=0.01)


def hole() -> Mask:
    """(250, 300) True in the doorway."""
    mask = np.zeros((250, 300), bool)
    mask[50:, 100:190] = True
    return mask


def settle(found: Rectangle, passed: Mask, face: Mask, wall: Orthoimage = WALL) -> Rectangle:
    """The rectangle with its sides settled on a wall of one colour."""
    return _settled(found, passed, face, components(wall, DetectorParameters()), wall, HEIGHT)


@pytest.mark.parametrize("looked_through", [True, False])
def test_a_frame_that_was_taken_in_is_left_out(looked_through: bool) -> None:
    # the line was found on the outside of a frame of 8 cm; what stands in the doorway is no face of the wall
    passed = hole() & looked_through
    found = Rectangle(0.92, 0.0, 1.9, 2.0)
    settled = settle(found, passed, ~hole())
    assert (settled.left, settled.right, settled.top) == pytest.approx((1.0, 1.9, 2.0), abs=0.011)


def test_a_leaf_is_smaller_than_the_middle_of_the_gap_round_it() -> None:
    # 1.5 mm on each side
    face = np.ones((250, 300), bool)
    settled = settle(DOORWAY, np.zeros_like(face), face)
    assert (settled.left, settled.right, settled.top) == pytest.approx((1.0015, 1.8985, 1.9985), abs=1e-6)


def test_a_groove_in_a_frame_does_not_end_it() -> None:
    # the door is closed and deep: frame over 16 cm, with a groove of 1 cm after 5 cm; more than a frame is none
    face = ~hole()
    face[:, 100:116] = True
    face[:, 105] = False
    assert settle(DOORWAY, np.zeros_like(face), face).left == pytest.approx(1.0 + HALF_GAP)


def test_a_leaf_that_is_face_in_steps_at_its_hinge_is_no_frame() -> None:
    # 35 deg: 5.6 cm nearer after 8 cm; in samples 7 cm apart each step is parallel to the wall
    face = ~hole()
    face[:, 100:108] = True
    depth = np.zeros_like(WALL.depth)
    depth[:, 100:190] = np.arange(90) * 0.01 * np.tan(np.deg2rad(35))
    settled = settle(DOORWAY, np.zeros_like(face), face, replace(WALL, depth=depth))
    assert settled.left == pytest.approx(1.0 + HALF_GAP)


def test_the_side_of_a_hole_lies_within_the_outermost_pixel_that_a_beam_passed() -> None:
    # on average in its middle: half a pixel of 1 cm inside the first border, and half the gap
    settled = settle(DOORWAY, hole(), ~hole())
    assert (settled.left, settled.right, settled.top) == pytest.approx((1.0065, 1.8935, 1.9935), abs=1e-6)


@pytest.mark.parametrize("hidden", [1, 3])
def test_where_beams_meet_the_reveal_the_face_ends_at_its_corner(hidden: int) -> None:
    # the hole of beams begins 1 or 3 cm late; the corner lies within the last pixel of the face, and half the gap more
    passed, face = hole(), ~hole()
    passed[:, 100 : 100 + hidden] = False
    settled = settle(DOORWAY, passed, face)
    assert (settled.left, settled.right) == pytest.approx((0.9965, 1.8935), abs=1e-6)


@pytest.mark.parametrize("found", [0.985, 1.0, 1.015])
def test_an_edge_between_pixels_is_found_between_them(found: float) -> None:
    # leaf from u = 1.003: the pixel from 1.00 to 1.01 is three parts wall (200) and seven parts leaf (100): 130
    colour = np.full((250, 300, 3), 200, np.uint8)
    colour[:, 101:] = 100
    colour[:, 100] = 130
    values = components(replace(WALL, colour=colour), DetectorParameters())
    # steps of 70 at 1.00 and 30 at 1.01: their centre is 1.003
    assert edge_centre(values, 1, found / 0.01, 0.01) * 0.01 == pytest.approx(1.003, abs=0.001)


def test_both_flanks_of_a_dark_gap_count() -> None:
    # wall and leaf of one colour, a gap of 1 cm from 1.00 to 1.01
    colour = np.full((250, 300, 3), 150, np.uint8)
    colour[:, 100] = 40
    values = components(replace(WALL, colour=colour), DetectorParameters())
    for found in (1.0, 1.01):
        assert edge_centre(values, 1, found / 0.01, 0.01) * 0.01 == pytest.approx(1.005, abs=1e-3)


def test_without_an_edge_a_side_stays_where_it_is() -> None:
    values = components(WALL, DetectorParameters())
    assert edge_centre(values, 0, 123.4, 0.01) == 123.4
