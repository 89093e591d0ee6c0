"""What is measured on rectangles of door size, on a wall of 3 x 2.6 m at 1 cm."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from detector.candidates import Boxes, Scene, overshoot, side_support
from detector.doors import fainter_doors
from detector.edges import Edges
from detector.openings import Visibility
from detector.result import Candidate, Rectangle
from detector.steps import boarded
from tests.detector.conftest import plain_image

SHAPE = (260, 300)
DOOR = Boxes(np.array([100.0]), np.array([190.0]), np.array([60.0]))
"""0.9 x 2 m."""


def scene(lines: tuple[tuple[slice, slice], ...] = (), colour: NDArray | None = None) -> Scene:
    """A wall with upright and level lines, wide ones being level."""
    image = plain_image(SHAPE)
    if colour is not None:
        image.colour[:] = np.rint(255 * colour)[..., None]
    upright, level, nothing = (np.zeros(SHAPE, bool) for _ in range(3))
    for line in lines:
        (level if isinstance(line[0], int) else upright)[line] = True
    edges = Edges(upright | level, nothing, upright, level, nothing, upright, level)
    seen = np.full(SHAPE, Visibility.DATA, np.uint8)
    everything = np.ones(SHAPE, bool)
    return Scene(image, seen, edges, everything, everything, everything, ~everything, 260, 259, 0.06)


LEFT, RIGHT, TOP = np.s_[60:, 100], np.s_[60:, 190], np.s_[60, 100:191]


def test_a_top_that_ends_before_the_sides_is_that_of_a_pane() -> None:
    pane = Boxes(DOOR.left, DOOR.right, np.array([80.0]))
    lines = (LEFT, RIGHT, TOP, np.s_[80, 110:181])  # the pane is 10 cm from the sides

    support, _, corners = side_support(pane, scene(lines))
    np.testing.assert_allclose(support[0], [1, 71 / 91, 1, 1])
    np.testing.assert_allclose(corners, [[0, 0]])

    np.testing.assert_allclose(side_support(DOOR, scene(lines))[2], [[1, 1]])


def test_the_head_of_a_door_ends_at_its_corners_and_a_joint_of_tiles_goes_on() -> None:
    np.testing.assert_allclose(overshoot(DOOR, scene((LEFT, RIGHT, TOP))), [0.0])
    np.testing.assert_allclose(overshoot(DOOR, scene((LEFT, RIGHT, np.s_[60, :]))), [1.0])


def test_a_head_that_has_an_end_behind_furniture_is_not_seen_to_end() -> None:
    head = scene((LEFT, RIGHT, TOP))
    beside_right = np.ones(SHAPE, bool)
    beside_right[:, 191:] = False

    np.testing.assert_allclose(overshoot(DOOR, replace(head, visible=beside_right)), [1.0])


def test_boards_differ_from_one_to_the_next_and_tiles_in_both_directions() -> None:
    random = np.random.default_rng(0)
    greys = 0.5 + 0.1 * random.standard_normal((26, 30))
    tiles = np.kron(greys, np.ones((10, 10)))
    boards = np.kron(greys[:1], np.ones((260, 10)))

    assert boarded(DOOR, scene(colour=boards))
    assert not boarded(DOOR, scene(colour=tiles))
    assert not boarded(DOOR, scene())


def candidate(left: float, right: float, top: float) -> Candidate:
    return Candidate(Rectangle(left, 0, right, top), 1.0, 1.0, (1.0, 1.0, 1.0, 1.0), 0.0, None, 1.0)


def test_within_the_clear_outline_of_a_frame_the_faint_one_of_its_leaf_is_looked_for() -> None:
    frame, leaf, grain = candidate(1.0, 2.0, 2.1), candidate(1.07, 1.92, 2.03), candidate(1.07, 1.7, 2.03)
    elsewhere = candidate(3.0, 3.9, 2.0)
    # the leaf's frame is 7, 8 and 7 cm wide; what the grain cuts out of it has one of 7, 30 and 7 cm
    assert fainter_doors((leaf, grain, elsewhere), (frame,)) == (leaf, elsewhere)
