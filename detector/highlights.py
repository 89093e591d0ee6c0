"""Specular highlights of the flash in one view: where they are and what is under them (section 4.1)."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from detector.illumination import incidence
from detector.orthoimage import nearest
from detector.parameters import DetectorParameters
from detector.result import Highlights, Image, Mask, Orthoimage

DIRECTIONS = np.array([(-1, 0), (-1, 1), (0, 1), (1, 1), (1, 0), (1, -1), (0, -1), (-1, -1)], float)
"""(8, 2) row and column steps N, NE, E, SE, S, SW, W, NW; opposite ones are four apart."""
SMOOTHING_PX = 3.0
"""Standard deviation of the filter before the intensity is quantised: noise would break every segment up."""
MIN_FEET = 5
"""Half profiles, of eight, that must run out; more than three cut off by an edge or a hole make no bell."""
DISCONTINUITY = 0.03
"""Drop of the intensity from one pixel to the next that ends a highlight."""
FLAT_RUN = 6
"""Pixels without descent after which the slope counts as zero."""
FLAT = 0.006
"""Descent over that run that counts as none, of 1."""
MAX_CANDIDATES = 30


def find_highlights(
    image: Orthoimage, camera: NDArray[np.float64], height: float, parameters: DetectorParameters
) -> Highlights:
    """Highlights of a view by the four steps of section 4.1, and the view's colour with them filled in.

    Args:
        camera: (3,) centre of the camera in wall coordinates [m].
        height: Height of the wall [m].
    """
    angles, _ = incidence(image, camera, height)
    region = angles < parameters.highlight_roi_angle
    filled = nearest(image.colour, image.coloured).astype(np.float32).mean(axis=2) / 255
    intensity = cv2.GaussianBlur(filled, (0, 0), SMOOTHING_PX)
    levels = np.minimum(intensity * parameters.grey_levels, parameters.grey_levels - 1).astype(np.uint8)
    empty = Highlights(region, levels, np.zeros(region.shape, np.int32), np.zeros(region.shape, bool), (), image.colour)
    if not parameters.correct_highlights or not (region & image.coloured).any():
        return empty
    candidates, numbers = _candidates(levels, image.coloured, region, parameters)
    regions, contours = np.zeros(region.shape, np.uint8), []
    for number in numbers:
        rows, columns = np.nonzero(candidates == number)
        contour = _contour(intensity, image.coloured, np.array([rows.mean(), columns.mean()]), parameters)
        if contour is not None:
            _fill_spline(regions, contour)
            contours.append(contour)
    found = (regions > 0) & image.coloured
    return Highlights(region, levels, candidates, found, tuple(contours), _repaired(image, found))


def _candidates(
    levels: Image, known: Mask, region: Mask, parameters: DetectorParameters
) -> tuple[NDArray[np.int32], list[int]]:
    """Segments of one grey level surrounded by lower levels and without a segment inside, largest first."""
    from skimage.measure import label, regionprops

    coded = np.where(known, levels.astype(np.int32) + 1, 0)
    segments = label(coded, background=0, connectivity=1)
    count = segments.max() + 1
    own, highest = np.zeros(count, np.int32), np.full(count, -1, np.int32)
    own[segments.ravel()] = coded.ravel()
    border = np.zeros(count, bool)
    for a, b in ((np.s_[:, 1:], np.s_[:, :-1]), (np.s_[1:], np.s_[:-1])):
        for here, there in ((a, b), (b, a)):
            differs = segments[here] != segments[there]
            np.maximum.at(highest, segments[here][differs], coded[there][differs])
            border[segments[here][differs & (coded[there] == 0)]] = True
    border[np.unique(np.concatenate([segments[0], segments[-1], segments[:, 0], segments[:, -1]]))] = True
    peaks = (own > highest) & (highest >= 0) & ~border
    peaks[0] = False
    minimum = parameters.highlight_min_area / parameters.pixel_size**2 / 8  # the top level is the tip of the highlight
    kept = np.where(peaks[segments], segments, 0)
    found = [p for p in regionprops(kept) if p.area >= minimum and p.euler_number == 1]
    found = [p for p in found if region[tuple(np.rint(p.centroid).astype(int))]]
    found.sort(key=lambda p: (-p.area, p.label))
    numbered = np.zeros(count, np.int32)
    for number, segment in enumerate(found[:MAX_CANDIDATES], start=1):
        numbered[segment.label] = number
    return numbered[segments], list(range(1, 1 + len(found[:MAX_CANDIDATES])))


def _contour(
    intensity: NDArray, known: Mask, centre: NDArray, parameters: DetectorParameters
) -> NDArray[np.float64] | None:
    """(8, 2) end points of the profiles through a region's centroid, or None if none of the four fits a Gaussian."""
    longest = parameters.highlight_max_radius / parameters.pixel_size
    profiles = [_half_profile(intensity, known, centre, step, longest) for step in DIRECTIONS]
    feet = sum(p.has_foot and p.values[0] - p.values[-1] > parameters.highlight_min_contrast / 2 for p in profiles)
    if feet < MIN_FEET:  # the fall-off of the flash, or a bright surface: not a highlight
        return None
    full = [np.concatenate([profiles[i + 4].values[:0:-1], profiles[i].values]) for i in range(4)]
    if not any(_is_gaussian(profile, parameters) for profile in full):
        return None
    return np.array([centre + (len(p.values) - 1) * step for p, step in zip(profiles, DIRECTIONS, strict=True)])


