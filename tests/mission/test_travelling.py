"""From room to room, with a robot that arrives or does not as the test says: no physics, no sensors."""

from __future__ import annotations

from collections.abc import Generator
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from mission.explored_building import CompletedRoom, ExploredBuilding
from mission.linking import LinkParameters
from mission.navigation import NavigationParameters
from mission.structure import Structure
from mission.surveyor import MAX_DETOURS
from mission.travelling import Traveller
from tests.mission.driving_world import FOOTPRINT, free_room, pose
from tests.mission.test_explored_building import PITCH, exit_of

GRID = free_room(2 * PITCH - 0.2, 4.0, (4.0, 4.2, -1.0, 1.5), (4.0, 4.2, 2.5, 5.0))
"""Two rooms of 4 x 4 m with a gap of 1 m in the middle of the wall between."""


class Robot:
    """Stands in room 1, and arrives as often as it is told."""

    def __init__(self, *arrivals: bool, tied: bool = True) -> None:
        self.world_from_base = pose(1.0, 1.0)
        self.legs: list[Any] = []
        self.room = 1
        self._arrivals, self._tied = list(arrivals), tied

    def believe(self, world_from_base: Any) -> None:
        self.world_from_base = world_from_base

    def drive(self, _: Any, path: Any, __: float) -> Generator[Any, None, bool]:
        self.legs.append(path)
        arrived = self._arrivals.pop(0) if self._arrivals else True
        if arrived:
            self.world_from_base = pose(*path[-1])
        yield "drove"
        return arrived

    def scan_threshold(self, *_: Any) -> Generator[Any, None, bool]:
        yield "scanned"
        return self._tied

    def remark(self, text: str) -> str:
        return text


def room(number: int, *, grid: Any = GRID) -> Any:
    return SimpleNamespace(number=number, samples=[], registrar=None, grid=lambda floor: grid)


def house(robot: Any, *, grid: Any = GRID) -> tuple[ExploredBuilding, Traveller]:
    """Room 1 is done."""
    building = ExploredBuilding(LinkParameters())
    building.enter(1, np.zeros(3))
    polygon = np.array([[0, 0], [4, 0], [4, 4], [0, 4]], float)
    way = exit_of(1, 1)
    structure = Structure(0.0, 2.6, (), polygon, np.full(4, -1))
    building.complete(CompletedRoom(room(1, grid=grid), structure, (way.face,), (way,)))
    return building, Traveller(robot, building, robot, FOOTPRINT, NavigationParameters())


def told(journey: Generator[Any, None, Any]) -> tuple[list[Any], Any]:
    """What happens on the way, and what comes of it."""
    events = []
    while True:
        try:
            events.append(next(journey))
        except StopIteration as end:
            return events, end.value


def test_a_doorway_is_passed_straight_with_a_scan_in_it() -> None:
    robot = Robot()
    building, traveller = house(robot)
    events, came = told(traveller.go_through(1, exit_of(1, 1), room(2)))
    assert (events, came) == (["drove", "drove", "scanned", "drove"], (2, True))
    before, threshold, landing = (leg[-1] for leg in robot.legs)
    assert before[1] == pytest.approx(2.0) and 4 - 2.5 < before[0] < 4 - 0.59
    np.testing.assert_allclose(threshold, [4.1, 2.0])
    assert landing[1] == pytest.approx(2.0) and 4 + 0.59 < landing[0] < 4 + 2.5
    assert robot.room == 2 and building.route(2, 1)[0].door == "1.1-a"


def test_a_blocked_way_to_the_door_is_tried_again_and_given_up_where_the_robot_stands() -> None:
    robot = Robot(*[False] * MAX_DETOURS)
    _, traveller = house(robot)
    events, came = told(traveller.go_through(1, exit_of(1, 1), room(2)))
    assert came == (1, False) and events[-1] == "door 1.1-a is out of reach"
    assert len(robot.legs) == MAX_DETOURS  # and no blind way back
    robot = Robot(False, True)
    assert told(house(robot)[1].go_through(1, exit_of(1, 1), room(2)))[1] == (2, True)


@pytest.mark.parametrize(
    ("robot", "grid", "said"),
    [
        (Robot(True, False), GRID, "an obstacle in door 1.1-a"),
        (Robot(tied=False), GRID, "no place to turn is in sight behind door 1.1-a"),
        (Robot(), free_room(4.6, 4.0), "no place to turn is in sight behind door 1.1-a"),  # a closet
    ],
)
def test_what_cannot_be_entered_is_left_by_the_way_that_led_there(robot: Robot, grid: Any, said: str) -> None:
    building, traveller = house(robot)
    events, came = told(traveller.go_through(1, exit_of(1, 1), room(2, grid=grid)))
    assert came == (1, False) and said in events
    np.testing.assert_allclose(robot.legs[-1][-1], robot.legs[0][-1])  # where it turned towards the door
    assert building.doorways == [] and robot.room == 1


def test_a_robot_that_cannot_come_back_says_so() -> None:
    robot = Robot(True, True, True, False)
    _, traveller = house(robot)
    told(traveller.go_through(1, exit_of(1, 1), room(2)))
    assert told(traveller.come_back(exit_of(1, 1)))[1] is None
    assert told(traveller.come_back(exit_of(1, 1)))[1] == 1
