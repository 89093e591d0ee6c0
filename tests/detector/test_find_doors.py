"""Flush doors in a wall of 3 x 2.5 m, of nearly the wall's colour, at 5 mm: what tells them from it."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from detector.doors import doorway_rectangles, find_doors
from detector.openings import Visibility
from detector.parameters import DetectorParameters
from detector.result import Rectangle
from detector.wall_area import find_wall_area
from tests.detector.conftest import plain_image

SHAPE = (500, 600)
DOOR = np.s_[100:, 220:400]
"""0.9 x 2 m."""
PARAMETERS = DetectorParameters()


def found(grey: NDArray[np.float64]) -> tuple[Rectangle, ...]:
    """The doors of a flat wall of grey values (H, W), of 1."""
    image = plain_image(SHAPE, pixel_size=0.005)
    image.colour[:] = np.rint(255 * grey)[..., None]
    seen, everywhere = np.full(SHAPE, Visibility.DATA, np.uint8), np.ones(SHAPE, bool)
    search, _ = find_doors(image, seen, everywhere, find_wall_area(image, PARAMETERS), (2.5, 0.0), PARAMETERS)
    return doorway_rectangles(search)


def tiles(size: int) -> NDArray[np.float64]:
    """Tiles of so many pixels, which differ by 2 %, with joints of 1 cm that are 6 % darker; one begins at row 100."""
    row, column = np.arange(SHAPE[0])[:, None] - 100, np.arange(SHAPE[1])[None]
    shades = 0.02 * np.random.default_rng(0).standard_normal((40, 40))
    wall = 0.6 + shades[row // size + 20, column // size]
    return np.where((row % size < 2) | (column % size < 2), wall - 0.06, wall)


@pytest.mark.parametrize("size", [40, 60, 120])
def test_a_door_whose_head_lies_in_line_with_a_joint_of_the_tiles_is_found(size: int) -> None:
    wall = tiles(size)
    assert found(wall) == ()

    wall[DOOR] = 0.55  # as far from the mean tile as some tiles are: wall area
    (door,) = found(wall)
    np.testing.assert_allclose([door.left, door.right, door.top], [1.1, 2.0, 2.0], atol=0.015)


def test_a_door_that_differs_by_little_more_than_noise_is_found_up_to_its_corners() -> None:
    # grain of three grey values, a step of three: smoothed over 31 pixels, its change is 6 times the median of that of
    # the grain, but 3 times at the corners, where half of the pixels are beyond the head's end; an edge is 5 times
    wall = 0.6 + 0.012 * np.random.default_rng(0).standard_normal(SHAPE)
    assert found(wall) == ()

    wall[DOOR] += 0.012
    (door,) = found(wall)
    np.testing.assert_allclose([door.left, door.right, door.top], [1.1, 2.0, 2.0], atol=0.015)
