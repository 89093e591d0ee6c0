"""Rooms in a row, 4 x 4 m each, 0.2 m of wall between them: which are known, and how one gets from one to another."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np

from mission.exits import CentreLine, Exit
from mission.explored_building import CompletedRoom, Doorway, ExploredBuilding
from mission.linking import LinkParameters
from mission.structure import Structure
from tests.mission.building_parts import door, face, leaf, wall

PITCH = 4.2


def exit_of(room: int, side: int) -> Exit:
    """Of room 1, 2, ... to the east (1) or west (-1), in the middle of its wall; rooms begin at x = 0, 4.2, ..."""
    x = (room - 1) * PITCH + (4.0 if side > 0 else 0.0)
    where = wall(x, 4.0, -np.pi / 2) if side > 0 else wall(x, 0.0, np.pi / 2)
    one = face(room, where, door(1.55, 2.45, leaf(95)), wall_number=1 if side > 0 else 2)
    return Exit(one, CentreLine(np.array([x, 2.0]), np.array([float(side), 0.0])), 0.85)


def completed(number: int, *exits: Exit) -> CompletedRoom:
    x = (number - 1) * PITCH
    polygon = np.array([[x, 0], [x + 4, 0], [x + 4, 4], [x, 4]], float)
    explored: Any = SimpleNamespace(number=number, samples=[], registrar=None)
    structure = Structure(0.0, 2.6, (), polygon, np.full(4, -1))
    return CompletedRoom(explored, structure, tuple(way.face for way in exits), exits)


def row(*numbers: int) -> ExploredBuilding:
    """The robot came from room to room, and each is done."""
    building = ExploredBuilding(LinkParameters())
    building.enter(numbers[0], np.array([2.0, 2.0, 0.0]))
    for before, number in zip((None, *numbers), numbers, strict=False):
        if before is not None:
            line = exit_of(before, 1).line
            doorway = Doorway(f"{before}.1-a", {before: line, number: line.reversed()})
            building.pass_through(doorway, before, number, np.array([number * PITCH - 2.0, 2.0, 0.0]))
        building.complete(completed(number, exit_of(number, 1), exit_of(number, -1)))
    return building


def test_a_place_belongs_to_the_room_whose_floor_it_is_over() -> None:
    building = row(1, 2)
    assert building.room_at(np.array([2.0, 1.0, 1.0])) == 1
    assert building.room_at(np.array([6.0, 1.0, 1.0])) == 2
    assert building.room_at(np.array([4.1, 1.0, 1.0])) is None  # in the wall
    assert building.room_at(np.array([2.0, 1.0, 4.0])) is None  # a storey higher


def test_both_faces_of_a_passed_door_are_known_and_the_next_exit_is_the_nearest_that_is_not() -> None:
    building = row(1, 2)
    assert [link.doors for link in building.links if link.doors] == [("1.1-a", "2.2-a")]
    way = building.unexplored(2)
    assert way is not None and way.face.door_id == "2.1-a"
    building.give_up(way)
    way = building.unexplored(2)
    assert way is not None and way.face.door_id == "1.2-a"  # a door further away


def test_an_exit_into_a_room_that_is_done_is_none() -> None:
    building = row(1)
    building.enter(2, np.array([6.0, 2.0, 0.0]), deviation=0.03, turn_deviation=0.02)  # by an operator
    building.complete(completed(2, exit_of(2, 1)))
    open_ends = []
    while (way := building.unexplored(1)) is not None:
        open_ends.append(way.face.door_id)
        building.give_up(way)
    assert open_ends == ["1.2-a"]  # 1.1-a leads into room 2, which cannot be driven to from here


def test_the_way_from_room_to_room_passes_the_fewest_doors() -> None:
    building = row(1, 2, 3, 4)
    assert [doorway.door for doorway in building.route(4, 1)] == ["3.1-a", "2.1-a", "1.1-a"]
    assert building.route(2, 2) == []


def test_a_room_that_was_none_is_forgotten_with_its_links() -> None:
    building = row(1)
    line = exit_of(1, 1).line
    doorway = Doorway("1.1-a", {1: line, 2: line.reversed()})
    building.pass_through(doorway, 1, 2, np.array([6.0, 2.0, 0.0]))
    building.drop(2)
    assert (building.links, building.doorways, set(building.world_from_room)) == ([], [], {1})


def test_a_pair_of_doors_that_scans_contradict_is_none() -> None:
    building = row(1)
    line = exit_of(1, 1).line
    building.pass_through(Doorway("1.1-a", {1: line, 2: line.reversed()}), 1, 2, np.array([6.0, 2.0, 0.0]))
    there = exit_of(2, -1)
    astray = replace(there, face=replace(there.face, wall=wall(PITCH, 0.4, np.pi / 2)))  # 40 cm along the wall
    building.complete(completed(2, astray))
    assert [link for link in building.links if link.doors] == []
    np.testing.assert_allclose(building.world_from_room[2], np.eye(4), atol=1e-6)
