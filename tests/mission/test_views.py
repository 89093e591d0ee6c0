"""Views that are kept as ranges: made again, they are what they were."""

from __future__ import annotations

from weakref import ref

import numpy as np
import pytest

from mission.colouring import colour_scan
from mission.views import ColouredScan, Views
from tests.mission.boxroom import box, pose, scan

HANGING = box((4, 4.2), (-4, 4), (1, 2))
"""Most beams go by it and return nothing."""


def test_a_view_that_is_made_again_has_every_bit_of_the_one_that_was_coloured() -> None:
    taken, place = scan([HANGING], pose(0, 0, 0.2)), pose(1, -2, 0.7)
    view = colour_scan(taken, [], place)
    again = ColouredScan.of(taken, view, place).view()

    assert 0 < len(view.points_in_world) < taken.ranges.size
    for name in ("points_in_world", "colours", "coloured", "scanner_in_world", "camera_in_world"):
        assert np.array_equal(getattr(again, name), getattr(view, name))


def test_views_are_read_like_a_list_and_each_is_made_anew() -> None:
    taken = scan([HANGING], pose(0, 0))
    places = [pose(x, 0) for x in range(3)]
    views = Views([ColouredScan.of(taken, colour_scan(taken, [], place), place) for place in places])

    assert len(views) == 3 and [round(view.scanner_in_world[0]) for view in views] == [0, 1, 2]
    assert [round(view.scanner_in_world[0]) for view in views[1:]] == [1, 2]
    assert views[0] is not views[0]


def test_views_to_be_read_once_let_their_scans_go() -> None:
    taken = scan([HANGING], pose(0, 0))
    coloured = ColouredScan.of(taken, colour_scan(taken, [], pose(0, 0)), pose(0, 0))
    kept = ref(coloured)
    views = Views([coloured], once=True)
    del coloured

    assert kept() is not None and len(views[0].points_in_world) > 0
    assert kept() is None and len(views) == 1
    with pytest.raises(LookupError, match="view 0 was read before"):
        views[0]
