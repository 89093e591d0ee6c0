"""View merging (section 4.2), flash fall-off, and highlights (section 4.1)."""

from __future__ import annotations

from dataclasses import replace
from math import exp, pi

import numpy as np
import pytest

from detector.highlights import find_highlights, inpaint
from detector.illumination import even_light, incidence
from detector.merging import merge, view_weights
from detector.parameters import DetectorParameters
from detector.result import Highlights, Orthoimage
from tests.detector.conftest import plain_image

PARAMETERS = DetectorParameters(pixel_size=0.01)
NO_HIGHLIGHT = np.zeros((100, 200), bool)


def highlights_of(image: Orthoimage, regions: np.ndarray = NO_HIGHLIGHT) -> Highlights:
    return Highlights(regions, image.colour[..., 0], regions.astype(np.int32), regions, (), image.colour)


def test_the_weights_are_those_of_equation_1() -> None:
    # w1 has mean 0 and sigma 20 deg, w2 mean 20 deg and sigma 30 deg
    angles = np.array([0, pi / 9, pi / 9, pi / 9 + pi / 6])
    specular = np.array([False, False, True, True])
    np.testing.assert_allclose(view_weights(angles, specular, PARAMETERS), [1, exp(-0.5), 1, exp(-0.5)], rtol=1e-6)


def test_the_merged_colour_is_the_weighted_mean_and_the_depth_the_maximum() -> None:
    dark, bright = plain_image(grey=50), replace(plain_image(grey=150), depth=np.full((100, 200), 0.01, np.float32))
    # both cameras 1 m from the wall: one over pixel (50, 100), one tan(20 deg) beside it
    cameras = [np.array([1.005, 0.495, 1.0]), np.array([1.005 + np.tan(pi / 9), 0.495, 1.0])]
    merged = merge([dark, bright], [highlights_of(dark), highlights_of(bright)], cameras, 1.0, PARAMETERS)
    expected = (50 + 150 * exp(-0.5)) / (1 + exp(-0.5))
    assert merged.colour[50, 100, 0] == pytest.approx(expected, abs=1)
    assert merged.depth[50, 100] == pytest.approx(0.01)


def test_a_view_without_colour_does_not_count() -> None:
    seen, unseen = plain_image(grey=80), replace(plain_image(grey=0), coloured=NO_HIGHLIGHT)
    cameras = [np.array([1.9, 0.5, 1.0]), np.array([1.0, 0.5, 1.0])]
    merged = merge([seen, unseen], [highlights_of(seen), highlights_of(unseen)], cameras, 1.0, PARAMETERS)
    assert (merged.colour == 80).all() and merged.coloured.all()


def test_an_evenly_painted_wall_is_even_after_the_flash_falloff_is_taken_out() -> None:
    camera = np.array([0.3, 0.5, 0.8])
    angles, ranges = incidence(plain_image(), camera, 1.0)
    light = 0.05 + 0.3 * np.cos(angles) / ranges**2  # ambient and flash on one paint
    srgb = np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)
    lit = replace(plain_image(), colour=np.repeat(np.rint(srgb * 255).astype(np.uint8)[..., None], 3, axis=2))
    assert np.ptp(lit.colour) > 60
    (even,) = even_light([lit], [camera], 1.0, [np.ones((100, 200), bool)])
    assert np.ptp(even.colour) <= 4  # the fit is to medians of bins


def test_views_of_different_brightness_are_brought_to_the_first() -> None:
    everywhere, camera = np.ones((100, 200), bool), np.array([1.0, 0.5, 50.0])  # so far away that the light is even
    first, second = even_light([plain_image(grey=120), plain_image(grey=180)], [camera] * 2, 1.0, [everywhere] * 2)
    assert abs(int(second.colour[0, 0, 0]) - 120) <= 1 and (first.colour == second.colour[50, 100]).mean() > 0.99


def spot(radius_px: float, height: float = 60.0) -> Orthoimage:
    """A Gaussian highlight on grey, centred on pixel (50, 100)."""
    rows, columns = np.indices((100, 200))
    bell = height * np.exp(-0.5 * ((rows - 50) ** 2 + (columns - 100) ** 2) / radius_px**2)
    colour = np.repeat(np.rint(118 + bell)[..., None], 3, axis=2).astype(np.uint8)
    return replace(plain_image(), colour=colour)


CAMERA = np.array([1.0, 0.5, 2.0])


def test_where_one_view_is_overexposed_the_merged_colour_is_that_of_the_other() -> None:
    rows, columns = np.indices((100, 200))
    disc = np.hypot(rows - 50, columns - 100) < 15
    second = plain_image()
    second.colour[:] = 200, 150, 120
    first = replace(second, colour=second.colour.copy())
    first.colour[disc] = 190  # white over a gain: red is darker than it should be
    found = replace(highlights_of(first, disc), region_of_interest=np.ones((100, 200), bool))
    cameras = [CAMERA, np.array([-1.5, 0.5, 1.0])]
    merged = merge([first, second], [found, highlights_of(second)], cameras, 1.0, PARAMETERS)
    assert np.abs(merged.colour.astype(int) - (200, 150, 120)).max() <= 1


def test_a_gaussian_highlight_is_found_with_its_extent() -> None:
    found = find_highlights(spot(8), CAMERA, 1.0, PARAMETERS)
    assert len(found.contours) == 1 and found.regions[50, 100]
    # a bell is level again at 2.5 to 3.5 sigma: a disc of 20 to 28 pixels
    assert pi * 18**2 < found.regions.sum() < pi * 30**2


def test_a_repaired_highlight_has_the_colour_of_the_wall_around() -> None:
    found = find_highlights(spot(8), CAMERA, 1.0, PARAMETERS)
    assert abs(int(found.inpainted[50, 100, 0]) - 118) <= 6


def test_a_white_sheet_is_no_highlight() -> None:
    image = plain_image(grey=118)
    image.colour[40:60, 90:110] = 200
    assert not find_highlights(image, CAMERA, 1.0, PARAMETERS).regions.any()


def test_highlights_are_looked_for_only_near_the_foot_of_the_perpendicular() -> None:
    away = np.array([1.0, -4.0, 2.0])  # incidence over 60 deg
    assert not find_highlights(spot(8), away, 1.0, PARAMETERS).regions.any()


def test_correction_can_be_switched_off() -> None:
    off = PARAMETERS.model_copy(update={"correct_highlights": False})
    found = find_highlights(spot(8), CAMERA, 1.0, off)
    assert not found.regions.any() and (found.inpainted == spot(8).colour).all()


def test_inpainting_changes_only_what_is_masked() -> None:
    image = spot(8).colour
    mask = np.zeros((100, 200), bool)
    mask[45:55, 95:105] = True
    changed = (inpaint(image, mask) != image).any(axis=2)
    assert changed.any() and not changed[:40].any() and not changed[:, :90].any()
