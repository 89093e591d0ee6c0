"""The next best scan, in rooms whose hidden parts are known."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from mission.candidates import PlanningParameters, worth
from mission.grid import Cell, OccupancyGrid
from mission.planning import Plan, plan_next_scan
from tests.mission.driving_world import FOOTPRINT
from tests.mission.voxel_room import (
    DEPTH,
    OCCLUDED,
    OPENING,
    ROOM,
    SCANNER,
    WIDTH,
    Voxels,
    box_points,
    free_grid,
    room_voxels,
)

MOUNT = np.eye(4)
MOUNT[2, 3] = SCANNER


def at(x: float, y: float) -> NDArray[np.float64]:
    world_from_base = np.eye(4)
    world_from_base[:2, 3] = x, y
    return world_from_base


def plan(
    voxels: Voxels,
    *,
    scanners: list[tuple[float, float]],
    points: NDArray[np.float64] | None = None,
    grid: OccupancyGrid | None = None,
    failed: NDArray[np.float64] | None = None,
    parameters: PlanningParameters | None = None,
) -> Plan:
    """Plan from the last of the places that were scanned from."""
    return plan_next_scan(
        voxels,
        np.empty((0, 3)) if points is None else points,
        grid or free_grid(),
        world_from_base=at(*scanners[-1]),
        base_from_scanner=MOUNT,
        scanners_in_world=np.array([(x, y, SCANNER) for x, y in scanners]),
        floor_height=0.0,
        room=ROOM,
        failed_in_world=failed,
        footprint=FOOTPRINT,
        parameters=parameters,
    )


SCREEN = ((2.9, 3.1), (2.0, 4.0), (0.0, 2.6))
"""A partition of full height that stands across the room."""


def screened_room() -> tuple[Voxels, NDArray[np.float64], OccupancyGrid]:
    """Scanned from (1.2, 3.0): of the wall at x = 6, what lies between y = 1.5 and 4.7 is in the screen's shadow."""
    # Shadow on x = 6: y = 3 -+ 1 * 4.8 / 1.7 = 3 -+ 2.8, taken a little narrower.
    voxels = room_voxels().labelled(OCCLUDED, (5.99, 6.01), (0.5, 4.7), (0.0, 2.6))
    grid = free_grid()
    c = grid.centres()
    screen = (abs(c[..., 0] - 3.0) < 0.1) & (c[..., 1] > 2.0) & (c[..., 1] < 4.0)
    grid = replace(grid, cells=np.where(screen, np.uint8(Cell.OCCUPIED), grid.cells))
    return voxels, box_points(*SCREEN), grid


def exact_gain(voxels: Voxels, x: float, y: float) -> float:
    """Area of the hidden strip that is seen from a place, by cutting each line of sight with the screen's outline."""
    scanner = np.array([x, y, SCANNER])
    strip = voxels.labels == OCCLUDED
    ray = voxels.cells_in_world[strip] - scanner
    distance = np.sqrt((ray**2).sum(axis=1))
    enter = np.minimum((2.9 - x) / ray[:, 0], (3.1 - x) / ray[:, 0])
    leave = np.maximum((2.9 - x) / ray[:, 0], (3.1 - x) / ray[:, 0])
    sides = np.sort(np.stack([(2.0 - y) / ray[:, 1], (4.0 - y) / ray[:, 1]]), axis=0)
    blocked = (np.maximum(enter, sides[0]) < np.minimum(leave, sides[1])) & (leave > 0)
    elevation, cosine = np.degrees(np.arcsin(ray[:, 2] / distance)), ray[:, 0] / distance
    in_view = (distance > 1.5) & (elevation < 60) & (elevation > -40) & (cosine > np.cos(np.radians(75)))
    return float(0.04 * (in_view & ~blocked).sum())


