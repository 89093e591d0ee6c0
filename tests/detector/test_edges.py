"""Where a view shows the wall's face, 2 x 1 m of wall in samples of 30 mm; and where a colour changes."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest

from detector.edges import find_edges, wall_face
from detector.openings import Visibility
from detector.parameters import DetectorParameters
from detector.result import Orthoimage
from tests.detector.conftest import plain_image

PARAMETERS = DetectorParameters()


def noisy(std: float, slope_deg: float = 0.0) -> Orthoimage:
    """A wall whose right half is a leaf of some slope, with noise [m]."""
    image = plain_image((198, 402), pixel_size=0.005)
    samples = np.random.default_rng(0).normal(0, std, (33, 67))
    noise = cv2.resize(samples, (402, 198), interpolation=cv2.INTER_LINEAR)
    leaf = np.maximum(np.arange(402) - 200, 0) * 0.005 * np.tan(np.deg2rad(slope_deg))
    return replace(image, depth=(noise + leaf).astype(np.float32))


@pytest.mark.parametrize("std", [0.001, 0.003, 0.006])
def test_a_plain_wall_is_face_however_dark_it_is(std: float) -> None:
    assert wall_face(noisy(std), PARAMETERS).mean() > 0.97


@pytest.mark.parametrize("std", [0.001, 0.003, 0.006])
def test_a_leaf_that_stands_open_is_no_face(std: float) -> None:
    # at 25 deg the leaf is 4.5 cm off the wall's plane after 10 cm, that is after 20 of its columns
    face = wall_face(noisy(std, 25.0), PARAMETERS)
    assert face[:, :190].mean() > 0.97 and face[:, 222:].mean() < 0.03


def test_the_head_of_a_door_of_boards_among_boards_is_a_faint_edge() -> None:
    # boards of 10 cm differ by 5 % and have a grain of 2 %; the head of the door is a step of 1.5 %
    random = np.random.default_rng(0)
    grain = np.kron(0.05 * random.standard_normal(30), np.ones(10)) + 0.02 * random.standard_normal(300)
    image = plain_image((200, 300))
    grey = 0.5 + grain + np.where(np.arange(200)[:, None] < 100, 0.0, 0.015)
    image.colour[:] = np.rint(255 * grey)[..., None]

    edges = find_edges(image, np.full((200, 300), Visibility.DATA, np.uint8), DetectorParameters(pixel_size=0.01))

    assert edges.faint_level[99:101, 20:-20].any(axis=0).mean() > 0.95
    assert edges.faint_level[:95].mean() < 0.01  # and no edge where the boards go on


def test_smoothing_shortens_a_faint_edge_but_not_its_ends() -> None:
    # a step of 2 grey values in two channels changes by 1 a row in each: sqrt(2) / 255 = 0.0055; 0.004 is the least
    image = plain_image((200, 300))
    image.colour[100:, 100:200, :2] += 2
    image.colour[20:60, 20:60] = 0  # a poster: no threshold of Otsu's is below the least

    edges = find_edges(image, np.full((200, 300), Visibility.DATA, np.uint8), DetectorParameters(pixel_size=0.01))

    # smoothed over 17 pixels, 13 of them must lie on the step, whose first column has 9; for half the change, 7 must
    assert np.flatnonzero(edges.faint_level[100])[[0, -1]].tolist() == [104, 195]
    assert np.flatnonzero(edges.level_ends[100])[[0, -1]].tolist() == [98, 201]
