"""The doorway's sides to the pixel: a doorway of 0.9 x 2.0 m in a wall of 3 x 2.5 m, in pixels of 1 cm."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from detector.outline import _settled
from detector.result import Mask, Rectangle
from tests.detector.conftest import plain_image

DOORWAY = Rectangle(1.0, 0.0, 1.9, 2.0)
HEIGHT = 2.5
WALL = plain_image((250, 300), pixel_size=0.01)


def hole() -> Mask:
    """(250, 300) True in the doorway."""
    mask = np.zeros((250, 300), bool)
    mask[50:, 100:190] = True
    return mask


@pytest.mark.parametrize("looked_through", [True, False])
def test_a_frame_that_was_taken_in_is_left_out(looked_through: bool) -> None:
    # the line was found on the outside of a frame of 8 cm; what stands in the doorway is no face of the wall
    passed = hole() & looked_through
    found = Rectangle(0.92, 0.0, 1.9, 2.0)
    settled = _settled(found, passed, ~hole(), WALL, HEIGHT)
    assert (settled.left, settled.right, settled.top) == pytest.approx((1.0, 1.9, 2.0), abs=0.011)


def test_a_closed_leaf_flush_with_its_frame_keeps_its_outline() -> None:
    face = np.ones((250, 300), bool)
    settled = _settled(DOORWAY, np.zeros_like(face), face, WALL, HEIGHT)
    assert (settled.left, settled.right, settled.top) == pytest.approx((1.0, 1.9, 2.0), abs=1e-6)


def test_a_groove_in_a_frame_does_not_end_it() -> None:
    # the door is closed and deep: frame over 16 cm, with a groove of 1 cm after 5 cm; more than a frame is none
    face = ~hole()
    face[:, 100:116] = True
    face[:, 105] = False
    assert _settled(DOORWAY, np.zeros_like(face), face, WALL, HEIGHT).left == pytest.approx(1.0)


def test_a_leaf_that_is_face_in_steps_at_its_hinge_is_no_frame() -> None:
    # 35 deg: 5.6 cm nearer after 8 cm; in samples 7 cm apart each step is parallel to the wall
    face = ~hole()
    face[:, 100:108] = True
    depth = np.zeros_like(WALL.depth)
    depth[:, 100:190] = np.arange(90) * 0.01 * np.tan(np.deg2rad(35))
    settled = _settled(DOORWAY, np.zeros_like(face), face, replace(WALL, depth=depth), HEIGHT)
    assert settled.left == pytest.approx(1.0)
