"""Highlights that are overexposed, cut by edges, or seen by one of two views only (sections 4.1 and 4.2)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from detector.highlights import find_highlights
from detector.merging import merge
from detector.parameters import DetectorParameters
from detector.result import Orthoimage
from tests.detector.conftest import plain_image

PARAMETERS = DetectorParameters(pixel_size=0.01)
CAMERA = np.array([1.0, 0.5, 2.0])
"""2 m before pixel (50, 100) of a wall of 2 x 1 m."""
OBLIQUE = np.array([-1.5, 0.5, 1.0])
"""Sees the same pixel at atan(2.5 / 1) = 68 deg, far outside any lobe."""


def glossy(height: float, sigma: float, paint: np.ndarray | float = 90.0) -> Orthoimage:
    """A flash highlight of this height and width [px] over paint, at pixel (50, 100), clipped at 255."""
    rows, columns = np.indices((100, 200))
    bell = height * np.exp(-0.5 * ((rows - 50) ** 2 + (columns - 100) ** 2) / sigma**2)
    colour = np.repeat(np.rint(np.minimum(paint + bell, 255))[..., None], 3, axis=2).astype(np.uint8)
    return replace(plain_image(), colour=colour)


def door(columns: slice, grey: float = 130.0) -> np.ndarray:
    """Paint of a wall of 90 with a door of another grey that reaches the floor."""
    paint = np.full((100, 200), 90.0)
    paint[20:, columns] = grey
    return paint


def regions(image: Orthoimage) -> np.ndarray:
    return find_highlights(image, CAMERA, 1.0, PARAMETERS).regions


def test_an_overexposed_highlight_is_found_with_its_skirt() -> None:
    # 90 + 250 exp(-r^2 / 2 sigma^2) is clipped for r < 0.91 sigma = 15 px
    found = regions(glossy(250, 16))
    assert found[50, 100] and found[50, 100 + 20] and found[50, 100 - 20]
    assert not found[50, 100 + 64] and not found[50, 100 - 64]  # 4 sigma


def test_an_overexposed_top_may_be_darker_in_the_middle() -> None:
    image = glossy(250, 16)
    rows, columns = np.indices((100, 200))
    # the fall-off of the flash divided out: 5 % less in the middle of what was clipped
    top = (rows - 50) ** 2 + (columns - 100) ** 2 < 10**2
    image.colour[top] = 242
    assert regions(image)[50, 100]


def test_a_highlight_across_the_edge_of_a_door_is_found_on_both_sides() -> None:
    found = regions(glossy(250, 16, door(np.s_[95:180])))
    assert found[50, 88] and found[50, 112]


def test_a_dark_gap_round_a_door_does_not_cut_a_highlight() -> None:
    image = glossy(250, 16)
    image.colour[:, 98:100] = 20
    found = regions(image)
    assert found[50, 85] and found[50, 115]


def test_a_white_ring_is_no_highlight() -> None:
    image = glossy(0, 12)
    rows, columns = np.indices((100, 200))
    radius = np.hypot(rows - 50, columns - 100)
    image.colour[(radius > 15) & (radius < 22)] = 230
    assert not regions(image).any()


def merged(views: list[Orthoimage], cameras: list[np.ndarray], parameters: DetectorParameters) -> np.ndarray:
    found = [find_highlights(v, c, 1.0, parameters) for v, c in zip(views, cameras, strict=True)]
    return merge(views, found, cameras, 1.0, parameters).colour[..., 0].astype(int)


def test_what_an_oblique_view_sees_without_gloss_replaces_a_highlight_and_keeps_the_door_under_it() -> None:
    paint = door(np.s_[95:180])
    views = [glossy(250, 16, paint), glossy(0, 12, paint)]
    colour = merged(views, [CAMERA, OBLIQUE], PARAMETERS)
    assert np.abs(colour - paint).max() <= 5  # 5 of 255 is less than a camera's noise
    without = merged(views, [CAMERA, OBLIQUE], PARAMETERS.model_copy(update={"correct_highlights": False}))
    assert np.abs(without - paint).max() > 100


def test_a_replaced_highlight_has_the_brightness_of_the_view_around_it() -> None:
    paint = door(np.s_[95:180])
    dim = glossy(0, 12, np.rint(0.7 * paint))  # the oblique view is darker by 30 % everywhere
    colour = merged([glossy(250, 16, paint), dim], [CAMERA, OBLIQUE], PARAMETERS)
    inside = find_highlights(glossy(0, 12), CAMERA, 1.0, PARAMETERS).region_of_interest
    assert np.abs(colour - paint)[inside].max() <= 6


def test_paint_that_all_views_see_bright_is_kept() -> None:
    paint = np.full((100, 200), 90.0)
    paint[40:60, 90:110] = 200  # a white sheet at the foot of the perpendicular
    colour = merged([glossy(0, 12, paint)] * 2, [CAMERA, OBLIQUE], PARAMETERS)
    assert (colour == paint).all()


def test_the_middle_of_a_highlight_is_where_a_flat_wall_mirrors_the_flash() -> None:
    # 60 px are 0.6 m at 2 m: 0.29 rad from the foot of the perpendicular, too much for a flash beside the lens
    image = glossy(60, 8)
    aside = CAMERA + [0.6, 0, 0]
    assert not find_highlights(image, aside, 1.0, PARAMETERS).regions.any()
    as_in_the_paper = PARAMETERS.model_copy(update={"highlight_mirror_angle": PARAMETERS.highlight_roi_angle})
    assert find_highlights(image, aside, 1.0, as_in_the_paper).regions[50, 100]
