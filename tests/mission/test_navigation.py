"""The occupancy grid, ways over it, and driving along them."""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from mission.driving import drive
from mission.following import DrivingParameters, follow_path
from mission.grid import Cell, Footprint, OccupancyGrid, grid_from_scans, with_laser
from mission.navigation import plan_path, road_map

Rectangle = tuple[float, float, float, float]
"""x from, x to, y from, y to [m]."""
SCANNER = np.array([[0.0, 0.0, 1.2]])
FOOTPRINT = Footprint(length=1.0, width=0.55)


def pose(x: float, y: float, yaw: float = 0.0) -> NDArray[np.float64]:
    world_from_base = np.eye(4)
    world_from_base[:2, :2] = [[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]]
    world_from_base[:2, 3] = x, y
    return world_from_base


def sheet(x: tuple[float, float], y: tuple[float, float], z: float, *, step: float = 0.025) -> NDArray[np.float64]:
    """A level surface as points."""
    xs, ys = np.meshgrid(np.arange(*x, step) + step / 2, np.arange(*y, step) + step / 2)
    return np.column_stack([xs.ravel(), ys.ravel(), np.full(xs.size, z)])


def state(grid: OccupancyGrid, x: float, y: float) -> Cell:
    return Cell(grid.states(np.array([x, y])))


def free_room(
    width: float, depth: float, *obstacles: Rectangle, yaw: float = 0.0, resolution: float = 0.05
) -> OccupancyGrid:
    """A room of free cells from (0, 0) to (width, depth), turned about the origin; walls and obstacles are occupied."""
    reach = float(np.hypot(width, depth)) + 0.5
    size = int(2 * reach / resolution)
    empty = OccupancyGrid(np.array([-reach, -reach]), resolution, np.full((size, size), Cell.OCCUPIED, np.uint8))
    x, y = np.moveaxis(empty.centres() @ pose(0, 0, yaw)[:2, :2], -1, 0)
    free = (x > 0) & (x < width) & (y > 0) & (y < depth)
    for x0, x1, y0, y1 in obstacles:
        free &= ~((x > x0) & (x < x1) & (y > y0) & (y < y1))
    return OccupancyGrid(empty.origin, resolution, np.where(free, Cell.FREE, Cell.OCCUPIED).astype(np.uint8))


def laser_scan(
    world_from_base: NDArray[np.float64], obstacles: list[Rectangle], *, rear: bool = False, time: int = 0
) -> Any:
    """What a Hokuyo at the robot's front or rear measures of upright boxes, 240 deg, up to 5.6 m."""
    base_from_laser = pose(-0.45, 0, np.pi) if rear else pose(0.45, 0)
    base_from_laser[2, 3] = 0.4
    angles = np.radians(np.linspace(-120, 120, 682))
    world_from_laser = world_from_base @ base_from_laser
    beams = np.stack([np.cos(angles), np.sin(angles)], axis=1) @ world_from_laser[:2, :2].T
    ranges = np.full(len(angles), np.inf)
    for x0, x1, y0, y1 in obstacles:
        with np.errstate(divide="ignore"):
            near = (np.array([x0, y0]) - world_from_laser[:2, 3]) / beams
            far = (np.array([x1, y1]) - world_from_laser[:2, 3]) / beams
        enter, leave = np.minimum(near, far).max(axis=1), np.maximum(near, far).min(axis=1)
        ranges = np.where((enter <= leave) & (enter > 0), np.minimum(ranges, enter), ranges)
    ranges[ranges > 5.6] = np.nan
    return SimpleNamespace(base_from_laser=base_from_laser, angles=angles, ranges=ranges.astype(np.float32), time=time)


class Unicycle:
    """A robot that does what it is told, while its odometry counts a little differently."""

    def __init__(self, start: NDArray[np.float64], *, drift: float = 0.0, grip: float = 1.0) -> None:
        self.true, self.odometry, self.time = start, start, 0.0
        self._drift, self._grip, self._rng = drift, grip, np.random.default_rng(0)
        self.commands: list[tuple[float, float]] = []
        self.touching: list[str] = []

    def step(self, v: float, w: float, duration: float) -> None:
        self.commands.append((v, w))
        self.true = self.true @ pose(self._grip * v * duration, 0, self._grip * w * duration)
        error = 1 + self._drift * self._rng.standard_normal(2)
        self.odometry = self.odometry @ pose(
            self._grip * v * duration * error[0], 0, self._grip * w * duration * error[1]
        )
        self.time += duration

    def contacts(self) -> list[str]:
        return self.touching


def hokuyos(robot: Unicycle, obstacles: list[Rectangle]) -> Callable[[], list[Any]]:
    return lambda: [laser_scan(robot.true, obstacles, rear=rear) for rear in (False, True)]


