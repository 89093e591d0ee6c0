"""What a scan would see, against sight lines drawn by hand."""

from __future__ import annotations

import numpy as np

from mission.prediction import Cells, Obstacles, ScannerView, find_obstacles, prospect
from sim.scan import ScannerParameters
from tests.mission.voxel_room import ROOM, box_points, room_voxels

NO_OBSTACLES = Obstacles(cubes=np.empty((0, 3)), walls=np.empty((0, 2)))


def sees(
    cell: tuple[float, float, float],
    normal: tuple[float, float, float],
    *,
    scanner: ScannerParameters | None = None,
    view: ScannerView | None = None,
) -> bool:
    """Whether a scanner at the origin sees one cell in the open."""
    cells = Cells(np.array([cell]), np.array([normal]))
    scanner, view = scanner or ScannerParameters(), view or ScannerView()
    return bool(prospect(np.zeros(3), cells, NO_OBSTACLES, scanner=scanner, view=view).seen[0])


def test_cells_are_seen_within_range_field_of_view_and_incidence_only() -> None:
    towards_x = (-1.0, 0.0, 0.0)
    assert sees((1.6, 0, 0), towards_x)
    assert not sees((1.4, 0, 0), towards_x)  # nearer than 1.5 m nothing returns
    assert not sees((10.5, 0, 0), towards_x)
    assert not sees((1.6, 0, 0), (1.0, 0.0, 0.0))  # from behind
    # tan 60 = 1.73 and tan 40 = 0.839: the field of view above and below 2 m
    assert sees((2.0, 0, 3.40), towards_x) and not sees((2.0, 0, 3.55), towards_x)
    assert sees((2.0, 0, -1.65), towards_x) and not sees((2.0, 0, -1.70), towards_x)
    # tan 75 = 3.73: oblique by 74.5 deg, and by 75.4 deg
    assert sees((1.0, 3.60, 0), towards_x) and not sees((1.0, 3.85, 0), towards_x)


def test_the_ranges_of_the_scanner_are_those_that_the_prediction_believes() -> None:
    towards_x = (-1.0, 0.0, 0.0)
    near, late = ScannerParameters(min_range=1.3), ScannerParameters(min_range=1.7)
    assert sees((1.4, 0, 0), towards_x, scanner=near) and not sees((1.6, 0, 0), towards_x, scanner=late)
    short, patient = ScannerParameters(max_range=12), ScannerView(max_range=20)
    assert sees((11.5, 0, 0), towards_x, scanner=short, view=patient)
    assert not sees((12.5, 0, 0), towards_x, scanner=short, view=patient)


def test_furniture_hides_the_cells_behind_it_and_no_others() -> None:
    wall = np.array([[4.0, y, 0.0] for y in np.arange(-2.9, 3.0, 0.2)])
    cells = Cells(wall, np.tile([-1.0, 0.0, 0.0], (len(wall), 1)))
    # A post half a metre wide, 2 m away, hides a metre of a wall 4 m away.
    post = box_points((2.0, 2.2), (-0.25, 0.25), (-1.0, 1.0)) + [0, 0, 0.0]
    obstacles = find_obstacles(
        post, Cells(np.array([[0.0, -5, -5], [5, 5, 5]]), np.eye(3)[:2]), walls=None, view=ScannerView()
    )
    seen = prospect(np.zeros(3), cells, obstacles, scanner=ScannerParameters(), view=ScannerView()).seen
    assert not seen[np.abs(wall[:, 1]) < 0.45].any()
    assert seen[np.abs(wall[:, 1]) > 0.75].all()


def test_furniture_close_to_the_scanner_has_no_holes_to_look_through() -> None:
    wall = np.array([[5.0, y, z] for y in np.arange(-1, 1, 0.1) for z in np.arange(-0.9, 1, 0.1)])
    cells = Cells(wall, np.tile([-1.0, 0.0, 0.0], (len(wall), 1)))
    panel = box_points((0.7, 0.72), (-0.5, 0.5), (-0.5, 0.5))
    obstacles = find_obstacles(panel, cells, walls=None, view=ScannerView())
    assert len(obstacles.cubes) == 0  # outside the cells' bounding box nothing is kept
    corners = Cells(np.concatenate([wall, [[0, -2, -2], [0, 2, 2]]]), np.concatenate([cells.normals, np.eye(3)[:2]]))
    obstacles = find_obstacles(panel, corners, walls=None, view=ScannerView())
    assert not prospect(np.zeros(3), cells, obstacles, scanner=ScannerParameters(), view=ScannerView()).seen.any()


def test_the_points_of_a_wall_do_not_hide_the_wall() -> None:
    voxels = room_voxels()
    cells = Cells(voxels.cells_in_world, voxels.normals)
    noise = np.random.default_rng(0).normal(0, 0.004, (len(cells.centres), 3))
    obstacles = find_obstacles(cells.centres + noise, cells, walls=ROOM, view=ScannerView())
    bare = prospect(
        np.array([2.0, 2.0, 1.2]), cells, NO_OBSTACLES, scanner=ScannerParameters(), view=ScannerView()
    ).seen
    np.testing.assert_array_equal(
        prospect(np.array([2.0, 2.0, 1.2]), cells, obstacles, scanner=ScannerParameters(), view=ScannerView()).seen,
        bare,
    )


def test_a_corner_of_the_room_hides_the_other_arm() -> None:
    # An L: the notch is x > 3, y > 2. From deep in one arm the far end of the other is out of sight.
    walls = np.array([[0.0, 0], [6, 0], [6, 2], [3, 2], [3, 6], [0, 6]])
    cells = Cells(np.array([[6.0, 1.0, 1.0], [1.5, 0.0, 1.0]]), np.array([[-1.0, 0, 0], [0.0, 1, 0]]))
    seen = prospect(
        np.array([1.5, 5.0, 1.2]),
        cells,
        Obstacles(np.empty((0, 3)), walls),
        scanner=ScannerParameters(),
        view=ScannerView(),
    ).seen
    assert seen.tolist() == [False, True]
