"""The same door from both sides, and where that puts the rooms."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from detector.result import Rectangle
from mission.linking import LinkParameters, door_link, same_doors
from mission.pose_graph import Anchor, Link, solve, turn_of
from mission.rigid import Pose, transformed
from tests.mission.building_parts import both_sides, face, wall
from tests.mission.driving_world import pose

PARAMETERS = LinkParameters()
TOLD = Anchor(np.array([2.0, 3.0, 0.0]), deviation=0.03, turn_deviation=0.02)
START = Anchor(np.zeros(3), deviation=0.0, turn_deviation=0.0)


def frames(second: Pose | None = None) -> dict[int, Pose]:
    return {1: np.eye(4), 2: np.eye(4) if second is None else second}


def test_two_faces_that_look_away_from_each_other_a_wall_apart_are_one_door() -> None:
    here, there = both_sides()
    assert same_doors([here], [there], frames(), PARAMETERS) == [(here, there)]


@pytest.mark.parametrize("offset", [0.3, -0.3])
def test_a_face_is_known_again_though_the_room_was_set_down_beside_its_place(offset: float) -> None:
    here, there = both_sides()
    assert same_doors([here], [there], frames(pose(offset, 0.05, 0.03)), PARAMETERS) == [(here, there)]


def test_doors_of_different_size_side_or_wall_are_different_doors() -> None:
    here, there = both_sides()
    narrow = replace(there, door=replace(there.door, rectangle=Rectangle(1.7, 0.0, 2.3, 2.0)))
    beside = replace(there, wall=wall(5.0, 0.2, np.pi))  # 1 m along
    far = replace(there, wall=wall(4, 1.5, np.pi))  # 1.5 m behind
    same_side = face(2, wall(0, 0.2), here.door)
    for other in (narrow, beside, far, same_side):
        assert same_doors([here], [other], frames(), PARAMETERS) == []


def test_of_two_doors_side_by_side_each_is_given_to_its_own_other_side() -> None:
    here, there = both_sides(width=0.7)
    moved = replace(here, door_id="1.1-b", door=replace(here.door, rectangle=Rectangle(2.05, 0.0, 2.75, 2.0)))
    moved_there = replace(there, door_id="2.1-b", door=replace(there.door, rectangle=Rectangle(1.25, 0.0, 1.95, 2.0)))
    pairs = same_doors([here, moved], [moved_there, there], frames(), PARAMETERS)
    assert {(a.door_id, b.door_id) for a, b in pairs} == {("1.1-a", "2.1-a"), ("1.1-b", "2.1-b")}


@pytest.mark.parametrize("error", [pose(0.05, -0.03, 0.03), pose(-0.04, 0.02, -0.02)])
def test_a_closed_door_puts_the_room_behind_it_into_place(error: Pose) -> None:
    # The wall is 0.10 + 0.04 + 0.06 = 0.20 m thick: recess, leaf, recess. Room 2 believes to be elsewhere.
    here, there = both_sides()
    u, _, origin = transformed(np.array([there.wall.u, [0, 0, 0], there.wall.origin]), error)
    u = u - transformed(np.zeros((1, 3)), error)[0]
    astray = replace(there, wall=replace(there.wall, u=u, origin=origin))
    found = solve({1: START, 2: TOLD}, [door_link(here, astray, PARAMETERS)])
    np.testing.assert_allclose(found[2] @ error, np.eye(4), atol=0.001)  # the operator's word has a little weight


def test_an_open_door_says_little_about_the_thickness_of_its_wall() -> None:
    here, there = both_sides(recesses=(np.nan, np.nan), thickness=0.3)
    link = door_link(here, there, PARAMETERS)
    assert link.deviations[1] == PARAMETERS.thickness_deviation
    found = solve({1: START, 2: TOLD}, [link])
    assert abs(found[2][0, 3]) < 0.001 and abs(turn_of(found[2])) < 1e-4  # along the wall it is as sharp as any
    # The operator's word holds it with 3 cm, the usual wall, 15 cm thinner, with 5: 0.15 x 3^2 / (3^2 + 5^2).
    assert found[2][1, 3] == pytest.approx(-0.0397, abs=2e-4)


def test_a_face_that_was_found_with_its_frame_says_little_about_thickness_and_middle() -> None:
    # 8 cm wider and 4 cm higher; 3 cm are within what two sides of a door differ by
    here, there = both_sides()
    r = there.door.rectangle
    framed = replace(
        there, door=replace(there.door, rectangle=Rectangle(r.left - 0.04, 0.0, r.right + 0.04, r.top + 0.04))
    )
    link, plain = door_link(here, framed, PARAMETERS), door_link(here, there, PARAMETERS)
    assert link.deviations[1] == PARAMETERS.thickness_deviation
    np.testing.assert_allclose(link.deviations[[0, 2]] - plain.deviations[[0, 2]], [0.025, 0.01], atol=1e-12)


def test_what_is_known_better_moves_less() -> None:
    # Two links measure one room 0 and 10 mm along x, with 1 and 3 mm of deviation: weights 9 to 1, 1 mm.
    links = [
        Link(1, 2, np.array([x, 0, 0]), np.zeros(3), 0.0, np.eye(3), np.full(3, d), 0.001)
        for x, d in ((0.0, 0.001), (0.010, 0.003))
    ]
    found = solve({1: START, 2: Anchor(np.zeros(3), 10.0, 1.0)}, links)
    assert found[2][0, 3] == pytest.approx(0.001, abs=1e-6)


def test_rooms_in_a_chain_follow_each_other() -> None:
    along = Link(1, 2, np.array([5.0, 0, 0]), np.zeros(3), 0.1, np.eye(3), np.full(3, 0.002), 0.0003)
    found = solve({1: START, 2: Anchor(np.zeros(3), 50.0, 5.0), 3: Anchor(np.zeros(3), 50.0, 5.0)}, [
        along, replace(along, first=2, second=3)
    ])  # fmt: skip
    np.testing.assert_allclose(found[3], pose(5, 0, 0.1) @ pose(5, 0, 0.1), atol=1e-4)
