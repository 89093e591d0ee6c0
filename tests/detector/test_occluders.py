"""What hides a wall of 3 x 3 m at 1 cm, and what is a part of it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from detector.edges import Edges
from detector.occluders import occluders
from detector.openings import Visibility
from detector.parameters import DetectorParameters
from detector.result import Mask
from tests.detector.conftest import plain_image

SIDE = 300
NOTHING = np.zeros((SIDE, SIDE), bool)


def hidden(depth: NDArray, *, sloping: Mask = NOTHING, seen: NDArray | None = None) -> Mask:
    image = plain_image((SIDE, SIDE))
    image.depth[:] = depth
    looked = np.full((SIDE, SIDE), Visibility.DATA, np.uint8) if seen is None else seen
    nothing = NOTHING.copy()
    return occluders(
        image,
        looked,
        Edges(nothing, nothing, nothing, nothing, sloping, nothing, nothing, nothing),
        DetectorParameters(),
    )


def columns(first: int, last: int) -> Mask:
    mask = NOTHING.copy()
    mask[50:, first:last] = True
    return mask


def test_a_curtain_hides_the_wall_however_its_folds_slope() -> None:
    curtain = columns(100, 160)
    folds = 0.1 + 0.03 * np.sin(2 * np.pi * np.arange(SIDE) / 10)  # 7 to 13 cm before the wall, every 10 cm
    found = hidden(np.where(curtain, folds, 0.0), sloping=curtain)

    assert found[curtain].all()
    assert not found[:, :97].any()  # its silhouette is 1.5 cm wide
    assert not found[:, 163:].any()


def test_a_pole_one_pixel_wide_hides_what_is_behind_it() -> None:
    pole = columns(100, 101)
    assert hidden(np.where(pole, 0.07, 0.0))[pole].all()


def test_a_leaf_on_the_wall_s_face_is_a_leaf() -> None:
    assert not hidden(np.where(columns(100, 190), 0.05, 0.0)).any()


def test_a_leaf_that_is_ajar_hides_nothing() -> None:
    # 4 deg: 0.9 m of leaf come 6.3 cm out of the wall, at the hinge by degrees, and end above the hole
    leaf = columns(100, 190)
    depth = np.where(leaf, 0.07 * 0.01 * (np.arange(SIDE) - 100), 0.0)
    assert not hidden(depth).any()


def test_the_shadow_of_furniture_is_no_wall_and_its_rim_no_discontinuity() -> None:
    shadow = columns(100, 130)
    depth = np.where(shadow, np.nan, 0.0)
    seen = np.where(shadow, Visibility.SHADOWED, Visibility.DATA).astype(np.uint8)

    found = hidden(depth, seen=seen)

    assert found[:, 98:132][60:].all()
    assert not found[:, :96].any()


def test_what_a_leaf_hides_lies_in_its_doorway() -> None:
    leaf, shadow = columns(100, 130), columns(130, 160)
    depth = np.where(shadow, np.nan, np.where(leaf, 0.5 * 0.01 * (np.arange(SIDE) - 100), 0.0))
    seen = np.where(shadow, Visibility.SHADOWED, Visibility.DATA).astype(np.uint8)
    assert not hidden(depth, sloping=leaf, seen=seen).any()
