"""Specular highlights of the flash in one view: where they are and what is under them (section 4.1)."""

from __future__ import annotations

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
LINE_PX = 11
"""Dark lines up to this wide, the gaps round a door's leaf, are closed before: they cut highlights into pieces."""
MIN_FLANKS = 3
"""Half profiles, of eight, that must be a Gaussian's flank; an edge, a hole or an occlusion may cut the others off."""
DISCONTINUITY = 0.02
"""Step of the intensity from one pixel to the next that ends a highlight: an edge of about 0.15 after smoothing."""
SLOPE_PX = 25
"""Window of the slope that a step is compared with: several times as wide as a smoothed edge."""
PLATEAU = 0.03
"""Below the brightest by less than this, a profile is on the overexposed top, which is not fitted."""
HOLLOW = 0.12
"""An overexposed top is this much darker than its rim at most, after the fall-off of the flash was divided out."""
WIDTHS = np.geomspace(4, 400, 40)
"""Standard deviations that are tried for a Gaussian [px]."""
FOOT = 2.7
"""Standard deviations after which the slope of a Gaussian is as good as zero: 7 % of its steepest."""
MIN_REACH = 1.5
"""Standard deviations of its Gaussian that a flank must be seen over: less is a slope that needs no highlight."""
INPAINTED_PX = 4_000
"""Larger masks are inpainted at a coarser scale, where they have about this many pixels: the filling is smooth."""
MARGIN_PX = 30
"""Border round a mask that it is inpainted from; three pixels at the coarsest scale of usual highlights."""
MAX_CANDIDATES = 30


def find_highlights(
    image: Orthoimage, camera: NDArray[np.float64], height: float, parameters: DetectorParameters
) -> Highlights:
    """Highlights of a view by the four steps of section 4.1, and the view's colour with them filled in.

    Args:
        camera: (3,) centre of the camera in wall coordinates [m].
        height: Height of the wall [m].
    """
    angles = incidence(image, camera, height)[0]
    region = angles < parameters.highlight_roi_angle
    box = bounding_box(region)
    known, shape = image.coloured[box], region.shape
    intensity = _intensity(image.colour[box], known)
    levels, candidates = np.zeros(shape, np.uint8), np.zeros(shape, np.int32)
    levels[box] = np.minimum(intensity * parameters.grey_levels, parameters.grey_levels - 1)
    empty = Highlights(region, levels, candidates, np.zeros(shape, bool), (), image.colour)
    if not parameters.correct_highlights or not (region[box] & known).any():
        return empty
    mirrors = angles[box] < parameters.highlight_mirror_angle
    candidates[box], centres = _candidates(levels[box], known, region[box] & mirrors, parameters)
    # no lobe reaches further from its centre than the region of interest does: it grows with the distance to the wall
    longest = float(np.tan(parameters.highlight_roi_angle) * abs(camera[2]) / parameters.pixel_size)
    corner = np.array([box[0].start, box[1].start], float)
    drawn, contours = np.zeros(shape, np.uint8), []
    for centre in centres:
        contour = _contour(intensity, known, centre, longest, parameters)
        if contour is not None:
            contours.append(contour + corner)
            _fill_spline(drawn, contours[-1])
    found = (drawn > 0) & region & image.coloured
    return Highlights(region, levels, candidates, found, tuple(contours), repaired(image, found))


def bounding_box(mask: Mask, margin: int = 0) -> tuple[slice, slice]:
    """Rows and columns that hold every True, and some more where there are; empty slices if there is none."""
    if not mask.any():
        return np.s_[0:0, 0:0]
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    return (
        slice(max(int(rows[0]) - margin, 0), int(rows[-1]) + margin + 1),
        slice(max(int(columns[0]) - margin, 0), int(columns[-1]) + margin + 1),
    )


