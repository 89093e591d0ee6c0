"""What both recordings draw alike."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest

from mission.angles import degrees_text
from mission.events import Drove
from mission.recording.drawing import (
    angle_label,
    display_colours,
    jpeg,
    on_grid,
    quads,
    score_colours,
    shrink,
    thin,
)
from mission.recording.rerun_world import hover
from mission.recording.sentences import level, sentence
from tests.mission.recording_room import JOINT, door, evaluation, walls
from tests.mission.recording_story import story


def test_thinning_keeps_one_point_a_cell() -> None:
    steps = np.arange(100, dtype=np.float32) / 100  # a metre with a point every centimetre
    points = np.stack([steps, np.zeros(100, np.float32), np.zeros(100, np.float32)], axis=1)
    assert len(thin(points, cell=0.1)) == 11  # cells round 0.0, 0.1 ... 1.0: shifted by half a cell


def test_noise_about_a_round_coordinate_stays_in_one_layer() -> None:
    rng = np.random.default_rng(0)
    points = rng.uniform(0, 1, (20_000, 3)).astype(np.float32)
    points[:, 2] = 2.0 + rng.normal(0, 0.004, 20_000)  # a plane 4 sigma from either side of its cells
    assert len(thin(points, cell=0.05)) <= 21 * 21


def test_thinning_is_limited_whatever_comes() -> None:
    points = np.random.default_rng(0).uniform(-300, 300, (50_000, 3)).astype(np.float32)  # no two share a cell
    chosen = thin(points, limit=1000)
    assert 900 <= len(chosen) <= 1000
    assert len(np.unique(chosen)) == len(chosen)


def test_a_dense_scan_is_thinned_without_stripes() -> None:
    """A turn of 6000 beams over 3 m of wall, 60 rows over 1.2 m: 60 x 24 cells, and one to either side."""
    across, up = np.meshgrid(np.linspace(0, 3, 6000, dtype=np.float32), np.linspace(0, 1.2, 60, dtype=np.float32))
    points = np.stack([across.ravel(), np.zeros(360_000, np.float32), up.ravel()], axis=1)
    chosen = points[thin(points, read=4000)]  # every 90th beam would be 67 columns
    columns = np.unique(np.rint(chosen[:, 0] / 0.05))
    assert len(columns) == 61


def test_the_grid_moves_a_point_by_a_millimetre_at_most() -> None:
    points = np.random.default_rng(0).uniform(-50, 50, (1000, 3)).astype(np.float32)
    assert np.abs(on_grid(points) - points).max() <= 0.5 / 512 + 4e-6  # and float32's own step at 50 m


def test_points_that_no_photograph_sees_are_grey() -> None:
    colours = display_colours(np.array([[1, 2, 3], [4, 5, 6]], np.uint8), np.array([True, False]))
    assert colours.tolist() == [[1, 2, 3], [150, 150, 150]]


def test_better_scores_are_brighter_and_hopeless_ones_do_not_matter() -> None:
    colours = score_colours(np.array([0.0, 0.5, 1.0, -np.inf])).astype(int).sum(axis=1)
    assert colours[0] < colours[1] < colours[2]
    assert colours[3] == colours[0]


def test_labels_put_the_estimate_beside_the_joint() -> None:
    wall = walls()[1]
    found = door(angle=np.radians(34.8))
    assert angle_label(evaluation(wall, 2, found, name="d", angle=np.radians(35))) == "34.8 deg (joint 35.0)"
    assert angle_label(evaluation(wall, 2, found, name=None, angle=None)) == "34.8 deg (no such door)"


def test_where_a_door_slides_a_label_has_shares_instead_of_angles() -> None:
    # 0.405 m of a doorway of 0.9 m
    leaf = replace(door(angle=0.0).leaves[0], slid=-0.405)
    found = replace(door(angle=0.0), kind="sliding", state="semi-open", leaves=(leaf,))
    beside = evaluation(walls()[1], 2, found, name="d", angle=0.0)
    assert angle_label(replace(beside, true_opened_fraction=0.444)) == "45 % open (joint 44 %)"


@pytest.mark.parametrize(
    ("angle", "words"), [(JOINT, "31.0"), (None, "-"), (float("nan"), "-"), (-1e-9, "0.0"), (-0.01, "-0.6")]
)
def test_angles_are_written_in_degrees(angle: float | None, words: str) -> None:
    assert degrees_text(angle) == words


def test_a_jpeg_keeps_red_red() -> None:
    red = np.zeros((16, 16, 3), np.uint8)
    red[:, :, 0] = 250
    blue, _, decoded_red = cv2.imdecode(np.frombuffer(jpeg(red), np.uint8), cv2.IMREAD_COLOR)[8, 8]  # blue first
    assert decoded_red > 240
    assert blue < 10


def test_shrinking_keeps_the_shape_and_says_by_how_much() -> None:
    image, factor = shrink(np.zeros((300, 200, 3), np.uint8), width=100)
    assert (image.shape, factor) == ((150, 100, 3), 0.5)


def test_two_quadrilaterals_are_four_triangles() -> None:
    square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
    vertices, triangles = quads([square, square + [0, 0, 1]])
    areas = np.linalg.norm(
        np.cross(*(vertices[triangles[:, i]] - vertices[triangles[:, 0]] for i in (1, 2))), axis=1
    )  # twice each triangle's
    assert areas.tolist() == [1.0, 1.0, 1.0, 1.0]


@pytest.mark.parametrize("count", [1, 7])
def test_thinning_leaves_the_cloud_as_it_was(count: int) -> None:
    cloud = np.full((count, 3), 1.234, np.float32)
    assert thin(cloud).tolist() == [0]
    assert (cloud == np.float32(1.234)).all()


@pytest.mark.parametrize("width", [300, 80, 20])
def test_a_shrunken_picture_keeps_its_brightness(width: int) -> None:
    # Stripes of one pixel, black and white: skipping pixels would show one or the other.
    image = np.zeros((90, 400, 3), np.uint8)
    image[:, ::2] = 255
    assert shrink(image, width=width)[0].mean() == pytest.approx(127.5, abs=2)


def test_every_event_has_a_sentence_of_its_own() -> None:
    lines = [sentence(event) for event in story()]
    assert all(line and "\n" not in line for line in lines)
    assert "1.2-a 30.0 deg (joint 31.0); 1.3-a 0.0 deg (joint 0.0); missed lift" in lines
    assert "drove 2.00 m" in lines
    assert [level(event) for event in story()].count("WARN") == 1  # the remark


def test_a_leg_that_ends_early_is_a_warning_that_says_how_it_ended() -> None:
    (leg,) = [event for event in story() if isinstance(event, Drove)]
    assert level(leg) == "INFO"
    bumped = replace(leg, outcome="contact", reason="touched kerb")
    assert level(bumped) == "WARN"
    assert sentence(bumped).endswith("contact: touched kerb")


def test_nothing_hovers_where_there_is_no_row() -> None:
    assert hover(score=np.zeros(0), rejected=[]) == []
    assert len(hover(score=np.zeros(1), rejected=["far"])) == 1
