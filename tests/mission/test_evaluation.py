"""Doors against joints, on walls that one can do in one's head."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from detector.result import Door, Leaf, Rectangle
from detector.room import Wall
from mission.evaluation import evaluate

EMPTY = np.zeros((0, 2), np.float32)
OUTLINE = np.array([[14.0, -7.0], [10.0, -7.0], [10.0, -11.0], [14.0, -11.0]])
"""A room of 4 x 4 m whose first edge is the wall at yaw 0."""


def wall(yaw: float = 0.0) -> Wall:
    """A wall 4 m wide and 2.5 m high; at yaw 0 it runs along x and its normal u x v is -y."""
    u = np.array([np.cos(yaw), np.sin(yaw), 0.0])
    labels = np.ones((13, 20), np.uint8)
    return Wall(np.array([10.0, -7.0, 0.0]), u, np.array([0.0, 0.0, 1.0]), 4.0, 2.5, labels)


def leaf(angle_deg: float = 0.0, hinge: Any = "left", opens: Any = None) -> Leaf:
    return Leaf(hinge, np.radians(angle_deg), 0.001, opens, EMPTY)


def door(left: float, right: float, *leaves: Leaf) -> Door:
    return Door(Rectangle(left, 0.0, right, 2.0), "single", "closed", leaves or (leaf(),))


def truth(name: str, where: Wall, left: float, right: float, *, angle_deg: float = 0.0, depth: float = 0.0) -> Any:
    """A true door seen from the wall's other side, as the simulator may well have it."""
    corners = where.world_from_wall(
        np.array([[right, 0.0, depth], [left, 0.0, depth], [left, 2.0, depth], [right, 2.0, depth]])
    )
    one = SimpleNamespace(opening_angle=np.radians(angle_deg), corners_in_world=corners)
    covered = np.nan * corners  # as it shows from the side that its normal points to, the wall's other one
    return SimpleNamespace(
        name=name,
        kind="hinged",
        corners_in_world=corners,
        outlines_in_world=(covered, corners),
        normal=-where.normal,
        leaves=(one,),
    )


def result(where: Wall, *doors: Door) -> Any:
    return SimpleNamespace(wall=where, doors=doors)


@pytest.mark.parametrize("yaw", [0.0, 0.5])
def test_a_door_off_by_a_tenth_of_its_width_has_precision_and_recall_of_nine_tenths(yaw: float) -> None:
    # Q = 1.1..2.1, G = 1.0..2.0, both 2 m high: t_p = 0.9 x 2, f_p = f_n = 0.1 x 2.
    where = wall(yaw)
    (found,), missed = evaluate(
        [result(where, door(1.1, 2.1))], [truth("oak", where, 1.0, 2.0)], room=1, outline=OUTLINE
    )
    assert (found.true_name, missed) == ("oak", ())
    assert found.overlap is not None
    assert found.overlap.precision == pytest.approx(0.9)
    assert found.overlap.recall == pytest.approx(0.9)
    assert found.overlap.absolute_error == pytest.approx(0.4)


def test_a_detection_where_no_door_is_has_no_truth() -> None:
    where = wall()
    (found,), missed = evaluate(
        [result(where, door(0.0, 0.9))], [truth("oak", where, 2.0, 3.0)], room=1, outline=OUTLINE
    )
    assert found.true_name is None
    assert found.angle_error is None
    assert missed == ("oak",)


def test_two_detections_of_one_door_are_one_hit_and_one_false_positive() -> None:
    where = wall()
    found, _ = evaluate(
        [result(where, door(1.0, 1.6), door(1.0, 1.95))], [truth("oak", where, 1.0, 2.0)], room=1, outline=OUTLINE
    )
    assert [one.true_name for one in found] == [None, "oak"]


def test_a_door_in_another_wall_is_not_of_this_room() -> None:
    where = wall()
    behind = truth("far", where, 1.0, 2.0, depth=-3.0)
    across = truth("across", wall(np.pi / 2), 1.0, 2.0)
    found, missed = evaluate([result(where)], [behind, across], room=1, outline=OUTLINE)
    assert (found, missed) == ((), ())


def test_a_door_in_a_wall_that_the_mission_lost_is_missed() -> None:
    where = wall()
    _, missed = evaluate([], [truth("oak", where, 1.0, 2.0)], room=1, outline=OUTLINE)
    assert missed == ("oak",)


def test_a_door_of_the_next_room_close_to_the_common_wall_is_not_missed() -> None:
    beyond = truth("next", wall(np.pi / 2), 0.2, 1.1)  # its wall begins at our corner and leads away
    _, missed = evaluate([result(wall())], [beyond], room=1, outline=OUTLINE)
    assert missed == ()


