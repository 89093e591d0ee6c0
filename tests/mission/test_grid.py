"""The occupancy grid, from points and readings placed by hand."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from mission.grid import Cell, Footprint, OccupancyGrid, occupancy_grid, scanned_floor, with_laser
from sim.scan import ScannerParameters
from tests.mission.driving_world import FOOTPRINT, Rectangle, free_room, laser_scan, pose

SCANNER = np.array([[0.0, 0.0, 1.2]])


def sheet(x: tuple[float, float], y: tuple[float, float], z: float, *, step: float = 0.025) -> NDArray[np.float64]:
    """A level surface as points."""
    xs, ys = np.meshgrid(np.arange(*x, step) + step / 2, np.arange(*y, step) + step / 2)
    return np.column_stack([xs.ravel(), ys.ravel(), np.full(xs.size, z)])


def grid_from_scans(
    points: NDArray[np.float64], scanners: NDArray[np.float64], *, floor_height: float, **others: Any
) -> OccupancyGrid:
    return occupancy_grid(scanned_floor(points, scanners, floor_height=floor_height), **others)


def state(grid: OccupancyGrid, x: float, y: float) -> Cell:
    return Cell(grid.states(np.array([x, y])))


def test_floor_is_free_what_stands_on_it_occupied_and_the_rest_unknown() -> None:
    floor = sheet((2, 4), (-1, 1), 0.002)
    box = sheet((3, 3.3), (0, 0.3), 0.4)
    grid = grid_from_scans(np.concatenate([floor, box]), SCANNER, floor_height=0.0, footprint=FOOTPRINT)
    assert state(grid, 2.5, 0.5) == Cell.FREE
    assert state(grid, 3.15, 0.15) == Cell.OCCUPIED
    assert state(grid, 1.0, 0.0) == Cell.UNKNOWN  # within the blind disc


def test_what_the_robot_passes_under_and_lone_mixed_returns_do_not_block() -> None:
    floor = sheet((2, 4), (-1, 1), 0.0)
    lamp = sheet((3, 3.3), (0, 0.3), 1.9)  # over 1.6 m
    ghost = np.array([[2.52, -0.52, 0.8]])
    grid = grid_from_scans(np.concatenate([floor, lamp, ghost]), SCANNER, floor_height=0.0, footprint=FOOTPRINT)
    assert state(grid, 3.15, 0.15) == Cell.FREE
    assert state(grid, 2.52, -0.52) == Cell.FREE


def test_heights_are_measured_from_the_floor_wherever_it_lies() -> None:
    floor, box = sheet((2, 4), (-1, 1), -3.2), sheet((3, 3.3), (0, 0.3), -3.0)
    grid = grid_from_scans(np.concatenate([floor, box]), SCANNER - [0, 0, 3.2], floor_height=-3.2, footprint=FOOTPRINT)
    assert state(grid, 2.5, 0.5) == Cell.FREE
    assert state(grid, 3.15, 0.15) == Cell.OCCUPIED


def ring_of_floor(*, shadow: tuple[float, float] = (0.0, 0.0)) -> NDArray[np.float64]:
    """Floor outside the blind disc of a scanner 1.2 m high (1.43 m), less a sector of azimuths [rad]."""
    floor = sheet((-4, 4), (-4, 4), 0.0)
    azimuth = np.arctan2(floor[:, 1], floor[:, 0])
    dark = (azimuth > shadow[0]) & (azimuth < shadow[1])
    return floor[(np.hypot(floor[:, 0], floor[:, 1]) > 1.43) & ~dark]


def both_lasers(obstacles: list[Rectangle]) -> list[tuple[Any, NDArray[np.float64]]]:
    return [(laser_scan(pose(0, 0), obstacles, rear=rear), pose(0, 0)) for rear in (False, True)]


def test_hokuyos_clear_the_scanners_blind_disc_up_to_what_they_hit() -> None:
    lasers = both_lasers([(0.9, 1.1, -0.2, 0.2)])
    grid = grid_from_scans(
        ring_of_floor(), SCANNER, floor_height=0.0, footprint=FOOTPRINT, lasers=lasers, robot_poses=[pose(0, 0)]
    )
    assert state(grid, -1.0, 0.3) == Cell.FREE
    assert state(grid, 0.7, 0.0) == Cell.FREE
    assert state(grid, 0.91, 0.0) == Cell.OCCUPIED
    assert state(grid, 1.2, 0.0) == Cell.UNKNOWN  # behind the hit
    assert state(grid, 0.0, 0.0) == Cell.FREE  # under the robot
    assert state(grid, 0.0, 0.5) == Cell.UNKNOWN  # beside it, where neither Hokuyo looks


def test_a_missing_floor_betrays_a_table_top_that_scanner_and_hokuyo_both_miss() -> None:
    # A table top 1 m from the scanner gives no return (minimum range) and lies above the Hokuyo's plane.
    shadowed = ring_of_floor(shadow=(-0.4, 0.4))
    grid = grid_from_scans(shadowed, SCANNER, floor_height=0.0, footprint=FOOTPRINT, lasers=both_lasers([]))
    assert state(grid, 1.0, 0.0) == Cell.UNKNOWN
    assert state(grid, -1.0, 0.0) == Cell.FREE


def test_the_blind_disc_is_as_wide_as_the_least_range_of_the_scanner() -> None:
    # From 1.2 m height a least range of 3 m reaches the floor 2.75 m away: there it must begin, and the Hokuyos may
    # clear what lies within. Of a scanner that measures from 1.5 m on, it should have begun at 1.43 m.
    floor = sheet((-4, 4), (-4, 4), 0.0)
    floor = floor[np.hypot(floor[:, 0], floor[:, 1]) > 2.75]
    for min_range, expected in ((3.0, Cell.FREE), (1.5, Cell.UNKNOWN)):
        grid = grid_from_scans(
            floor,
            SCANNER,
            floor_height=0.0,
            footprint=FOOTPRINT,
            lasers=both_lasers([]),
            scanner=ScannerParameters(min_range=min_range),
        )
        assert state(grid, 1.0, 0.0) == expected


def test_a_laser_reading_never_clears_what_the_scanner_found_occupied() -> None:
    grid = grid_from_scans(
        np.concatenate([sheet((-1, 3), (-1, 1), 0.0), sheet((1, 1.4), (0, 0.4), 0.75)]),
        SCANNER,
        floor_height=0.0,
        footprint=FOOTPRINT,
    )
    grid = with_laser(grid, laser_scan(pose(0, 0), []), pose(0, 0))
    assert state(grid, 1.2, 0.2) == Cell.OCCUPIED


def test_clearance_is_the_distance_to_the_side_of_the_nearest_cell_that_is_not_free() -> None:
    grid = free_room(3.0, 2.0)
    # From the middle of the room: 1 m to the walls on either side.
    assert grid.clearance_at(np.array([1.5, 1.0])) == pytest.approx(1.0, abs=0.03)
    assert grid.clearance_at(np.array([99.0, 0.0])) == 0.0


def test_the_cells_under_the_robot_are_those_of_its_own_outline() -> None:
    # MoPAD is 0.97 m long and 0.57 m wide; its ends are at 0.485 and 0.285, cells are 5 cm.
    stands = grid_from_scans(ring_of_floor(), SCANNER, floor_height=0.0, footprint=FOOTPRINT, robot_poses=[pose(0, 0)])
    c = stands.centres()
    near = (np.abs(c) < 1.0).all(axis=-1)  # inside the blind disc nothing else speaks
    covered = (np.abs(c[..., 0]) <= 0.485) & (np.abs(c[..., 1]) <= 0.285)
    np.testing.assert_array_equal((stands.cells == Cell.FREE)[near], covered[near])


def test_nobody_assumes_a_footprint() -> None:
    with pytest.raises(TypeError):
        Footprint()  # type: ignore[call-arg]


def test_readings_under_way_tell_of_new_things_and_of_nothing_else() -> None:
    floor, box = sheet((2, 4), (-1, 1), 0.0), sheet((3.5, 3.8), (-0.5, 0.5), 0.4)
    seen = np.concatenate([floor, box])
    # From (1.5, 0) the front Hokuyo is at x = 1.95. A chair stands at y = 0.7, and the box seems 8 cm nearer.
    reading = laser_scan(pose(1.5, 0.0), [(2.6, 2.8, 0.6, 0.8), (3.42, 3.8, -0.5, 0.5)])
    told = [(reading, pose(1.5, 0.0))]
    grid = grid_from_scans(seen, SCANNER, floor_height=0.0, footprint=FOOTPRINT, passing=told)
    assert state(grid, 2.625, 0.65) == Cell.OCCUPIED  # its near side
    assert state(grid, 3.425, 0.0) == Cell.FREE  # the scan knows better where the box is
    assert state(grid, 1.6, 0.8) == Cell.UNKNOWN  # crossed at the height of the Hokuyo only
    still = grid_from_scans(seen, SCANNER, floor_height=0.0, footprint=FOOTPRINT, lasers=told)
    assert state(still, 3.425, 0.0) == Cell.OCCUPIED