def _intensity(colour: Image, known: Mask) -> NDArray[np.float32]:
    """Smoothed intensity in 0..1, with unknown pixels filled in and dark lines closed; empty from an empty image."""
    if colour.size == 0:
        return np.zeros(known.shape, np.float32)
    grey = nearest(cv2.transform(colour, np.full((1, 3), 1 / 3, np.float32)), known).astype(np.float32) / 255
    closed = cv2.morphologyEx(grey, cv2.MORPH_CLOSE, np.ones((LINE_PX, LINE_PX), np.uint8))
    return np.asarray(cv2.GaussianBlur(closed, (0, 0), SMOOTHING_PX), np.float32)


def _candidates(
    levels: Image, known: Mask, region: Mask, parameters: DetectorParameters
) -> tuple[NDArray[np.int32], list[NDArray[np.float64]]]:
    """Segments of one grey level surrounded by lower levels, largest first, and their centroids as (row, column).

    The paper's segments contain no other. An overexposed top is darker in the middle after the fall-off of the flash
    was divided out, so that ours may: the profiles tell it from a ring.
    """
    from skimage.measure import label

    coded = np.where(known, levels + np.uint8(1), np.uint8(0))
    segments = label(coded, background=0, connectivity=1)
    count = segments.max() + 1
    # neighbours beyond the border count as unknown, and a segment without a neighbour has only these
    cross = cv2.getStructuringElement(cv2.MORPH_CROSS, (3, 3))
    highest, lowest = (
        change(coded, cross, borderType=cv2.BORDER_CONSTANT, borderValue=0) for change in (cv2.dilate, cv2.erode)
    )
    peaks = np.bincount(segments.ravel(), ((highest > coded) | (lowest == 0)).ravel(), count) == 0
    peaks[0] = False
    minimum = parameters.min_highlight_area / parameters.pixel_size**2 / 8  # the top level is the tip of the highlight
    areas = np.bincount(segments.ravel(), minlength=count)
    large = peaks & (areas >= minimum)
    pixels = np.nonzero(large[segments])
    members = segments[pixels]
    centroids = np.stack([np.bincount(members, axis, count) for axis in pixels], axis=1) / np.maximum(areas, 1)[:, None]
    found = np.flatnonzero(large)
    found = found[region[tuple(np.rint(centroids[found]).astype(int).T)]]
    found = found[np.argsort(-areas[found], kind="stable")][:MAX_CANDIDATES]
    numbered = np.zeros(count, np.int32)
    numbered[found] = np.arange(1, len(found) + 1)
    return numbered[segments], list(centroids[found])


def _contour(
    intensity: NDArray, known: Mask, centre: NDArray, longest: float, parameters: DetectorParameters
) -> NDArray[np.float64] | None:
    """(8, 2) end points of the profiles through a region's centroid, or None if too few of them are a Gaussian's."""
    profiles = [_half_profile(intensity, known, centre, step, longest) for step in DIRECTIONS]
    strides = np.hypot(*DIRECTIONS.T)  # a diagonal step is longer [px]
    widths = np.array([_flank_width(p, s, parameters) for p, s in zip(profiles, strides, strict=True)])
    if np.isfinite(widths).sum() < MIN_FLANKS:  # a bright surface, or too much of it hidden: not a highlight
        return None
    reach = FOOT * np.where(np.isfinite(widths), widths, np.nanmedian(widths))
    ends = np.minimum(reach / strides, [len(p) - 1 for p in profiles])
    return centre + ends[:, None] * DIRECTIONS


def _half_profile(intensity: NDArray, known: Mask, centre: NDArray, step: NDArray, longest: float) -> NDArray:
    """(n,) intensity from the centroid outwards, until it breaks or the data end; n is at least 1."""
    from scipy.ndimage import median_filter

    path = np.rint(centre + np.arange(max(2, int(longest / np.hypot(*step))))[:, None] * step).astype(int)
    inside = ((path >= 0) & (path < known.shape)).all(axis=1)
    path = path[: _first(~inside)]
    path = path[: max(1, _first(~known[path[:, 0], path[:, 1]]))]
    values = intensity[path[:, 0], path[:, 1]]
    if len(values) < 2:
        return values
    slope = np.diff(values)
    around = median_filter(slope, SLOPE_PX, mode="nearest")  # the flank of an overexposed lobe is steep, but for longer
    return values[: _first(np.abs(slope - around) > DISCONTINUITY * np.hypot(*step)) + 1]


