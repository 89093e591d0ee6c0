"""Ways over the occupancy grid."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from mission.grid import Cell
from mission.navigation import plan_path, road_map
from tests.mission.driving_world import FOOTPRINT, body_gap, free_room, pose


@pytest.mark.parametrize("yaw_deg", [0.0, 30.0])
def test_the_way_round_an_obstacle_keeps_the_body_clear_of_it(yaw_deg: float) -> None:
    obstacle = (2.5, 3.5, -1.0, 2.6)
    turn = pose(0, 0, np.radians(yaw_deg))[:2, :2]
    grid = free_room(6.0, 4.5, obstacle, yaw=np.radians(yaw_deg))
    start, goal = turn @ [1.2, 1.0], turn @ [4.8, 1.0]
    path = plan_path(grid, pose(*start, np.radians(yaw_deg)), goal, footprint=FOOTPRINT)
    assert path is not None
    assert np.allclose(path[0], start) and np.allclose(path[-1], goal)
    for a, b in zip(path[:-1], path[1:], strict=True):
        heading = np.arctan2(*(b - a)[::-1]) - np.radians(yaw_deg)
        for share in np.linspace(0, 1, 30):
            assert body_gap(pose(*(turn.T @ (a + share * (b - a))), heading), [obstacle]) > 0.05
    # Straight over both corners would be 1.2 up and down again; with the margins a good metre more.
    assert np.hypot(*np.diff(path, axis=0).T).sum() < 8.0


@pytest.mark.parametrize("yaw_deg", [0.0, 23.0])
@pytest.mark.parametrize(("width", "passable"), [(0.60, False), (0.85, True)])
def test_a_gap_is_taken_only_where_body_and_margins_fit(width: float, passable: bool, yaw_deg: float) -> None:
    # The body is 0.55 wide and wants 0.08 on either side: 0.71 m, and a cell for the grid.
    wall = [(2.9, 3.1, -1.0, 2.0 - width / 2), (2.9, 3.1, 2.0 + width / 2, 5.0)]
    yaw = np.radians(yaw_deg)
    grid = free_room(6.0, 4.0, *wall, yaw=yaw)
    turn = pose(0, 0, yaw)[:2, :2]
    path = plan_path(grid, pose(*turn @ [1.5, 2.0], yaw), turn @ [4.5, 2.2], footprint=FOOTPRINT)
    assert (path is not None) == passable


def test_a_scan_pose_leaves_room_to_turn_on_the_spot() -> None:
    grid = free_room(4.0, 3.0)
    roads = road_map(grid, pose(2, 1.5), footprint=FOOTPRINT)
    x, y = roads.points[np.isfinite(roads.metres)].T
    # Half the diagonal of 1.0 x 0.55 is 0.57 m.
    assert min(x.min(), y.min(), 4.0 - x.max(), 3.0 - y.max()) > 0.57
    assert len(x) > 40


def test_the_length_of_the_way_is_measured_along_it() -> None:
    roads = road_map(free_room(5.0, 3.0), pose(1.0, 1.5), footprint=FOOTPRINT, goals=np.array([[4.0, 1.5], [1.0, 1.5]]))
    assert roads.metres[1] == pytest.approx(3.0, abs=0.1)
    assert roads.metres[2] == pytest.approx(0.0, abs=1e-6)
    np.testing.assert_allclose(roads.path_to(1), [[1.0, 1.5], [4.0, 1.5]])  # straightened to one leg


def test_beside_a_wall_the_robot_moves_straight_before_it_turns() -> None:
    # 0.40 m from the wall there is no room to turn (0.57); 2 m ahead the wall ends.
    grid = free_room(6.0, 4.0, (-1.0, 2.0, 0.0, 1.0))
    path = plan_path(grid, pose(1.2, 1.4, 0.0), np.array([1.2, 3.0]), footprint=FOOTPRINT)
    assert path is not None
    assert path[1][1] == pytest.approx(1.4)  # straight ahead along x
    assert path[1][0] > 2.0
    # In a niche of its own width it backs out.
    niche = free_room(6.0, 4.0, (3.0, 7.0, -1.0, 1.6), (3.0, 7.0, 2.4, 5.0))
    path = plan_path(niche, pose(3.4, 2.0, 0.0), np.array([1.0, 1.0]), footprint=FOOTPRINT)
    assert path is not None
    assert path[1][1] == pytest.approx(2.0)
    assert path[1][0] < 3.0


def test_there_is_no_way_into_the_unknown_or_behind_a_closed_wall() -> None:
    grid = free_room(6.0, 4.0, (2.9, 3.1, -1.0, 5.0))
    assert plan_path(grid, pose(1.5, 2.0), np.array([4.5, 2.0]), footprint=FOOTPRINT) is None
    assert plan_path(grid, pose(1.5, 2.0), np.array([9.0, 2.0]), footprint=FOOTPRINT) is None


def test_points_of_the_raster_stay_within_the_room_asked_for() -> None:
    half = np.array([[0.0, 0.0], [3.0, 0.0], [3.0, 4.0], [0.0, 4.0]])
    roads = road_map(free_room(6.0, 4.0), pose(1.5, 2.0), footprint=FOOTPRINT, within=half)
    assert roads.points[:, 0].max() < 3.0


def test_backed_against_something_the_robot_leaves_straight_past_what_it_cannot_see_beside_itself() -> None:
    # A box at the corner of its tail, 0.53 m from its middle, and unknown cells along both flanks, out of all sensors'
    # view: no room to turn (0.57 m and the margin); half a metre ahead there is.
    grid = free_room(6.0, 4.0, (1.0, 1.5, 1.3, 1.7))
    c = grid.centres()
    flanks = (abs(c[..., 0] - 2.2) < 0.15) & (abs(abs(c[..., 1] - 2.0) - 0.31) < 0.03)
    grid = replace(grid, cells=np.where(flanks, np.uint8(Cell.UNKNOWN), grid.cells))
    path = plan_path(grid, pose(2.0, 2.0, 0.0), np.array([4.5, 1.0]), footprint=FOOTPRINT)
    assert path is not None
    np.testing.assert_allclose(path[1, 1], 2.0, atol=1e-6)  # straight ahead first
    assert 2.0 < path[1, 0] < 2.5
