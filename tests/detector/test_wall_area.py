"""Wall area (section 6.1) and discontinuities (section 6.2)."""

from __future__ import annotations

import numpy as np
import pytest

from detector.edges import colour_threshold, depth_edges, di_zenzo, find_edges, structure_tensor
from detector.openings import Visibility
from detector.parameters import DetectorParameters
from detector.wall_area import (
    adaptive_kmeans,
    coherent_seeds,
    find_wall_area,
    kmeans,
    pair_distances,
    rgbd,
    silhouettes,
)
from tests.detector.conftest import plain_image

PARAMETERS = DetectorParameters(pixel_size=0.01)


def test_the_silhouette_is_the_one_of_the_definition() -> None:
    # at 0 and 2, and at 10: a = 2 to the partner, b = 10 and 8 to the other cluster; alone: 0
    samples = np.array([[0.0], [2.0], [10.0]], np.float32)
    np.testing.assert_allclose(
        silhouettes(pair_distances(samples, samples), np.array([1, 1, 2])), [0.8, 0.75, 0.0], atol=1e-6
    )


def test_kmeans_separates_two_groups_whatever_their_order() -> None:
    samples = np.array([0.0, 1.0, 0.1, 0.9, 0.05, 1.1], np.float32)[:, None] * np.ones((1, 4), np.float32)
    assigned = kmeans(samples, 2)
    assert len(set(assigned[[0, 2, 4]])) == len(set(assigned[[1, 3, 5]])) == 1 and assigned[0] != assigned[1]


def test_the_number_of_clusters_is_found() -> None:
    rng = np.random.default_rng(0)
    centres = np.array([[0.1, 0.1, 0.1, 0], [0.5, 0.5, 0.5, 0], [0.9, 0.9, 0.9, 0]])
    samples = (centres[np.arange(90) % 3] + rng.normal(0, 0.01, (90, 4))).astype(np.float32)
    assert len(np.unique(adaptive_kmeans(samples, pair_distances(samples, samples), PARAMETERS))) == 3


def test_a_wall_of_one_colour_is_one_cluster() -> None:
    rng = np.random.default_rng(0)
    samples = (0.5 + rng.normal(0, 0.01, (200, 4))).astype(np.float32)
    assert (adaptive_kmeans(samples, pair_distances(samples, samples), PARAMETERS) == 1).all()


def test_seeds_on_an_edge_or_beside_a_hole_are_not_coherent() -> None:
    image = plain_image()
    image.colour[:, 102:] = 255  # the edge runs through the seeds of columns 100 to 104
    values, known = rgbd(image, PARAMETERS), np.ones((100, 200), bool)
    known[:, :3] = False
    seeds, means = coherent_seeds(values, known, PARAMETERS.model_copy(update={"max_seeds": 20_000}))
    columns = set(seeds[:, 1].tolist())
    assert 100 not in columns and 0 not in columns and {5, 95, 105} <= columns
    assert means.shape == (len(seeds), 4)


def test_the_wall_is_what_reaches_the_borders_and_not_the_door() -> None:
    image = plain_image(grey=200)
    image.colour[30:, 60:120] = 60
    area = find_wall_area(image, PARAMETERS)
    assert area.mask[10, 100] and area.mask[50, 20] and not area.mask[60:95, 65:115].any()


def test_a_recessed_door_of_the_walls_colour_is_told_by_its_depth() -> None:
    image = plain_image(grey=200)
    image.depth[30:, 60:120] = -0.08
    area = find_wall_area(image, PARAMETERS)
    assert area.mask[50, 20] and not area.mask[60:95, 65:115].any()


def test_without_any_colour_depth_decides() -> None:
    image = plain_image(grey=0)
    image.coloured[:] = False
    image.depth[30:, 60:120] = -0.08
    area = find_wall_area(image, PARAMETERS)
    assert area.mask[50, 20] and not area.mask[60:95, 65:115].any()


def test_di_zenzo_gives_the_slope_of_a_ramp_in_colour_space() -> None:
    # each channel rises by 3, 4 and 0 hundredths a column: together by 0.05
    dx = np.tile(np.array([0.03, 0.04, 0.0], np.float32), (5, 5, 1))
    np.testing.assert_allclose(di_zenzo(*structure_tensor(dx, np.zeros_like(dx))), 0.05, rtol=1e-5)


def test_otsu_separates_a_strong_edge_from_texture_and_the_cap_keeps_a_faint_one() -> None:
    gradient = np.full((100, 100), 0.002, np.float32)
    gradient[:, 10] = 0.2
    gradient[:, 50] = 0.03
    otsu = PARAMETERS.model_copy(update={"colour_threshold": "otsu"})
    known = np.ones_like(gradient, bool)
    assert 0.03 <= colour_threshold(gradient, known, otsu) < 0.2  # what exceeds it is an edge
    assert 0.008 <= colour_threshold(gradient, known, PARAMETERS) <= 0.02


def test_a_hole_has_depth_edges_and_a_shadow_has_none() -> None:
    image = plain_image()
    seen = np.full((100, 200), Visibility.DATA, np.uint8)
    for columns, kind in ((np.s_[20:60], Visibility.THROUGH), (np.s_[120:160], Visibility.SHADOWED)):
        image.depth[:, columns] = np.nan
        seen[:, columns] = kind
    relief = depth_edges(image.depth, seen, image.pixel_size, PARAMETERS)
    upright = (relief.edges & relief.across)[50]
    assert set(np.flatnonzero(upright)) <= {18, 19, 20, 21, 58, 59, 60, 61} and upright[18:22].any()


def test_a_sloping_leaf_has_an_edge_at_its_hinge_and_none_on_its_face() -> None:
    image = plain_image((100, 600), pixel_size=0.005)
    image.depth[:, 450:] = (np.arange(150) * 0.005 * np.tan(np.deg2rad(20)))[None]
    seen = np.full((100, 600), Visibility.DATA, np.uint8)
    edges = np.flatnonzero(depth_edges(image.depth, seen, 0.005, PARAMETERS).edges[50])
    assert len(edges) and (np.abs(edges - 450) <= 2).all()


def test_edges_know_the_direction_of_the_side_that_they_can_belong_to() -> None:
    image = plain_image()
    image.colour[:, 100:] = 200
    edges = find_edges(image, np.full((100, 200), Visibility.DATA, np.uint8), PARAMETERS)
    assert edges.upright[50, 99:101].all() and not edges.level.any()
    assert edges.colour.sum() == pytest.approx(200, abs=10)
