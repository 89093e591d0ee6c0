"""The baselines of the next best scan: the nearest frontier, any place, the nearest place of a grid."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from mission.candidates import PlanningParameters, ScanCandidate
from mission.grid import Cell, OccupancyGrid
from mission.planners import RandomPlace, RegularGrid, frontiers
from mission.planning import Plan, plan_next_scan
from tests.mission.driving_world import FOOTPRINT, pose
from tests.mission.voxel_room import DEPTH, OCCLUDED, ROOM, SCANNER, WIDTH, free_grid, room_voxels

BASELINES = ("frontier", "random", "grid")
HIDDEN = room_voxels().labelled(OCCLUDED, (4.0, WIDTH), (0.0, DEPTH), (0.0, 2.6))
"""The far third of the room has not been seen."""


def half_known() -> OccupancyGrid:
    """Free floor up to x = 4, unknown beyond."""
    return unknown(free_grid(), x=(4.0, WIDTH), y=(0.0, DEPTH))


def unknown(grid: OccupancyGrid, *, x: tuple[float, float], y: tuple[float, float]) -> OccupancyGrid:
    c = grid.centres()
    inside = (c[..., 0] > x[0]) & (c[..., 0] < x[1]) & (c[..., 1] > y[0]) & (c[..., 1] < y[1])
    return replace(grid, cells=np.where(inside, np.uint8(Cell.UNKNOWN), grid.cells))


def plan(
    planner: str, *, seed: tuple[int, ...] = (0,), voxels=HIDDEN, grid=None, scans=((1.2, 2.5),), **numbers
) -> Plan:
    mount = np.eye(4)
    mount[2, 3] = SCANNER
    return plan_next_scan(
        voxels,
        np.empty((0, 3)),
        half_known() if grid is None else grid,
        world_from_base=pose(*scans[-1]),
        base_from_scanner=mount,
        scanners_in_world=np.array([(x, y, SCANNER) for x, y in scans]),
        floor_height=0.0,
        room=ROOM,
        footprint=FOOTPRINT,
        parameters=PlanningParameters(planner=planner, **numbers),
        seed=seed,
    )


def chosen(made: Plan) -> NDArray[np.float64]:
    assert made.chosen is not None, made.stop_reason
    return made.candidates[made.chosen].position


def place(x: float, y: float) -> ScanCandidate:
    """A candidate whose way is its distance from the origin."""
    return ScanCandidate(
        position=np.array([x, y]),
        heading=0.0,
        gain=0.0,
        quality=0.0,
        doorway=0.0,
        overlap=1.0,
        travel=float(np.hypot(x, y)),
        score=0.0,
        reason=None,
    )


def test_a_frontier_is_where_free_floor_meets_unknown_floor_and_its_place_is_its_middle() -> None:
    # The last free column before x = 4 is centred on 3.975; it runs from y = 0 to 5: its middle is at 2.5.
    (middle,) = frontiers(half_known(), room=ROOM, length=0.6)
    np.testing.assert_allclose(middle, [3.975, 2.5], atol=0.03)


def test_a_frontier_shorter_than_the_robot_is_wide_or_outside_the_room_is_none() -> None:
    # A hole of 0.1 x 0.1 m has 12 free neighbours: 0.6 m of cells. Beyond x = 6 nothing belongs to the room.
    hole = unknown(free_grid(), x=(2.0, 2.1), y=(2.0, 2.1))
    assert len(frontiers(hole, room=ROOM, length=0.7)) == 0
    assert len(frontiers(hole, room=ROOM, length=0.5)) == 1
    beyond = unknown(free_grid(x=(0.0, 6.4)), x=(6.2, 6.4), y=(0.0, DEPTH))
    assert len(frontiers(beyond, room=None, length=0.7)) == 1
    assert len(frontiers(beyond, room=ROOM, length=0.7)) == 0


def test_the_frontier_planner_goes_to_the_reachable_place_nearest_to_the_nearest_frontier() -> None:
    # The body's disc of 0.64 m must be free: the place is at most at x = 4 - 0.64, in a square of 0.25 m.
    made = plan("frontier")
    x, y = chosen(made)
    assert 2.8 < x < 3.4 and abs(y - 2.5) < 0.4
    assert sum(candidate.score > 0 for candidate in made.candidates) == 1  # one frontier, one place
    near = unknown(half_known(), x=(0.0, 1.0), y=(4.0, DEPTH))  # a second one, nearer to the robot at (1.2, 2.5)
    assert np.hypot(*(chosen(plan("frontier", grid=near)) - [1.2, 2.5])) < 1.3


def test_without_a_frontier_the_frontier_planner_says_so_although_the_room_is_not_covered() -> None:
    made = plan("frontier", grid=free_grid())
    assert made.coverage < 0.9
    assert (made.stop_reason, made.path) == ("no frontier", None)
    # One whose place was scanned from is done with: its place stays its place.
    x, y = chosen(plan("frontier"))
    assert plan("frontier", scans=((1.2, 2.5), (x, y))).stop_reason == "no frontier"


def test_the_random_planner_draws_evenly_from_the_reachable_places_by_its_seed() -> None:
    assert (chosen(plan("random", seed=(3, 1))) == chosen(plan("random", seed=(3, 1)))).all()
    places = [place(float(k), 0.0) for k in range(4)]
    drawn = [int(np.argmax(RandomPlace(False, (seed,)).scores(places))) for seed in range(400)]  # type: ignore[arg-type]
    # 100 each, give or take three times sqrt(400 * 1/4 * 3/4) = 8.7
    assert np.all(abs(np.bincount(drawn, minlength=4) - 100) < 26)


def test_the_grid_planner_offers_one_place_a_square_the_nearest_first_and_none_where_a_scan_was() -> None:
    # Squares of 2 m round the points of a grid through the first scan at (1, 0): (1, 0), (3, 0), (5, 0), ...
    rule = RegularGrid(False, np.array([[1.0, 0.0, SCANNER], [5.2, 0.3, SCANNER]]), 2.0)
    places = [place(1.5, 0.0), place(2.6, 0.1), place(3.1, 0.2), place(4.9, 0.0), place(3.0, 2.1)]
    scores = rule.scores(places)
    assert [score is None for score in scores] == [True, True, False, True, False]
    # ways of 3.11 m to the one beside (3, 0), 3.66 m to the one beside (3, 2)
    assert scores[2] > scores[4]  # type: ignore[operator]


def test_the_grid_planner_goes_from_square_to_square_until_none_is_left() -> None:
    scans: list[tuple[float, float]] = [(1.2, 2.5)]
    for _ in range(20):
        made = plan("grid", scans=tuple(scans), max_scans=50)
        if made.chosen is None:
            break
        x, y = chosen(made)
        scans.append((float(x), float(y)))
    assert made.stop_reason == "no grid place"
    squares = {(round((x - 1.2) / 2), round((y - 2.5) / 2)) for x, y in scans}
    # Reachable are x from 0.64 to 3.36 and y from 0.64 to 4.36: columns at 1.2 and 3.2, rows at 0.5, 2.5 and 4.5.
    assert len(squares) == len(scans) == 6


@pytest.mark.parametrize("planner", BASELINES)
def test_a_baseline_stops_when_the_room_is_covered_or_the_scans_are_used_up(planner: str) -> None:
    assert plan(planner, voxels=room_voxels()).stop_reason == "coverage"
    assert plan(planner, max_scans=1).stop_reason == "scan limit"


@pytest.mark.parametrize("planner", BASELINES)
def test_a_baseline_takes_places_that_a_scan_can_be_registered_from_and_a_way_leads_to(planner: str) -> None:
    made = plan(planner, min_separation=1.5)
    assert np.hypot(*(chosen(made) - [1.2, 2.5])) >= 1.5
    assert made.path is not None
    np.testing.assert_allclose(made.path[-1], chosen(made))
    wall = half_known()
    c = wall.centres()
    closed = replace(wall, cells=np.where(abs(c[..., 0] - 2.2) < 0.1, np.uint8(Cell.OCCUPIED), wall.cells))
    parted = plan(planner, grid=closed)
    assert all(c.reason == "no way there" and c.score == 0 for c in parted.candidates if c.position[0] > 2.3)
    stopped = plan(planner, min_overlap=1.0)
    assert all(candidate.reason is not None or candidate.overlap == 1.0 for candidate in stopped.candidates)
