"""What the detector says to rooms that are broken, empty or absurd: an error by name, or an honest empty result."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from detector.detect import detect_doors
from detector.openings import Visibility
from detector.parameters import DetectorParameters
from detector.result import WallResult
from detector.room import DetectorError, Room, View, Wall
from tests.detector.synthetic import DoorSpec, Layout, make_room

ROUGH = DetectorParameters(pixel_size=0.02)
"""For scans of 0.5 deg: 26 mm between samples at 3 m."""
DOOR = DoorSpec(left=2.5, angle_deg=60, inward=False, recess=0.07)


@pytest.fixture(scope="module")
def room() -> Room:
    """A wall of 6 x 2.7 m with one open door, in three views."""
    return make_room(Layout(doors=[DOOR]), step_deg=0.5)


@pytest.fixture(scope="module")
def sound(room: Room) -> WallResult:
    """What is found where nothing is wrong."""
    return detect(room)


@pytest.fixture(autouse=True)
def no_warning() -> Iterator[None]:
    """A warning of numpy's is a crash that has not happened yet."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        yield


def detect(room: Room, parameters: DetectorParameters = ROUGH) -> WallResult:
    """The result of the first wall."""
    return detect_doors(room, parameters)[0]


def with_wall(room: Room, **changes: object) -> Room:
    """The room with its wall changed."""
    return replace(room, walls=(replace(room.walls[0], **changes),))


def with_views(room: Room, **changes: object) -> Room:
    """The room with all views changed."""
    return replace(room, views=tuple(replace(v, **changes) for v in room.views))


def assert_nothing_was_judged(result: WallResult) -> None:
    """Every pixel says that nothing is known about it, and so does the list of views."""
    assert result.doors == () and result.views == () and result.view_numbers == ()
    assert not np.isfinite(result.merged.depth).any()
    assert not np.isin(result.openings.visibility, [Visibility.DATA, Visibility.SHADOWED]).any()


def test_a_wall_without_a_point_is_a_wall_of_which_nothing_is_known(room: Room) -> None:
    empty = {"points_in_world": np.zeros((0, 3), np.float32), "colours": np.zeros((0, 3), np.uint8)}
    assert_nothing_was_judged(detect(with_views(room, **empty, coloured=np.zeros(0, bool))))


def test_one_view_is_enough_for_an_open_door(room: Room) -> None:
    (door,) = detect(replace(room, views=room.views[1:2])).doors
    assert door.rectangle.left == pytest.approx(DOOR.left, abs=0.08)  # three samples


def test_without_any_colour_an_open_door_is_found_by_its_depth(room: Room) -> None:
    views = tuple(replace(v, coloured=np.zeros_like(v.coloured)) for v in room.views)
    (door,) = detect(replace(room, views=views)).doors
    assert door.state == "semi-open" and np.rad2deg(door.opening_angle) == pytest.approx(60, abs=1.5)


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_points_that_are_no_numbers_change_nothing_for_the_others(room: Room, sound: WallResult, value: float) -> None:
    broken = []
    for view in room.views:
        stray = np.full((300, 3), value, np.float32)
        stray[100:, 0] = 1.0  # broken in two coordinates, and in one
        stray[200:, 1] = 1.0
        broken.append(
            replace(
                view,
                points_in_world=np.concatenate([view.points_in_world, stray]),
                colours=np.concatenate([view.colours, np.zeros((300, 3), np.uint8)]),
                coloured=np.concatenate([view.coloured, np.ones(300, bool)]),
            )
        )
    found = detect(replace(room, views=tuple(broken)))
    np.testing.assert_array_equal(found.merged.depth, sound.merged.depth)
    assert [d.rectangle for d in found.doors] == [d.rectangle for d in sound.doors]


@pytest.mark.parametrize(("width", "height"), [(0.3, 2.7), (6.0, 1.0), (0.001, 2.7), (6.0, 0.001), (0.001, 0.001)])
def test_a_wall_that_is_smaller_than_a_door_has_none(room: Room, width: float, height: float) -> None:
    assert detect(with_wall(room, width=width, height=height)).doors == ()


def test_a_wall_that_is_given_twice_is_judged_twice_alike(room: Room) -> None:
    first, second = detect_doors(replace(room, walls=room.walls * 2), ROUGH)
    assert first.doors[0].rectangle == second.doors[0].rectangle
    np.testing.assert_array_equal(first.merged.colour, second.merged.colour)


def test_a_hundred_thousand_columns_of_a_millimetre_are_refused_by_the_pixel_size(room: Room) -> None:
    with pytest.raises(DetectorError, match=r"pixel_size: 0\.001 m makes 2700 x 100000 pixels"):
        detect(with_wall(room, width=100.0), DetectorParameters(pixel_size=0.001))


def test_a_wall_of_one_row_of_a_hundred_thousand_pixels_is_accepted(room: Room) -> None:
    result = detect(with_wall(room, width=100.0, height=0.001), DetectorParameters(pixel_size=0.001))
    assert result.merged.depth.shape == (1, 100_000) and result.doors == ()


def test_views_from_behind_the_wall_do_not_see_it(room: Room) -> None:
    wall = room.walls[0]
    behind = replace(wall, origin=wall.origin + wall.width * wall.u, u=-wall.u)
    assert_nothing_was_judged(detect(replace(room, walls=(behind,))))


