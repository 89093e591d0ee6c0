"""Highlights that another view of the wall gives away: where they are, and what is none."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from detector.gloss import compare_views
from detector.highlights import find_highlights
from detector.lobes import outlines
from detector.parameters import DetectorParameters
from detector.result import Highlights, Mask, Orthoimage
from tests.detector.conftest import plain_image

PARAMETERS = DetectorParameters(pixel_size=0.01)
CAMERA = np.array([1.0, 0.5, 2.0])
"""2 m before pixel (50, 100) of a wall of 2 x 1 m: 1 px is 5 mrad there."""
OBLIQUE = np.array([-1.5, 0.5, 1.0])
"""Sees the same pixel at atan(2.5 / 1) = 68 deg, far outside any lobe."""
ROWS, COLUMNS = np.indices((100, 200))
RADIUS = np.hypot(ROWS - 50, COLUMNS - 100)
"""[px] from the foot of the perpendicular from the first camera."""


def painted(grey: np.ndarray, depth: float = 0.0) -> Orthoimage:
    colour = np.repeat(np.rint(np.minimum(grey, 255))[..., None], 3, axis=2).astype(np.uint8)
    return replace(plain_image(), colour=colour, depth=np.full((100, 200), depth, np.float32))


def bell(height: float, sigma: float, away: float = 0.0) -> np.ndarray:
    return height * np.exp(-0.5 * ((ROWS - 50) ** 2 + (COLUMNS - 100 - away) ** 2) / sigma**2)


def compared(first: Orthoimage, second: Orthoimage) -> Highlights:
    """Of the first view, when the second is seen obliquely; their light is even."""
    views, cameras = [first, second], [CAMERA, OBLIQUE]
    alone = [find_highlights(v, c, 1.0, PARAMETERS) for v, c in zip(views, cameras, strict=True)]
    return compare_views(views, views, alone, cameras, 1.0, PARAMETERS)[0]


def test_a_highlight_too_weak_for_one_view_is_found_by_another() -> None:
    # 90 + 18 of 255: below a step of the 11 levels, 23
    weak = painted(90 + bell(18, 6))
    assert not find_highlights(weak, CAMERA, 1.0, PARAMETERS).regions.any()
    found = compared(weak, painted(90 + bell(0, 6)))
    assert found.regions[RADIUS < 6].all()
    assert not found.regions[RADIUS > 3 * 6].any()  # 1 % of its height
    assert len(found.contours) == 1
    assert abs(int(found.inpainted[50, 100, 0]) - 90) <= 4


def test_paint_that_both_views_see_is_no_highlight() -> None:
    spot = painted(118 + bell(60, 8))
    assert find_highlights(spot, CAMERA, 1.0, PARAMETERS).regions.any()  # so it seems to one view
    found = compared(spot, spot)
    assert not found.regions.any()
    assert not found.contours
    assert (found.inpainted == spot.colour).all()


def test_what_the_other_view_cannot_tell_stays_as_one_view_has_it() -> None:
    spot = painted(118 + bell(60, 8))
    blind = replace(spot, coloured=RADIUS > 60)
    assert (compared(spot, blind).regions == find_highlights(spot, CAMERA, 1.0, PARAMETERS).regions).all()


def test_a_highlight_across_an_edge_is_found_on_both_sides() -> None:
    door = np.where(COLUMNS < 100, 90.0, 150.0)
    found = compared(painted(door + bell(40, 8)), painted(door))
    assert found.regions[50, 92]
    assert found.regions[50, 108]


def test_the_overexposed_top_of_a_highlight_is_a_part_of_it() -> None:
    # 255 - 235 = 20 levels of 120 are left, wherever there were as many: up to 8 px sqrt(2 ln 6) = 15 px
    found = compared(painted(235 + bell(120, 8)), painted(235 + bell(0, 8)))
    assert found.regions[(RADIUS < 14) & (COLUMNS < 105)].all()  # further to the right the other view is too oblique
    assert not found.regions[RADIUS > 3.5 * 8].any()


def test_a_plateau_that_is_not_overexposed_is_no_highlight() -> None:
    assert not compared(painted(200 + np.minimum(bell(120, 8), 20)), painted(200 + bell(0, 8))).regions.any()


def test_a_highlight_goes_on_where_no_other_view_tells() -> None:
    # 18 levels have fallen to the foot, 0.4 of 9, at 6 px sqrt(2 ln 5) = 11 px
    blind = replace(painted(90 + bell(0, 6)), coloured=COLUMNS >= 97)
    found = compared(painted(90 + bell(18, 6)), blind)
    assert found.regions[RADIUS < 8].all()
    assert not found.regions[RADIUS > 3 * 6].any()


def test_what_furniture_leaves_of_a_highlight_is_found() -> None:
    half = replace(painted(90 + bell(60, 12)), coloured=COLUMNS < 103)
    found = compared(half, painted(90 + bell(0, 12)))
    assert found.regions[(RADIUS < 12) & (COLUMNS < 100)].all()


@pytest.mark.parametrize(
    ("sigma", "away", "expected"),
    [
        pytest.param(1.5, 0, True, id="small, at the foot"),
        pytest.param(1.5, 16, False, id="small, 16 px of 5 mrad away"),
        pytest.param(12, 16, True, id="large, as on a door that is ajar by 5 deg"),
        pytest.param(12, 40, False, id="large, with its skirt over the foot and its middle at 0.2 rad"),
    ],
)
def test_a_lobe_has_its_middle_at_the_foot_of_the_perpendicular(sigma: float, away: float, expected: bool) -> None:
    found = compared(painted(90 + bell(60, sigma, away)), painted(90 + bell(0, sigma)))
    assert found.regions.any() == expected


def test_what_is_beside_furniture_of_the_other_view_is_not_told() -> None:
    # the other view has the lobe's right half 5 cm beside a cupboard that stands out by 10 cm, in its shadow
    shaded = painted(np.where(COLUMNS < 105, 90.0, 60.0))
    shaded.depth[:, 110:] = 0.1
    assert not compared(painted(90 + bell(0, 6)), shaded).regions.any()


def nothing() -> Mask:
    return np.zeros((100, 200), bool)


@pytest.mark.parametrize(
    ("first", "second"),
    [
        pytest.param(90 + bell(60, 6, away=60), 90 + bell(0, 6), id="far from the foot, at 0.3 rad"),
        pytest.param(90 + 12 * np.cos(np.arctan(RADIUS / 200)) ** 3, 90 + bell(0, 6), id="the sheen of matt paint"),
        pytest.param(90 + bell(0, 6), np.where(RADIUS < 15, 60.0, 90.0), id="a shadow in the other view"),
        pytest.param(90 + bell(0, 6), 90 - 40 * (abs(COLUMNS - 100) < 1), id="a line that only the other view sees"),
    ],
)
def test_no_highlight_is(first: np.ndarray, second: np.ndarray) -> None:
    assert not compared(painted(first), painted(second)).regions.any()


def test_what_brightens_one_channel_is_no_gloss() -> None:
    red = painted(90 + bell(0, 6))
    red.colour[..., 0] += np.rint(bell(60, 6)).astype(np.uint8)
    assert not compared(red, painted(90 + bell(0, 6))).regions.any()


def test_what_stands_out_from_the_wall_is_left_to_itself() -> None:
    cupboard = painted(90 + bell(60, 6), depth=0.1)
    found = compared(cupboard, painted(90 + bell(0, 6)))
    assert (found.regions == find_highlights(cupboard, CAMERA, 1.0, PARAMETERS).regions).all()


def test_a_single_view_has_nothing_to_be_compared_with() -> None:
    spot = painted(118 + bell(60, 8))
    alone = [find_highlights(spot, CAMERA, 1.0, PARAMETERS)]
    assert compare_views([spot], [spot], alone, [CAMERA], 1.0, PARAMETERS) == alone


def test_the_outline_of_a_disc_is_its_radius_away_in_all_directions() -> None:
    (ends,) = outlines(RADIUS <= 10)
    assert np.hypot(*(ends - [50, 100]).T) == pytest.approx(10, abs=1)