@dataclass(frozen=True, eq=False)
class _HalfProfile:
    """Intensity along one direction from a region's centroid to where the highlight ends."""

    values: NDArray
    """(n,) at least the centroid's own."""
    has_foot: bool
    """The slope reached zero there; else a discontinuity or the end of the data cut it off."""


def _half_profile(intensity: NDArray, known: Mask, centre: NDArray, step: NDArray, longest: float) -> _HalfProfile:
    """Intensity from the centroid outwards, until the slope gets to zero or breaks, or the data end."""
    path = np.rint(centre + np.arange(max(2, int(longest / np.hypot(*step))))[:, None] * step).astype(int)
    inside = ((path >= 0) & (path < known.shape)).all(axis=1)
    path = path[: _first(~inside)]
    path = path[: max(1, _first(~known[path[:, 0], path[:, 1]]))]
    values = intensity[path[:, 0], path[:, 1]]
    if len(values) <= FLAT_RUN:
        return _HalfProfile(values[:1], has_foot=False)
    broken = _first(np.abs(np.diff(values)) > DISCONTINUITY)
    descending = values[:-FLAT_RUN] - values[FLAT_RUN:] > FLAT
    below_top = values[0] - values[:-FLAT_RUN] > 2 * FLAT  # the clipped top is flat, too
    flat = _first(below_top & ~descending)
    return _HalfProfile(values[: min(broken, flat) + 1], has_foot=flat < min(broken, len(descending)))


def _first(mask: NDArray[np.bool_]) -> int:
    """Index of the first True, or the length."""
    return int(mask.argmax()) if mask.any() else len(mask)


def _is_gaussian(profile: NDArray, parameters: DetectorParameters) -> bool:
    """Whether a profile is a Gaussian over a level foot, cut at the top if the photograph was overexposed."""
    from scipy.optimize import curve_fit

    if len(profile) < 9 or np.ptp(profile) < parameters.highlight_min_contrast:
        return False
    x = np.linspace(-1, 1, len(profile))
    ceiling = profile.max()

    def model(x: NDArray, height: float, mean: float, width: float, foot: float) -> NDArray:
        return np.minimum(foot + height * np.exp(-0.5 * ((x - mean) / width) ** 2), ceiling)

    start = (np.ptp(profile), x[np.argmax(profile)], 0.4, profile.min())
    bounds = ([0, -0.8, 0.05, -0.5], [5, 0.8, 1.5, 1.0])
    try:
        fitted, _ = curve_fit(model, x, profile, np.clip(start, bounds[0], bounds[1]), bounds=bounds, max_nfev=60)
    except RuntimeError:  # no convergence within max_nfev: not a Gaussian
        return False
    residual = ((profile - model(x, *fitted)) ** 2).sum()
    return 1 - residual / ((profile - profile.mean()) ** 2).sum() >= parameters.highlight_r2


def _fill_spline(regions: NDArray[np.uint8], contour: NDArray[np.float64]) -> None:
    """Draw the closed spline through eight points into the mask."""
    from scipy.interpolate import CubicSpline

    closed = np.concatenate([contour, contour[:1]])
    outline = CubicSpline(np.arange(9), closed, bc_type="periodic")(np.linspace(0, 8, 129)[:-1])
    cv2.fillPoly(regions, [np.rint(outline[:, ::-1]).astype(np.int32)], 1)


def _repaired(image: Orthoimage, found: Mask) -> Image:
    """The colour with the highlights filled in, and nothing bled in from where no colour is known."""
    if not found.any():
        return image.colour
    filled = inpaint(nearest(image.colour, image.coloured), found)
    return np.where(image.coloured[..., None], filled, np.uint8(0))


def inpaint(colour: Image, mask: Mask, radius_px: int = 5) -> Image:
    """The colour with the masked pixels filled in from around, by Telea's method.

    Section 4.2 uses Fields of Experts, for which no Python package exists.
    """
    if not mask.any():
        return colour
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    margin = 2 * radius_px
    box = np.s_[
        max(rows[0] - margin, 0) : rows[-1] + margin + 1, max(columns[0] - margin, 0) : columns[-1] + margin + 1
    ]
    filled = colour.copy()
    grown = cv2.dilate(mask[box].astype(np.uint8), np.ones((3, 3), np.uint8))
    filled[box] = cv2.inpaint(np.ascontiguousarray(colour[box]), grown, radius_px, cv2.INPAINT_TELEA)
    return filled
