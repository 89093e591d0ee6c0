"""A frame that stands out of its wall, round a leaf of its own colour: 0.9 x 2.0 m in a wall of 3 x 2.5 m."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from detector.frame import leaves_in_frames, without_frame
from detector.result import Candidate, Orthoimage, Rectangle
from tests.detector.conftest import plain_image

HEIGHT = 2.5
LEAF = Rectangle(1.0, 0.0, 1.9, 2.0)
WITH_FRAME = Rectangle(0.93, 0.0, 1.97, 2.07)


def wall(*, frame: float = 0.012, rail: float = 0.0) -> Orthoimage:
    """The wall with a leaf 2 mm behind its face, a frame 7 cm wide that stands `frame` out, and noise of 3 mm.

    Args:
        rail: Height of a bottom rail that stands out like the frame: then the leaf is the panel of another.
    """
    image = plain_image((500, 600), pixel_size=0.005)
    depth = image.depth.copy()
    depth[86:, 186:394] = frame
    depth[100:, 200:380] = -0.002
    if rail:
        depth[-round(rail / 0.005) :, 186:394] = frame
    depth += np.random.default_rng(0).normal(0, 0.003, depth.shape).astype(np.float32)
    return replace(image, depth=depth)


def sides(rectangle: Rectangle) -> tuple[float, float, float]:
    return rectangle.left, rectangle.right, rectangle.top


def test_a_frame_of_the_leafs_colour_is_told_by_its_step() -> None:
    assert sides(without_frame(WITH_FRAME, wall(), HEIGHT)) == pytest.approx(sides(LEAF), abs=0.006)  # a pixel


def test_a_flat_door_keeps_its_outline() -> None:
    # 2 mm from frame to leaf are no step
    assert without_frame(WITH_FRAME, wall(frame=0.0), HEIGHT) == WITH_FRAME


def test_a_panel_above_a_bottom_rail_is_no_leaf() -> None:
    assert without_frame(WITH_FRAME, wall(rail=0.2), HEIGHT) == WITH_FRAME


def test_the_outline_of_the_leaf_itself_is_kept() -> None:
    assert without_frame(LEAF, wall(), HEIGHT) == LEAF


def test_a_strip_on_one_side_only_is_no_frame() -> None:
    # the outline was found right on the left, with 7 cm on the right and above
    half = replace(WITH_FRAME, left=1.0)
    assert without_frame(half, wall(), HEIGHT) == half


def test_a_door_of_which_nothing_is_seen_keeps_its_outline() -> None:
    image = wall()
    hidden = replace(image, depth=np.full_like(image.depth, np.nan))
    assert without_frame(WITH_FRAME, hidden, HEIGHT) == WITH_FRAME


def candidate(rectangle: Rectangle, rejected_by: str | None = None) -> Candidate:
    return Candidate(rectangle, 1.0, 1.0, (1.0, 1.0, 1.0, 1.0), 0.0, rejected_by)


def test_of_candidates_the_leaf_in_the_frame_stays_and_those_in_between_go() -> None:
    half, beside = replace(LEAF, right=1.97), Rectangle(0.1, 0.0, 0.8, 2.0)
    found = tuple(map(candidate, (WITH_FRAME, half, beside)))
    candidates, leaves = leaves_in_frames(found, wall(), HEIGHT)
    assert [sides(c.rectangle) for c in leaves] == [pytest.approx(sides(LEAF), abs=0.006)]
    accepted = [c.rectangle for c in candidates if c.rejected_by is None]
    assert accepted == [leaves[0].rectangle, beside]
    assert [c.rectangle for c in candidates if c.rejected_by == "minimum size"] == [WITH_FRAME, half]


def test_candidates_that_were_rejected_make_no_leaves() -> None:
    found = (candidate(WITH_FRAME, "floor"),)
    assert leaves_in_frames(found, wall(), HEIGHT) == (found, ())
