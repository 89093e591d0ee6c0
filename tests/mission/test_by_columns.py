"""Points whose coordinates lie together in memory."""

from __future__ import annotations

import numpy as np

from mission.by_columns import chosen, distinct, gathered

PARTS = [np.array([[1, 2, 3], [4, 5, 6]], np.float32), np.array([[7, 8, 9]], np.float32)]


def test_points_are_the_same_by_columns_and_by_rows() -> None:
    points = gathered(PARTS)
    assert points.flags.f_contiguous
    assert points.tolist() == [[1, 2, 3], [4, 5, 6], [7, 8, 9]]
    for which in (np.array([True, False, True]), np.array([0, 2])):
        assert chosen(points, which).flags.f_contiguous
        assert chosen(points, which).tolist() == [[1, 2, 3], [7, 8, 9]]


def test_distinct_cells_come_once_and_in_ascending_order() -> None:
    cells = np.array([[2, -1, 0], [-3, 4, 1], [2, -1, 0], [-3, 4, -1]])
    assert distinct(cells).tolist() == [[-3, 4, -1], [-3, 4, 1], [2, -1, 0]]


def test_no_cells_are_no_distinct_cells() -> None:
    assert distinct(np.empty((0, 3), int)).shape == (0, 3)
