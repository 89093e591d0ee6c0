"""Colours of scanned points from made-up photographs."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from mission.colouring import colour_scan
from mission.errors import MissionError
from mission.rigid import transformed
from sim.photo import Photo
from sim.scan import Scan
from tests.mission.boxroom import box, pose, scan

WALL = box((4, 4.2), (-4, 4), (0, 4))
RED, GREEN = (255, 0, 0), (0, 255, 0)


def photo(image: NDArray[np.uint8], azimuth: float = 0.0, height: float = 0.0, tilt: float = 0.0) -> Photo:
    """A camera `height` above the scanner that looks along an azimuth; focal length 100 px."""
    c, s, ct, st = np.cos(azimuth), np.sin(azimuth), np.cos(tilt), np.sin(tilt)
    forward = np.array([c * ct, s * ct, st])
    right = np.array([s, -c, 0.0])
    mount = np.eye(4)
    mount[:3, :3] = np.stack([right, np.cross(forward, right), forward], axis=1)
    mount[2, 3] = height
    rows, columns = image.shape[:2]
    intrinsics = np.array([[100, 0, columns / 2], [0, 100, rows / 2], [0, 0, 1.0]])
    return Photo(image, intrinsics, mount, np.zeros((rows, columns), bool))


def plain(colour: tuple[int, int, int], rows: int = 200, columns: int = 200) -> NDArray[np.uint8]:
    return np.full((rows, columns, 3), colour, np.uint8)


def sphere() -> Scan:
    """Everything 5 m away, 1 deg apart."""
    elevations, azimuths = np.deg2rad(np.arange(30, -31, -1.0)), np.deg2rad(np.arange(0, 360, 1.0))
    ranges = np.full((61, 360), 5, np.float32)
    return Scan(elevations, azimuths, ranges, np.zeros_like(ranges), 0.0)


def test_a_point_takes_the_colour_of_the_place_in_the_picture_that_it_projects_to() -> None:
    image = plain((0, 0, 0), columns=120)
    image[:, :, 0] = 2 * np.arange(120)  # pixel column c, centred on u = c + 0.5, has red 2 c
    image[:, :, 1] = np.arange(200)[:, None]
    view = colour_scan(sphere(), [photo(image)], np.eye(4))

    x, y, z = view.points_in_world[view.coloured].astype(float).T
    u, v = 60 - 100 * y / x, 100 - 100 * z / x  # x right is -y, y down is -z
    red, green, _ = view.colours[view.coloured].astype(float).T
    assert np.count_nonzero(view.coloured) > 1000
    assert abs(np.mean(red - 2 * (u - 0.5))) < 0.1  # half a pixel off would be 1
    assert abs(np.mean(green - (v - 0.5))) < 0.1
    assert np.abs(red - 2 * (u - 0.5)).max() < 1.1  # rounding to 8 bit and to 1/32 px


def test_a_point_outside_every_picture_stays_uncoloured() -> None:
    view = colour_scan(sphere(), [photo(plain(RED))], np.eye(4))

    azimuth = np.arctan2(view.points_in_world[:, 1], view.points_in_world[:, 0])
    level = np.abs(view.points_in_world[:, 2]) < 0.5
    inside = np.abs(azimuth) < np.deg2rad(44)  # 100 px of half a picture at 100 px focal length: 45 deg
    assert view.coloured[level & inside].all()
    assert not view.coloured[np.abs(azimuth) > np.deg2rad(46)].any()


def test_of_two_pictures_the_one_that_sees_the_point_nearer_to_its_axis_colours_it() -> None:
    view = colour_scan(sphere(), [photo(plain(RED)), photo(plain(GREEN), azimuth=np.deg2rad(60))], np.eye(4))

    azimuth = np.rad2deg(np.arctan2(view.points_in_world[:, 1], view.points_in_world[:, 0]))
    level = np.abs(view.points_in_world[:, 2]) < 0.5
    red = view.colours[:, 0] == 255
    assert red[level & (azimuth > -40) & (azimuth < 29)].all()  # halfway is 30 deg
    assert not red[level & (azimuth > 31)].any()


def test_of_a_level_and_a_raised_picture_of_one_azimuth_each_colours_its_own_half() -> None:
    pictures = [photo(plain(RED)), photo(plain(GREEN), tilt=np.deg2rad(30))]
    view = colour_scan(sphere(), pictures, np.eye(4))

    x, y, z = view.points_in_world.T
    ahead = (np.abs(y) < 0.3) & (x > 0)
    elevation = np.rad2deg(np.arctan2(z, x))
    red = view.colours[:, 0] == 255
    assert red[ahead & (elevation > -25) & (elevation < 14)].all()  # halfway is 15 deg
    assert not red[ahead & (elevation > 16)].any()


def test_a_point_that_the_camera_above_the_scanner_cannot_see_stays_uncoloured() -> None:
    # A board 2 m away hangs from 0.5 m above the scanner up to 1 m; the wall behind is 4 m away. The scanner sees the
    # wall up to 0.5 * 4 / 2 = 1.0 m; the camera, 0.2 m higher, only up to 0.2 + 0.3 * 4 / 2 = 0.8 m.
    board = box((2, 2.05), (-1.5, 1.5), (1.7, 2.2))
    taken = scan([WALL, board], pose(0, 0), step_deg=0.25)
    view = colour_scan(taken, [photo(plain(RED, 400, 400), height=0.2)], pose(0, 0))

    x, y, z = view.points_in_world.T
    wall = (x > 3.9) & (np.abs(y) < 1)
    assert not view.coloured[wall & (z > 1.2 + 0.85) & (z < 1.2 + 0.97)].any()
    assert view.coloured[wall & (z > 0.3) & (z < 1.2 + 0.72)].all()
    assert view.coloured[(x < 2.02) & (np.abs(y) < 1)].all()


def test_points_are_those_of_the_scan_in_the_world_and_all_stay_without_a_picture() -> None:
    taken, place = scan([WALL], pose(0, 0, 0.2)), pose(1, -2, 0.7)
    view = colour_scan(taken, [], place)

    assert np.allclose(view.points_in_world, transformed(taken.points(), place), atol=1e-5)
    assert not view.coloured.any()


def test_the_camera_centre_is_given_in_the_world() -> None:
    view = colour_scan(sphere(), [photo(plain(RED), height=0.2)], pose(1, 2, z=1.2))

    assert np.allclose(view.camera_in_world, (1, 2, 1.4))
    assert np.allclose(view.scanner_in_world, (1, 2, 1.2))


def test_pictures_from_different_places_are_refused() -> None:
    with pytest.raises(MissionError, match="one camera centre"):
        colour_scan(sphere(), [photo(plain(RED)), photo(plain(RED), height=0.2)], np.eye(4))


def test_bands_do_not_show_in_colours(monkeypatch: pytest.MonkeyPatch) -> None:
    image = np.random.default_rng(0).integers(0, 255, (200, 200, 3), np.uint8)
    photos = [photo(image), photo(plain(GREEN), azimuth=np.deg2rad(50), tilt=0.1)]
    taken = scan([WALL, box((2, 2.1), (-0.5, 0.5), (1, 2))], pose(0, 0))
    views = []
    for pixels in (1, 10**9):
        monkeypatch.setattr("sim.bands._PIXELS", pixels)
        views.append(colour_scan(taken, photos, pose(1, 2, 0.3)))

    assert np.array_equal(views[0].colours, views[1].colours) and views[0].coloured.any()
    assert np.array_equal(views[0].points_in_world, views[1].points_in_world)
