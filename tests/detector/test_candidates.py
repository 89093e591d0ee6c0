"""What is measured on rectangles of door size, on a wall of 3 x 2.6 m at 1 cm."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from detector.candidates import Boxes, Scene, corner_support, interrupts, overshoot, side_support
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
    edges = Edges(upright | level, nothing, upright, level, nothing, upright, level, level)
    seen = np.full(SHAPE, Visibility.DATA, np.uint8)
    everything = np.ones(SHAPE, bool)
    return Scene(image, seen, edges, everything, everything, everything, ~everything, 260, 259, 0.06)


LEFT, RIGHT, TOP = np.s_[60:, 100], np.s_[60:, 190], np.s_[60, 100:191]


def test_a_top_that_ends_before_the_sides_is_that_of_a_pane() -> None:
    pane = Boxes(DOOR.left, DOOR.right, np.array([80.0]))
    lines = (LEFT, RIGHT, TOP, np.s_[80, 110:181])  # the pane is 10 cm from the sides

    support, _ = side_support(pane, scene(lines))
    np.testing.assert_allclose(support[0], [1, 71 / 91, 1, 1])
    np.testing.assert_allclose(corner_support(pane, scene(lines)), [[0, 0]])

    np.testing.assert_allclose(corner_support(DOOR, scene(lines)), [[1, 1]])


def test_half_the_change_will_do_at_the_end_of_a_top_that_is_whole_next_to_it() -> None:
    fading = scene((LEFT, RIGHT, np.s_[60, 108:183]))  # 8 cm short of either side
    half = fading.edges.level.copy()
    half[60, 100:191] = True
    np.testing.assert_allclose(corner_support(DOOR, fading), [[0, 0]])
    np.testing.assert_allclose(corner_support(DOOR, _with_ends(fading, half)), [[1, 1]])

    # a hinge in line with the top of a window that ends 20 cm before it
    window = scene((LEFT, RIGHT, np.s_[60, 100:171]))
    np.testing.assert_allclose(corner_support(DOOR, _with_ends(window, half)), [[1, 0]])


def _with_ends(known: Scene, level_ends: NDArray[np.bool_]) -> Scene:
    return replace(known, edges=replace(known.edges, level_ends=level_ends))


def test_the_head_of_a_door_ends_at_its_corners_and_a_joint_of_tiles_goes_on() -> None:
    np.testing.assert_allclose(overshoot(DOOR, scene((LEFT, RIGHT, TOP))), [0.0])
    np.testing.assert_allclose(overshoot(DOOR, scene((LEFT, RIGHT, np.s_[60, :]))), [1.0])


def joints(*rows: int, left: bool = True, right: bool = True, across: bool = False) -> tuple[tuple[int, slice], ...]:
    """Level lines beside the door, or from one end of the wall to the other."""
    if across:
        return tuple(np.s_[row, :] for row in rows)
    return tuple(
        [np.s_[row, :100] for row in rows if left] + [np.s_[row, 191:] for row in rows if right],
    )


def test_a_door_interrupts_the_joints_of_tiles_and_tiles_do_not() -> None:
    head = np.s_[60, :]  # in line with a joint
    assert interrupts(DOOR, scene((LEFT, RIGHT, head, *joints(100, 140, 180))))
    assert not interrupts(DOOR, scene((LEFT, RIGHT, head, *joints(100, 140, 180, across=True))))
    # a handle lies in line with one of four joints
    assert interrupts(DOOR, scene((LEFT, RIGHT, head, *joints(90, 120, 150, 180), np.s_[150, 105:130])))
    # the lower two of three tiles go on: a board hangs on the upper one
    assert not interrupts(DOOR, scene((LEFT, RIGHT, head, *joints(100), *joints(140, 180, across=True))))


def test_lines_on_one_side_and_lines_that_do_not_meet_again_are_no_pattern() -> None:
    left_only = joints(100, 140, 180, right=False)
    assert not interrupts(DOOR, scene((LEFT, RIGHT, *left_only)))
    # the joints of planks are staggered
    assert not interrupts(DOOR, scene((LEFT, RIGHT, *left_only, *joints(120, 160, 200, left=False))))
    # a rail and a skirting 10 cm high, whose top is in row 250
    assert not interrupts(DOOR, scene((LEFT, RIGHT, *joints(150, 250))))


def test_joints_that_furniture_hides_within_a_rectangle_are_not_seen_to_end() -> None:
    tiles = scene((LEFT, RIGHT, *joints(100, 140, 180)))
    visible = np.ones(SHAPE, bool)
    visible[90:, 105:186] = False

    assert not interrupts(DOOR, replace(tiles, visible=visible))


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
