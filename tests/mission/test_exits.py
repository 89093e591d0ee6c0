"""Which doors one can drive through, and where in them."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from detector.result import Door
from mission.exits import CentreLine, ExitParameters, clear_span, find_exits
from tests.mission.building_parts import door, face, leaf, wall
from tests.mission.driving_world import FOOTPRINT

NOTHING = np.zeros((0, 3))
YAW = 0.4
"""Of the wall in the world: nothing may rest on the world's axes."""


def exits_of(one: Door, points: NDArray[np.float64] = NOTHING) -> tuple[list, list]:
    where = wall(3, -2, YAW)
    in_world = where.world_from_wall(points) if len(points) else points
    return find_exits(
        [face(1, where, one)],
        in_world,
        floor_height=0.0,
        footprint=FOOTPRINT,
        robot_height=1.6,
        parameters=ExitParameters(margin=0.07),
    )


@pytest.mark.parametrize(
    ("one", "span"),
    [
        (door(1.0, 1.9, leaf(90, "left")), (1.05, 1.9)),  # the leaf itself, 5 cm
        (door(1.0, 1.9, leaf(60, "left")), (1.45, 1.9)),  # cos 60 = 1/2
        (door(1.0, 1.9, leaf(60, "right")), (1.0, 1.45)),
        (door(1.0, 1.9, leaf(0, "left")), (1.9, 1.9)),
        (door(1.0, 1.9, leaf(np.nan, "none")), (1.0, 1.9)),  # a passage
        (door(1.0, 2.8, leaf(90, "left"), leaf(0, "right"), kind="double"), (1.05, 1.9)),
        (door(1.0, 2.8, leaf(0, "none"), leaf(0, "none"), kind="double"), (1.9, 1.9)),
        (door(1.0, 1.9, leaf(0, "none", slid=0.8), kind="sliding"), (1.0, 1.8)),
        (door(1.0, 1.9, leaf(0, "none", slid=-0.8), kind="sliding"), (1.1, 1.9)),
    ],
)
def test_a_doorway_is_clear_where_its_leaves_do_not_stand(one: Door, span: tuple[float, float]) -> None:
    assert clear_span(one) == pytest.approx(span)


def test_the_robot_drives_through_the_middle_of_what_is_clear() -> None:
    # Clear from 1.05 to 1.90: the middle is 1.475 along the wall, and the way out is against its normal.
    (way,), refused = exits_of(door(1.0, 1.9, leaf(90, "left")))
    assert refused == []
    where = wall(3, -2, YAW)
    np.testing.assert_allclose(way.line.middle, where.world_from_wall(np.array([[1.475, 0, 0]]))[0, :2], atol=0.006)
    np.testing.assert_allclose(way.line.out, -where.normal[:2])
    np.testing.assert_allclose(way.line.at(0.5), where.world_from_wall(np.array([[1.475, 0, -0.5]]))[0, :2], atol=0.006)


@pytest.mark.parametrize(("width", "passable"), [(0.77, True), (0.75, False)])
def test_a_gap_of_footprint_and_margin_is_an_exit_and_a_narrower_one_is_none(width: float, passable: bool) -> None:
    # 0.57 + 2 x 0.07 = 0.71 m, and the leaf takes 0.05.
    exits, refused = exits_of(door(1.0, 1.0 + width, leaf(90, "left")))
    assert (len(exits), len(refused)) == ((1, 0) if passable else (0, 1))


def test_what_stands_in_the_doorway_moves_the_way_aside_or_blocks_it() -> None:
    post = np.array([[1.3, height, -0.2] for height in np.linspace(0.2, 1.0, 20)])
    (way,), _ = exits_of(door(1.0, 2.4, leaf(90, "left")), post)  # left free: 1.3 to 2.4
    assert way.width == pytest.approx(1.1, abs=0.03)
    exits, ((_, reason),) = exits_of(door(1.0, 1.9, leaf(90, "left")), post)
    assert exits == [] and reason.startswith("something leaves 0.5")  # 1.3 to 1.9, less a step


def test_a_lintel_and_the_floor_are_in_nobody_s_way() -> None:
    bands = np.array([[1.5, height, 0.0] for height in (0.0, 0.01, 0.02, 1.7, 1.8, 2.0)])
    assert len(exits_of(door(1.0, 1.9, leaf(90, "left")), bands)[0]) == 1


def test_lines_through_one_doorway_are_alike_and_those_of_two_doors_in_a_corner_are_not() -> None:
    line = CentreLine(np.array([2.0, 0.0]), np.array([0.0, -1.0]))
    from_behind = CentreLine(np.array([2.1, -0.3]), np.array([0.02, 1.0]))  # a wall further, a little off
    in_the_corner = CentreLine(np.array([2.45, 0.45]), np.array([1.0, 0.0]))
    beside = CentreLine(np.array([2.9, 0.0]), np.array([0.0, -1.0]))
    assert line.is_like(from_behind) and line.is_like(line.reversed())
    assert not line.is_like(in_the_corner) and not line.is_like(beside)