def body_gap(world_from_base: NDArray[np.float64], obstacles: list[Rectangle]) -> float:
    """Least distance between the robot's outline and boxes [m], from points all along the outline."""
    s = np.linspace(-1, 1, 41)
    half = np.array([FOOTPRINT.length, FOOTPRINT.width]) / 2
    outline = np.concatenate([np.column_stack([s, k + 0 * s]) for k in (-1, 1)])
    outline = np.concatenate([outline, outline[:, ::-1]]) * half
    x, y = (outline @ world_from_base[:2, :2].T + world_from_base[:2, 3]).T
    gaps = [
        np.hypot(np.maximum(np.maximum(x0 - x, x - x1), 0), np.maximum(np.maximum(y0 - y, y - y1), 0))
        for x0, x1, y0, y1 in obstacles
    ]
    return float(np.min(gaps))


def test_floor_is_free_what_stands_on_it_occupied_and_the_rest_unknown() -> None:
    floor = sheet((2, 4), (-1, 1), 0.002)
    box = sheet((3, 3.3), (0, 0.3), 0.4)
    grid = grid_from_scans(np.concatenate([floor, box]), SCANNER, floor_height=0.0)
    assert state(grid, 2.5, 0.5) == Cell.FREE
    assert state(grid, 3.15, 0.15) == Cell.OCCUPIED
    assert state(grid, 1.0, 0.0) == Cell.UNKNOWN  # within the blind disc


def test_what_the_robot_passes_under_and_lone_mixed_returns_do_not_block() -> None:
    floor = sheet((2, 4), (-1, 1), 0.0)
    lamp = sheet((3, 3.3), (0, 0.3), 1.9)  # over 1.6 m
    ghost = np.array([[2.52, -0.52, 0.8]])
    grid = grid_from_scans(np.concatenate([floor, lamp, ghost]), SCANNER, floor_height=0.0)
    assert state(grid, 3.15, 0.15) == Cell.FREE
    assert state(grid, 2.52, -0.52) == Cell.FREE


def test_heights_are_measured_from_the_floor_wherever_it_lies() -> None:
    floor, box = sheet((2, 4), (-1, 1), -3.2), sheet((3, 3.3), (0, 0.3), -3.0)
    grid = grid_from_scans(np.concatenate([floor, box]), SCANNER - [0, 0, 3.2], floor_height=-3.2)
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
        ring_of_floor(), SCANNER, floor_height=0.0, lasers=lasers, robot_poses=[pose(0, 0)], footprint=FOOTPRINT
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
    grid = grid_from_scans(shadowed, SCANNER, floor_height=0.0, lasers=both_lasers([]))
    assert state(grid, 1.0, 0.0) == Cell.UNKNOWN
    assert state(grid, -1.0, 0.0) == Cell.FREE


def test_a_laser_reading_never_clears_what_the_scanner_found_occupied() -> None:
    grid = grid_from_scans(
        np.concatenate([sheet((-1, 3), (-1, 1), 0.0), sheet((1, 1.4), (0, 0.4), 0.75)]), SCANNER, floor_height=0.0
    )
    grid = with_laser(grid, laser_scan(pose(0, 0), []), pose(0, 0))
    assert state(grid, 1.2, 0.2) == Cell.OCCUPIED


def test_clearance_is_the_distance_to_the_side_of_the_nearest_cell_that_is_not_free() -> None:
    grid = free_room(3.0, 2.0)
    # From the middle of the room: 1 m to the walls on either side.
    assert grid.clearance_at(np.array([1.5, 1.0])) == pytest.approx(1.0, abs=0.03)
    assert grid.clearance_at(np.array([99.0, 0.0])) == 0.0


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


def test_the_follower_first_turns_then_drives_and_never_exceeds_its_limits() -> None:
    path = np.array([[0.0, 0.0], [0.0, 2.0]])
    command = follow_path(path, pose(0, 0, 0))
    assert command.speed == 0.0
    assert command.turn_rate == pytest.approx(0.7)  # left, at the limit
    command = follow_path(path, pose(0, 0, np.pi / 2))
    assert command.speed == pytest.approx(0.3)
    assert command.turn_rate == pytest.approx(0.0, abs=1e-9)
    assert follow_path(path, pose(0, 1.98, np.pi / 2)).target == 2  # done


def test_a_way_point_straight_behind_is_reached_backwards() -> None:
    command = follow_path(np.array([[0.0, 0.0], [-1.0, 0.0]]), pose(0, 0, 0.05))
    assert command.speed < -0.15
    assert command.turn_rate < 0  # turns the heading, 0.05 to the left, back to the line


@pytest.mark.parametrize("seed", range(3))
def test_an_l_shaped_path_is_driven_to_its_end_within_what_odometry_drifts(seed: int) -> None:
    path = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 2.0]])
    robot = Unicycle(pose(0, 0, 2.0), drift=0.3)
    robot._rng = np.random.default_rng(seed)
    driven = drive(robot, path, hokuyos(robot, []), footprint=FOOTPRINT)
    assert driven.outcome == "arrived"
    np.testing.assert_allclose(driven.world_from_base[-1][:2, 3], [2.0, 2.0], atol=0.1)
    # 30 % white noise a tick of 3 cm: over some 140 ticks about 10 cm, sideways with the heading's
    assert np.hypot(*(robot.true[:2, 3] - [2.0, 2.0])) < 0.35
    v, w = np.abs(np.array(robot.commands)).T
    assert v.max() <= 0.3 and w.max() <= 0.7
    assert robot.time < 40.0  # 4 m at 0.3 m/s, three turns of up to 2 rad at 0.7 rad/s