def test_each_candidate_is_credited_with_the_hidden_area_that_it_would_see() -> None:
    voxels, points, grid = screened_room()
    candidates = plan(voxels, scanners=[(1.2, 3.0)], points=points, grid=grid).candidates
    exact = np.array([exact_gain(voxels, *c.position) for c in candidates])
    predicted = np.array([c.gain for c in candidates])
    # The strip has 4.2 x 2.6 m = 10.9 m2; a bin of 0.75 deg and the screen's cubes are 5 cm wide on it.
    assert np.quantile(abs(predicted - exact), 0.9) < 0.6
    assert exact.max() > 9.0 and exact.min() < 2.0  # they do differ


def test_the_chosen_place_looks_at_what_the_screen_hid() -> None:
    voxels, points, grid = screened_room()
    chosen_plan = plan(voxels, scanners=[(1.2, 3.0)], points=points, grid=grid)
    assert chosen_plan.stop_reason is None and chosen_plan.chosen is not None
    chosen = chosen_plan.candidates[chosen_plan.chosen]
    assert exact_gain(voxels, *chosen.position) > 8.0
    assert chosen.position[0] < 4.5  # 1.5 m or more from the wall it is to scan
    assert chosen.score == max(candidate.score for candidate in chosen_plan.candidates)
    assert chosen_plan.path is not None
    np.testing.assert_allclose(chosen_plan.path[0], [1.2, 3.0])
    np.testing.assert_allclose(chosen_plan.path[-1], chosen.position)


def test_the_score_falls_with_the_way_and_weighs_its_terms_as_documented() -> None:
    voxels, points, grid = screened_room()
    parameters = PlanningParameters(travel_cost=0.1, quality_weight=0.5, doorway_weight=2.0)
    for c in plan(voxels, scanners=[(1.2, 3.0)], points=points, grid=grid, parameters=parameters).candidates:
        if c.reason is None:
            expected = (c.gain + 0.5 * c.quality + 2.0 * c.doorway) * np.exp(-0.1 * c.travel)
            assert c.score == pytest.approx(expected)


def test_two_plans_from_the_same_facts_are_the_same() -> None:
    voxels, points, grid = screened_room()
    first = plan(voxels, scanners=[(1.2, 3.0)], points=points, grid=grid)
    second = plan(voxels, scanners=[(1.2, 3.0)], points=points.copy(), grid=grid)
    assert first.chosen == second.chosen
    assert [c.score for c in first.candidates] == [c.score for c in second.candidates]
    np.testing.assert_array_equal(first.path, second.path)


def test_the_room_is_done_when_it_is_covered() -> None:
    done = plan(room_voxels(), scanners=[(1.5, 2.5), (4.5, 2.5)])
    assert done.stop_reason == "coverage"
    assert done.coverage == 1.0
    assert done.chosen is None and done.path is None
    assert len(done.candidates) > 100  # with their scores, for the record


def test_a_small_rest_does_not_keep_a_covered_room_going() -> None:
    # 1 m2 of 117.2 m2 is hidden, 99.1 % covered; a third scan would see it.
    voxels = room_voxels().labelled(OCCLUDED, (2.0, 3.0), (2.0, 3.0), (-0.01, 0.01))
    done = plan(voxels, scanners=[(2.0, 2.4), (3.0, 2.6)])
    assert max(candidate.gain for candidate in done.candidates) > 0.8
    assert done.stop_reason == "coverage"
    strict = PlanningParameters(target_coverage=0.995)
    assert plan(voxels, scanners=[(2.0, 2.4), (3.0, 2.6)], parameters=strict).stop_reason is None


def test_coverage_is_the_share_of_the_area_that_is_not_occluded() -> None:
    voxels = room_voxels().labelled(OCCLUDED, (0.0, WIDTH), (0.0, DEPTH), (-0.1, 0.01))
    # floor 30 m2 of 2 * 30 + 2 * (6 + 5) * 2.6 = 117.2 m2
    assert plan(voxels, scanners=[(1.5, 2.5)]).coverage == pytest.approx(1 - 30 / 117.2)