def _first(mask: NDArray[np.bool_]) -> int:
    """Index of the first True, or the length."""
    return int(mask.argmax()) if mask.any() else len(mask)


def _flank_width(profile: NDArray, stride: float, parameters: DetectorParameters) -> float:
    """Standard deviation [px] of the Gaussian round the centroid whose flank a half profile is; NaN if it is none.

    Args:
        profile: (n,) intensity from the centroid outwards.
        stride: Distance between its samples [px].
    """
    top = profile.max()
    start = len(profile) - 1 - int((profile[::-1] > top - PLATEAU).argmax())
    flank = profile[start:]
    if profile[0] < top - HOLLOW or len(flank) < 9 or np.ptp(profile) < parameters.min_highlight_contrast:
        return float("nan")
    # foot + height * exp(-r^2 / 2 width^2) is linear in foot and height: least squares for every width at once
    distances = stride * np.arange(start, len(profile))
    bells = np.exp(-0.5 * (distances / WIDTHS[:, None]) ** 2)
    centred, values = bells - bells.mean(axis=1, keepdims=True), flank - flank.mean()
    energy = np.maximum((centred**2).sum(axis=1), 1e-12)
    explained = np.where(centred @ values > 0, (centred @ values) ** 2 / energy, 0) / (values**2).sum()
    best = int(explained.argmax())
    seen = distances[-1] / WIDTHS[best]
    return float(WIDTHS[best]) if explained[best] >= parameters.highlight_r2 and seen >= MIN_REACH else float("nan")


def _fill_spline(regions: NDArray[np.uint8], contour: NDArray[np.float64]) -> None:
    """Draw the closed spline through eight points into the mask."""
    from scipy.interpolate import CubicSpline

    closed = np.concatenate([contour, contour[:1]])
    outline = CubicSpline(np.arange(9), closed, bc_type="periodic")(np.linspace(0, 8, 129)[:-1])
    cv2.fillPoly(regions, [np.rint(outline[:, ::-1]).astype(np.int32)], 1)


def repaired(image: Orthoimage, found: Mask) -> Image:
    """The colour with the highlights filled in, and nothing bled in from where no colour is known."""
    if not found.any():
        return image.colour
    box = bounding_box(found, margin=MARGIN_PX)
    repaired, known = image.colour.copy(), image.coloured[box]
    filled = inpaint(nearest(image.colour[box], known), found[box])
    repaired[box] = np.where(known[..., None], filled, np.uint8(0))
    return repaired


def inpaint(colour: Image, mask: Mask, radius_px: int = 5) -> Image:
    """The colour with the masked pixels filled in from around, by Telea's method.

    Section 4.2 uses Fields of Experts, for which no Python package exists.
    """
    if not mask.any():
        return colour
    box = bounding_box(mask, margin=MARGIN_PX)
    filled = colour.copy()
    part, grown = np.ascontiguousarray(colour[box]), cv2.dilate(mask[box].astype(np.uint8), np.ones((3, 3), np.uint8))
    shrink = max(1.0, float(np.sqrt(grown.sum() / INPAINTED_PX)))
    size = (max(1, round(part.shape[1] / shrink)), max(1, round(part.shape[0] / shrink)))
    small = cv2.resize(part, size, interpolation=cv2.INTER_AREA)
    small_mask = (cv2.resize(grown * np.float32(1), size, interpolation=cv2.INTER_AREA) > 0).astype(np.uint8)
    patch = cv2.resize(cv2.inpaint(small, small_mask, radius_px, cv2.INPAINT_TELEA), part.shape[1::-1])
    filled[box] = np.where(grown[..., None] > 0, patch, part)
    return filled