def test_the_record_of_a_drive_begins_at_its_start_and_ends_at_its_end() -> None:
    robot = Unicycle(pose(0, 0))
    watched: list[float] = []
    correction = pose(5.0, 0.0, np.pi / 2)  # registration has found the odometry's origin here
    path = np.array([[5.0, 0.0], [5.0, 1.0]])
    driven = drive(
        robot,
        path,
        hokuyos(robot, []),
        world_from_odometry=correction,
        footprint=FOOTPRINT,
        watch=lambda: watched.append(robot.time),
    )
    assert driven.arrived
    np.testing.assert_allclose(robot.odometry[:2, 3], [1.0, 0.0], atol=0.06)
    np.testing.assert_allclose(driven.world_from_base[0], correction, atol=1e-12)
    np.testing.assert_allclose(driven.world_from_base[-1], correction @ robot.odometry, atol=1e-12)
    np.testing.assert_array_equal(driven.times, np.rint(np.array(watched) * 1e9).astype(np.int64))
    assert len(driven.laser_scans) == len(driven.world_from_base_at_laser) > 4


def test_the_robot_stops_before_a_box_in_its_way_and_then_finds_a_way_round_it() -> None:
    box = (2.0, 2.4, -0.2, 0.2)
    walls = [(-2.0, 5.0, -2.6, -2.5), (-2.0, 5.0, 2.5, 2.6), (-1.1, -1.0, -2.5, 2.5), (5.0, 5.1, -2.5, 2.5)]
    robot = Unicycle(pose(0, 0))
    goal = np.array([4.0, 0.0])
    driven = drive(robot, np.array([[0.0, 0.0], goal]), hokuyos(robot, [box, *walls]), footprint=FOOTPRINT)
    assert driven.outcome == "blocked"
    assert 0.02 < body_gap(robot.true, [box]) < 0.25
    origin = np.array([-1.0, -2.5])
    grid = OccupancyGrid(origin, 0.05, np.full((100, 120), Cell.FREE, np.uint8))
    for scan, world_from_base in zip(driven.laser_scans, driven.world_from_base_at_laser, strict=True):
        grid = with_laser(grid, scan, world_from_base)
    path = plan_path(grid, driven.world_from_base[-1], goal, footprint=FOOTPRINT)
    assert path is not None
    gaps: list[float] = []
    again = drive(
        robot,
        path,
        hokuyos(robot, [box, *walls]),
        footprint=FOOTPRINT,
        watch=lambda: gaps.append(body_gap(robot.true, [box, *walls])),
    )
    assert again.arrived, again.reason
    assert min(gaps) > 0.02


def test_a_robot_that_does_not_move_is_stuck_after_thirty_seconds() -> None:
    robot = Unicycle(pose(0, 0), grip=0.0)
    driven = drive(robot, np.array([[0.0, 0.0], [2.0, 0.0]]), hokuyos(robot, []), footprint=FOOTPRINT)
    assert driven.outcome == "stuck"
    assert robot.time == pytest.approx(30.0, abs=0.2)


def test_a_touch_ends_the_drive_and_names_what_was_touched() -> None:
    robot = Unicycle(pose(0, 0))
    robot.touching = ["chair"]
    driven = drive(robot, np.array([[0.0, 0.0], [2.0, 0.0]]), hokuyos(robot, []), footprint=FOOTPRINT)
    assert driven.outcome == "contact"
    assert "chair" in driven.reason


def test_a_robot_turns_on_the_spot_only_if_its_corners_find_room() -> None:
    # A wall 0.35 m beside the centre: the body has 7 cm, its corners would sweep 0.57 m.
    wall = [(-2.0, 2.0, -0.5, -0.35)]
    robot = Unicycle(pose(0, 0))
    driven = drive(robot, np.array([[0.0, 0.0], [0.0, 2.0]]), hokuyos(robot, wall), footprint=FOOTPRINT)
    assert driven.outcome == "blocked"
    assert body_gap(robot.true, wall) > 0.01
    # Straight along it, it drives; and away from a post that is already within the guard of 3 cm.
    for obstacles in (wall, [(-0.2, 0.2, -0.5, -0.295)]):
        robot = Unicycle(pose(0, 0))
        path = np.array([[0.0, 0.0], [1.0, 0.0]])
        assert drive(robot, path, hokuyos(robot, obstacles), footprint=FOOTPRINT).arrived


def test_noise_of_a_single_reading_does_not_stop_the_robot() -> None:
    robot = Unicycle(pose(0, 0))

    def measure() -> list[Any]:
        scan = laser_scan(robot.true, [])
        scan.ranges[341] = 0.1  # dust
        return [scan]

    parameters = DrivingParameters(readings=2)
    path = np.array([[0.0, 0.0], [1.0, 0.0]])
    assert drive(robot, path, measure, footprint=FOOTPRINT, parameters=parameters).arrived
