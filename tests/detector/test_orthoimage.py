"""Orthoimages of single views (section 4)."""

from __future__ import annotations

import numpy as np
import pytest

from detector.orthoimage import close_gaps, crop, image_shape, largest, nearest, orthoimage, sampling_gap
from detector.parameters import DetectorParameters
from detector.room import DetectorError, View, Wall

PARAMETERS = DetectorParameters(pixel_size=0.1, slab_front=0.2, slab_behind=0.25)


def view_of(points: list, colours: list | None = None) -> View:
    """A scanner 2 m before the wall's middle; the wall is y = 0 and the room lies at y < 0."""
    n = len(points)
    return View(
        points_in_world=np.array(points, np.float32).reshape(n, 3),
        colours=np.array(colours if colours is not None else [[9, 9, 9]] * n, np.uint8).reshape(n, 3),
        coloured=np.ones(n, bool),
        scanner_in_world=np.array([1.0, -2.0, 0.5]),
        camera_in_world=np.array([1.0, -2.0, 0.7]),
    )


def test_a_pixel_has_the_mean_colour_and_the_largest_depth_of_its_points(wall: Wall) -> None:
    # u = 0.05 is column 0; v = 0.95 is row 0. Depth into the room is -y: 0.01 and 0.03.
    points = crop(
        view_of([[0.05, -0.01, 0.95], [0.06, -0.03, 0.94]], [[10, 20, 30], [30, 40, 50]]), wall, 0, PARAMETERS
    )
    image = orthoimage(points, wall, 1, PARAMETERS)
    assert image.colour[0, 0].tolist() == [20, 30, 40]
    assert image.depth[0, 0] == pytest.approx(0.03)
    assert np.isnan(image.depth[5, 5]) and not image.coloured[5, 5]


def test_rows_count_from_the_top_and_columns_from_the_left_seen_from_inside(wall: Wall) -> None:
    points = crop(view_of([[1.95, 0, 0.05]]), wall, 0, PARAMETERS)  # bottom right
    image = orthoimage(points, wall, 1, PARAMETERS)
    assert np.argwhere(image.coloured).tolist() == [[9, 19]]


def test_points_outside_the_slab_or_at_the_floor_are_no_wall_data(wall: Wall) -> None:
    # 0.3 m before the wall; 0.3 m behind it; 1 cm over the floor
    kept = crop(view_of([[1, -0.3, 0.5], [1, 0.3, 0.5], [1, 0, 0.01], [1, 0, 0.5]]), wall, 0, PARAMETERS)
    assert len(kept.slab) == 1


def test_points_that_are_nan_are_left_out(wall: Wall) -> None:
    kept = crop(view_of([[np.nan, np.nan, np.nan], [1, 0, 0.5]]), wall, 0, PARAMETERS)
    assert len(kept.slab) == 1 and np.isfinite(kept.around).all()


def test_a_beam_that_ends_behind_the_wall_is_marked_where_it_crossed_its_face(wall: Wall) -> None:
    # from y = -2 to y = +2: halfway, so at u = (1 + 2) / 2
    kept = crop(view_of([[2.0, 2.0, 0.5], [1, 0, 0.5]]), wall, 0, PARAMETERS)
    np.testing.assert_allclose(kept.passed, [[1.5, 0.5]], atol=1e-6)


def test_a_view_from_behind_the_wall_does_not_see_it() -> None:
    turned = Wall(
        np.array([2.0, 0, 0]), np.array([-1.0, 0, 0]), np.array([0, 0, 1.0]), 2, 1, np.ones((5, 10), np.uint8)
    )
    assert crop(view_of([[1, 0, 0.5]]), turned, 0, PARAMETERS) is None


def test_the_sampling_gap_follows_from_the_density_of_the_points(wall: Wall) -> None:
    # samples every 30 mm, seen from 2 m, are 6 pixels of 5 mm apart; closed with half as much again
    u, v = np.meshgrid(np.arange(0.01, 2, 0.03), np.arange(0.03, 1, 0.03))
    points = np.stack([u.ravel(), np.zeros(u.size), v.ravel()], axis=1)
    fine = DetectorParameters(pixel_size=0.005, max_gap_px=30)
    assert sampling_gap(crop(view_of(points.tolist()), wall, 0, fine), fine) in range(8, 14)


def test_closing_gaps_fills_between_samples_and_leaves_holes_and_borders() -> None:
    mask = np.zeros((20, 20), bool)
    mask[::2, 0:10:2] = True
    closed = close_gaps(mask, 2)
    assert closed[:19, :9].all() and not closed[:, 9:].any()


def test_nearest_takes_the_value_of_the_closest_known_pixel() -> None:
    image = np.array([[1.0, np.nan, np.nan, np.nan, 5.0]], np.float32)
    assert nearest(image, np.isfinite(image))[0, [1, 3]].tolist() == [1.0, 5.0]


def test_an_image_that_is_too_large_names_the_pixel_size(wall: Wall) -> None:
    with pytest.raises(DetectorError, match="pixel_size"):
        image_shape(wall, DetectorParameters(pixel_size=1e-5))


def test_wall_coordinates_and_world_coordinates_are_inverse() -> None:
    u = np.array([0.6, 0.8, 0.0])
    oblique = Wall(np.array([3.0, -4.0, 0.5]), u, np.array([0, 0, 1.0]), 2, 1, np.ones((5, 10), np.uint8))
    points = np.random.default_rng(0).uniform(-5, 5, (50, 3))
    np.testing.assert_allclose(oblique.world_from_wall(oblique.wall_from_world(points)), points, atol=1e-12)


def test_the_largest_value_of_each_index_is_kept_to_the_bit() -> None:
    values = np.float32([0.1, -0.3, 0.2, -0.7])
    found = largest(np.array([0, 3, 0, 3]), values, 4)
    np.testing.assert_array_equal(found, np.float32([0.2, np.nan, np.nan, -0.3]))
