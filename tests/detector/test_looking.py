"""How walls are looked at: a view is large, and there is one in memory at a time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from weakref import ReferenceType, ref

from detector.looking import look_at_walls
from detector.parameters import DetectorParameters
from detector.room import View
from tests.detector.synthetic import Layout, make_room


class Counted(Sequence[View]):
    """Views that are made when they are read, and how many of those made before were still alive then."""

    def __init__(self, views: Sequence[View]) -> None:
        self._views = views
        self._made: list[ReferenceType[View]] = []
        self.read: list[int] = []
        self.alive: list[int] = []

    def __len__(self) -> int:
        return len(self._views)

    def __getitem__(self, number):
        self.read.append(number)
        self.alive.append(sum(made() is not None for made in self._made))
        view = replace(self._views[number])
        self._made.append(ref(view))
        return view


def test_views_are_read_once_for_all_walls_and_each_is_gone_before_the_next_is_made() -> None:
    room = make_room(Layout(), step_deg=1.0)
    views = Counted(room.views)
    looks = look_at_walls(replace(room, views=views, walls=room.walls * 3), DetectorParameters())

    assert len(looks) == 3
    assert views.read == list(range(len(room.views))) and len(room.views) > 1
    assert views.alive == [0] * len(room.views)
