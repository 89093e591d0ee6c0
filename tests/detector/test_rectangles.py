"""Lateral histograms, lines, openings and metrics."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from detector.metrics import overlap
from detector.openings import Visibility, cluster_centroids, find_openings, trinary_image, visibility
from detector.parameters import DetectorParameters
from detector.rectangles import box_sums, find_lines, integral, lateral_histogram, pairs
from detector.result import Rectangle
from detector.room import VoxelLabel, Wall
from tests.detector.conftest import plain_image


def test_a_lateral_histogram_counts_edges_along_the_best_window() -> None:
    edges = np.zeros((40, 30), bool)
    edges[10:20, 7] = True
    shares = lateral_histogram(edges, 0, 20)
    assert shares[7] == pytest.approx(0.5) and shares[8] == 0


def test_lines_lie_between_the_two_pixels_of_an_edge() -> None:
    edges = np.zeros((100, 60), bool)
    edges[20:, 14:16] = True  # both sides of the border between columns 14 and 15
    edges[:, 40] = True
    edges[5, ::3] = True  # a dotted row is no upright line
    np.testing.assert_allclose(find_lines(edges, 0, 50, 0.6), [14.5, 40], atol=0.1)


def test_lines_shorter_than_their_share_of_the_window_are_dropped() -> None:
    edges = np.zeros((100, 60), bool)
    edges[0:25, 10] = True
    assert len(find_lines(edges, 0, 50, 0.6)) == 0 and len(find_lines(edges, 0, 50, 0.5)) == 1


def test_pairs_are_within_the_range_of_distances() -> None:
    assert pairs(np.array([0.0, 3.0, 10.0]), 5, 8).tolist() == [[1, 2]]


def test_box_sums_are_the_sums_over_half_open_boxes() -> None:
    image = np.arange(12).reshape(3, 4)
    # rows 1 and 2, columns 1 and 2: 5 + 6 + 9 + 10
    assert box_sums(integral(image), np.array([[1, 1, 3, 3]])).tolist() == [30]


def test_areas_follow_equations_2_to_9() -> None:
    # Q is 1 x 2 m, G the same 0.25 m further right: 1.5 m2 in common, 0.5 m2 too much, 0.5 m2 missing
    both = overlap(Rectangle(0, 0, 1, 2), Rectangle(0.25, 0, 1.25, 2))
    assert (both.true_positive, both.false_positive, both.false_negative) == (1.5, 0.5, 0.5)
    assert both.precision == both.recall == both.f_measure(2.0) == 0.75
    assert both.absolute_error == 1.0 and both.relative_error == 0.5


def test_f_beta_leans_to_recall_for_large_beta() -> None:
    small = overlap(Rectangle(0, 0, 1, 1), Rectangle(0, 0, 1, 2))  # P = 1, R = 1/2
    assert small.f_measure(2.0) == pytest.approx(5 * 0.5 / 4.5)
    assert small.f_measure(2.0) < small.f_measure(0.5)


def test_rectangles_apart_have_nothing_in_common() -> None:
    apart = overlap(Rectangle(0, 0, 1, 1), Rectangle(2, 0, 3, 1))
    assert apart.precision == apart.recall == apart.f_measure() == 0.0


def labelled(wall: Wall, labels: np.ndarray) -> Wall:
    return Wall(wall.origin, wall.u, wall.v, wall.width, wall.height, labels)


def test_the_trinary_image_shows_data_holes_and_centroids(wall: Wall) -> None:
    image = plain_image()
    image.depth[40:, 60:100] = np.nan
    labels = wall.voxel_labels.copy()
    labels[2:, 3:5] = VoxelLabel.OPENING
    trinary = trinary_image(image, labelled(wall, labels))
    # voxels of 20 pixels: that of row 3, column 4 has its centre at pixel (70, 90)
    assert trinary[70, 90] == 2 and (trinary == 2).sum() == 6
    assert trinary[70, 80] == 0 and trinary[70, 50] == 1


def test_openings_grow_over_neighbouring_voxels(wall: Wall) -> None:
    opening = np.zeros((5, 10), bool)
    opening[1, 1] = opening[2, 2] = opening[0, 7] = True
    clusters = cluster_centroids(opening)
    assert clusters[1, 1] == clusters[2, 2] != clusters[0, 7]


def test_the_rectangle_of_an_opening_hugs_its_hole_and_tells_doors_from_windows(wall: Wall) -> None:
    image = plain_image()
    image.depth[40:, 21:62] = np.nan  # a hole down to the floor: u from 0.21 to 0.62, v to 0.60
    image.depth[20:60, 121:162] = np.nan  # a window
    labels = wall.voxel_labels.copy()
    labels[2:, 1:3] = labels[1:3, 6:8] = VoxelLabel.OPENING
    seen = np.zeros((100, 200), np.uint8)
    openings = find_openings(image, seen, labelled(wall, labels), 0.0, DetectorParameters(pixel_size=0.01))
    door = openings.rectangles[openings.is_door.index(True)]
    assert openings.is_door.count(True) == 1 and len(openings.rectangles) == 2
    assert (door.left, door.right, door.top, door.bottom) == pytest.approx((0.21, 0.62, 0.60, 0.0), abs=0.011)


def test_visibility_tells_holes_from_shadows(wall: Wall) -> None:
    image = plain_image()
    image.depth[:, 50:] = np.nan
    passed, blocked = np.zeros((100, 200), bool), np.zeros((100, 200), bool)
    passed[:, 50:80] = True
    blocked[:, 70:120] = True
    labels = wall.voxel_labels.copy()
    labels[:, 7:] = VoxelLabel.OPENING  # from column 140 on: nothing behind, so that no beam came back
    seen = visibility(image, passed, blocked, labelled(wall, labels))
    expected = [Visibility.DATA, Visibility.THROUGH, Visibility.SHADOWED, Visibility.UNKNOWN, Visibility.THROUGH]
    assert seen[50, [10, 75, 100, 130, 150]].tolist() == expected


def test_a_leaf_that_stands_out_of_the_wall_voxels_is_no_data_of_the_trinary_image(wall: Wall) -> None:
    image = replace(plain_image(), depth=np.full((100, 200), 0.15, np.float32))
    assert not (trinary_image(image, wall) == 1).any()