@pytest.mark.parametrize(
    ("change", "name"),
    [
        ({"voxel_labels": np.zeros((0, 5), np.uint8)}, "voxel_labels"),
        ({"voxel_labels": np.zeros(5, np.uint8)}, "voxel_labels"),
        ({"voxel_size": 0.0}, "voxel_size"),
        ({"voxel_size": float("nan")}, "voxel_size"),
        ({"width": float("inf")}, "width"),
        ({"height": 0.0}, "height"),
        ({"u": np.array([np.nan, 0, 0])}, "u"),
        ({"v": np.array([1.0, 0, 0])}, "u"),
        ({"origin": np.array([np.inf, 0, 0])}, "origin"),
        ({"origin": np.zeros(2)}, "origin"),
    ],
)
def test_a_wall_that_is_no_rectangle_is_refused_by_the_name_of_its_field(room: Room, change: dict, name: str) -> None:
    with pytest.raises(DetectorError, match=rf"Wall\.{name}"):
        detect(with_wall(room, **change))


@pytest.mark.parametrize(
    ("change", "name"),
    [
        ({"camera_in_world": np.full(3, np.nan)}, "camera_in_world"),
        ({"scanner_in_world": np.array([0, np.inf, 0])}, "scanner_in_world"),
        ({"colours": np.zeros((4, 3), np.uint8)}, "colours"),
        ({"coloured": np.zeros((1, 1), bool)}, "coloured"),
    ],
)
def test_a_view_that_makes_no_sense_is_refused_by_the_name_of_its_field(room: Room, change: dict, name: str) -> None:
    with pytest.raises(DetectorError, match=rf"View\.{name}"):
        replace(room.views[0], **change)


def test_points_in_whole_numbers_are_refused_by_name(room: Room) -> None:
    view = room.views[0]
    with pytest.raises(
        DetectorError, match=r"View\.points_in_world: expected an array of float32 or float64, got int64"
    ):
        replace(view, points_in_world=view.points_in_world.astype(np.int64))


def test_a_floor_that_is_no_number_is_refused_by_name(room: Room) -> None:
    with pytest.raises(DetectorError, match=r"Room\.floor_height"):
        detect(replace(room, floor_height=float("nan")))


def test_a_room_without_walls_has_no_results(room: Room) -> None:
    assert detect_doors(replace(room, walls=()), ROUGH) == []


@pytest.mark.parametrize("seed", range(12))
def test_whatever_is_wrong_with_a_room_nothing_but_the_detectors_own_error_comes_out(room: Room, seed: int) -> None:
    broken, parameters = perturbed(room, np.random.default_rng(seed))
    try:
        results = detect_doors(broken, parameters)
    except DetectorError:
        return
    for wall, result in zip(broken.walls, results, strict=True):
        for door in result.doors:
            assert 0 <= door.rectangle.left < door.rectangle.right <= wall.width + 1e-6


def perturbed(room: Room, rng: np.random.Generator) -> tuple[Room, DetectorParameters]:
    """The room with points, colours and views lost or spoilt, walls of any size, and a floor somewhere."""
    views = tuple(spoilt(v, rng) for v in room.views if rng.random() < 0.8)
    walls = tuple(moved(room.walls[0], rng) for _ in range(rng.integers(1, 3)))
    floor = room.floor_height + float(rng.choice([0, 0, 0.02, -0.5, 1.0, 5.0]))
    parameters = DetectorParameters(
        pixel_size=float(rng.choice([0.02, 0.05, 0.1])), correct_highlights=bool(rng.random() < 0.8)
    )
    return replace(room, views=views, walls=walls, floor_height=floor), parameters


def spoilt(view: View, rng: np.random.Generator) -> View:
    """A view with some of its points, some of them no numbers, and some of their colours."""
    points = view.points_in_world.copy()
    points[rng.random(len(points)) < rng.choice([0, 0.1])] = rng.choice([np.nan, np.inf, -np.inf, 1e30])
    kept = rng.random(len(points)) < rng.choice([1.0, 0.5, 0.01, 0.0001])
    coloured = view.coloured & (rng.random(len(points)) < rng.choice([1.0, 0.3, 0.0]))
    colours = view.colours // np.uint8(rng.choice([1, 255])) * np.uint8(rng.choice([1, 0]))
    return replace(view, points_in_world=points[kept], colours=colours[kept], coloured=coloured[kept])


def moved(wall: Wall, rng: np.random.Generator) -> Wall:
    """The wall cut, enlarged, shifted or turned, with labels that may be anybody's."""
    sizes = (1e-3, 0.02, 0.3, 1.0, 2.7, 6.0, 9.0)
    width, height = (
        own if rng.random() < 0.5 else float(rng.choice(sizes)) for own in (float(wall.width), float(wall.height))
    )
    angle = float(rng.choice([0, 0, 0, 0.2, np.pi / 2]))
    u = np.cos(angle) * wall.u + np.sin(angle) * wall.normal
    labels = wall.voxel_labels
    if rng.random() < 0.5:
        labels = rng.integers(0, 5, rng.integers(1, 20, 2)).astype(np.uint8)
    origin = wall.origin + rng.choice([0, 0, 0.1, 3.0]) * wall.normal + rng.choice([0, 0, 2.0]) * wall.u
    return replace(wall, origin=origin, u=u, width=width, height=height, voxel_labels=labels)