def test_a_recessed_door_is_still_the_walls() -> None:
    where = wall()
    (found,), _ = evaluate(
        [result(where, door(1.0, 2.0))], [truth("deep", where, 1.0, 2.0, depth=-0.2)], room=1, outline=OUTLINE
    )
    assert found.true_name == "deep"


def test_the_angle_error_is_estimate_less_joint() -> None:
    where = wall()
    open_door = door(1.0, 2.0, leaf(34.8, opens="inward"))
    (found,), _ = evaluate(
        [result(where, open_door)], [truth("oak", where, 1.0, 2.0, angle_deg=35.0)], room=1, outline=OUTLINE
    )
    assert found.angle_error is not None
    assert np.degrees(found.angle_error) == pytest.approx(-0.2)


@pytest.mark.parametrize(
    ("hinge", "opens", "free_edge"),
    # Doorway from u = 1 to u = 2, leaf at 90 deg: it stands on the hinge's side, 1 m into the room or out of it.
    [
        ("left", "inward", (1.0, 1.0)),
        ("left", "outward", (1.0, -1.0)),
        ("right", "inward", (2.0, 1.0)),
        ("right", "outward", (2.0, -1.0)),
    ],
)
def test_an_open_leaf_is_drawn_on_its_hinge_and_to_its_side(
    hinge: str, opens: str, free_edge: tuple[float, float]
) -> None:
    where = wall(0.5)
    (found,), _ = evaluate([result(where, door(1.0, 2.0, leaf(90.0, hinge, opens)))], [], room=1, outline=OUTLINE)
    corners = where.wall_from_world(found.leaf_corners_in_world[0])
    assert corners[0] == pytest.approx([free_edge[0], 0.0, 0.0], abs=1e-9)
    assert corners[1] == pytest.approx([free_edge[0], 0.0, free_edge[1]], abs=1e-9)
    assert corners[2] == pytest.approx([free_edge[0], 2.0, free_edge[1]], abs=1e-9)


def test_the_leaves_of_a_double_door_share_its_width() -> None:
    where = wall()
    double = Door(Rectangle(1.0, 0.0, 3.0, 2.0), "double", "closed", (leaf(hinge="left"), leaf(hinge="right")))
    (found,), _ = evaluate([result(where, double)], [], room=1, outline=OUTLINE)
    left, right = (where.wall_from_world(corners)[:2, 0] for corners in found.leaf_corners_in_world)
    assert left == pytest.approx([1.0, 2.0])
    assert right == pytest.approx([3.0, 2.0])
    assert found.hinge == "both"


def test_a_double_door_with_one_closed_leaf_is_hinged_where_the_other_is() -> None:
    double = Door(Rectangle(1.0, 0.0, 3.0, 2.0), "double", "semi-open", (leaf(30.0), leaf(hinge="none")))
    (found,), _ = evaluate([result(wall(), double)], [], room=1, outline=OUTLINE)
    assert found.hinge == "left"


def test_the_27th_door_of_a_wall_has_two_letters() -> None:
    many = [door(0.1 * i, 0.1 * i + 0.09) for i in range(28)]
    found, _ = evaluate([result(wall(), *many)], [], room=1, outline=OUTLINE)
    assert [one.door_id for one in found[25:]] == ["1.1-z", "1.1-aa", "1.1-ab"]


def test_doors_are_named_by_room_wall_and_letter() -> None:
    where = wall()
    results = [result(where), result(where, door(0.0, 0.9), door(2.0, 2.9))]
    found, _ = evaluate(results, [], room=3, outline=OUTLINE)
    assert [one.door_id for one in found] == ["3.2-a", "3.2-b"]


def test_a_sliding_door_is_compared_by_the_share_of_its_doorway() -> None:
    # a leaf of 1 m is 0.35 m out of its closed place, and was measured to be 0.4 m to the left of it
    where = wall()
    joint = truth("rail", where, 1.0, 2.0)
    joint.kind, joint.leaves[0].opening_angle, joint.leaves[0].opening = "sliding", np.nan, 0.35
    slid = Door(Rectangle(1.0, 0.0, 2.0, 2.0), "sliding", "semi-open", (replace(leaf(hinge="none"), slid=-0.4),))
    (found,), _ = evaluate([result(where, slid)], [joint], room=1, outline=OUTLINE)
    assert (found.door.opened_fraction, found.true_opened_fraction) == pytest.approx((0.4, 0.35))
    assert found.angle_error == 0.0
    along = where.wall_from_world(found.leaf_corners_in_world[0])[:, 0]
    assert along.tolist() == pytest.approx([0.6, 1.6, 1.6, 0.6])


def test_a_hinged_door_has_no_opened_fraction() -> None:
    where = wall()
    (found,), _ = evaluate([result(where, door(1.0, 2.0))], [truth("oak", where, 1.0, 2.0)], room=1, outline=OUTLINE)
    assert np.isnan(found.door.opened_fraction) and found.true_opened_fraction is None