def test_no_gain_ends_a_room_whose_rest_cannot_be_seen() -> None:
    # The floor behind the front of a chest that stands all along a wall.
    hidden = room_voxels().labelled(OCCLUDED, (0.0, 6.0), (0.0, 0.6), (-0.01, 0.01))
    bench = box_points((0.0, 6.0), (0.0, 1.0), (0.0, 0.6))
    stopped = plan(hidden, scanners=[(1.5, 2.5), (4.5, 2.5)], points=bench, grid=free_grid(y=(1.0, DEPTH)))
    assert stopped.coverage < 0.98
    assert stopped.stop_reason == "no gain"
    assert stopped.chosen is None


def test_the_limit_of_scans_ends_a_room() -> None:
    voxels, points, grid = screened_room()
    limit = PlanningParameters(max_scans=2)
    assert plan(voxels, scanners=[(1.2, 3.0)], points=points, grid=grid, parameters=limit).stop_reason is None
    places = [(4.5, 1.0), (1.2, 3.0)]
    assert plan(voxels, scanners=places, points=points, grid=grid, parameters=limit).stop_reason == "scan limit"


def test_a_robot_that_is_shut_in_has_nothing_to_reach() -> None:
    voxels, points, _ = screened_room()
    pen = free_grid(x=(0.5, 1.9), y=(2.3, 3.7))  # room to turn about its centre only
    shut_in = plan(voxels, scanners=[(1.2, 3.0)], points=points, grid=pen)
    assert shut_in.stop_reason == "nothing reachable"
    wall = free_grid()
    c = wall.centres()
    closed = replace(wall, cells=np.where(abs(c[..., 0] - 2.2) < 0.1, np.uint8(Cell.OCCUPIED), wall.cells))
    parted = plan(voxels, scanners=[(1.2, 3.0)], points=points, grid=closed)
    beyond = [candidate for candidate in parted.candidates if candidate.position[0] > 2.5]
    assert beyond
    assert all(candidate.reason == "no way there" and candidate.score == 0 for candidate in beyond)


def test_a_scan_must_see_enough_of_what_is_known() -> None:
    voxels, points, grid = screened_room()
    all_of_it = PlanningParameters(min_overlap=1.0)
    stopped = plan(voxels, scanners=[(1.2, 3.0)], points=points, grid=grid, parameters=all_of_it)
    assert any(c.reason == "overlap under 1" and c.score == 0 for c in stopped.candidates)
    for c in stopped.candidates:
        assert c.reason is not None or c.overlap == 1.0


def test_no_second_scan_is_taken_beside_an_earlier_one_even_a_failed_one() -> None:
    voxels, points, grid = screened_room()
    first = plan(voxels, scanners=[(1.2, 3.0)], points=points, grid=grid)
    assert first.chosen is not None
    failed = np.append(first.candidates[first.chosen].position, SCANNER)
    second = plan(voxels, scanners=[(1.2, 3.0)], points=points, grid=grid, failed=failed[None])
    assert second.chosen is not None
    assert np.hypot(*(second.candidates[second.chosen].position - failed[:2])) >= 0.5
    limit = PlanningParameters(max_scans=2)
    stopped = plan(voxels, scanners=[(1.2, 3.0)], points=points, grid=grid, failed=failed[None], parameters=limit)
    assert stopped.stop_reason == "scan limit"


def test_a_doorway_seen_from_one_side_keeps_a_covered_room_going() -> None:
    doorway = room_voxels().labelled(OPENING, (2.6, 3.4), (-0.01, 0.01), (0.0, 2.0))
    more = plan(doorway, scanners=[(4.8, 3.5), (4.8, 2.2)])
    assert more.coverage == 1.0
    assert more.chosen is not None
    assert more.candidates[more.chosen].position[0] < 2.6
    assert worth(more.candidates[more.chosen], PlanningParameters(), covered=True) >= 0.5
    assert plan(doorway, scanners=[(4.8, 2.2), (1.2, 2.2)]).stop_reason == "coverage"
