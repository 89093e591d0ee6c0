"""Floor, ceiling and walls of rooms of boxes whose plans are known."""

from __future__ import annotations

import numpy as np
import pytest

from mission.errors import MissionError
from mission.rigid import inverted, rotated, transformed
from mission.samples import PosedSample, place, sample_scan
from mission.structure import Structure, find_structure
from tests.mission.boxroom import Box, box, moved, plain_room, pose, scan, with_doorway

SHIFT, YAW = (10.0, -7.0), 0.5
WORLD = pose(*SHIFT, YAW, 0)
"""The rooms are built along the axes and then put here."""

CABINET, TABLE = box((2, 3), (3.4, 4), (0, 2)), box((4, 5), (1, 1.8), (0.7, 0.75))
CORRIDOR = [
    box((-3, 9), (-1.8, -1.7), (0, 2.6)),
    box((-3, 9), (-1.7, -0.2), (-0.2, 0)),
    box((-3, 9), (-1.7, -0.2), (2.6, 2.8)),
]


def scanned(boxes: list[Box], *places: tuple[float, float]) -> list[PosedSample]:
    built = moved(boxes, YAW, SHIFT)
    taken = []
    for number, (x, y) in enumerate(places):
        at = WORLD @ pose(x, y, yaw=number)
        taken.append(place(sample_scan(scan(built, at, noise=0.003, seed=number)), at))
    return taken


def corners(structure: Structure) -> list[tuple[float, float]]:
    """Of the polygon in the room's own axes, to the centimetre."""
    flat = np.column_stack([structure.polygon, np.zeros(len(structure.polygon))])
    return sorted(
        (round(float(x), 2) + 0.0, round(float(y), 2) + 0.0) for x, y, _ in transformed(flat, inverted(WORLD))
    )


def level(structure: Structure) -> list[tuple[tuple[float, ...], float]]:
    """Normal in the room's own axes and width of each wall."""
    back = inverted(WORLD)
    return [
        (tuple(float(x) + 0.0 for x in np.round(rotated(w.normal[None], back)[0], 2)), round(w.width, 2))
        for w in structure.walls
    ]


RECTANGLE = [(0.0, 0.0), (0.0, 4.0), (6.0, 0.0), (6.0, 4.0)]


def test_pilasters_and_a_curtain_stand_before_the_wall_that_shows_beside_them() -> None:
    pilasters = [box((x, x + 0.3), (0, 0.12), (0, 2.6)) for x in (0.5, 1.8, 3.5, 5.1)]
    curtain = [box((1.9, 4.1), (3.88, 3.9), (0.02, 2.6))]  # 10 cm before the wall y = 4, which goes on at both ends
    structure = find_structure(scanned([*plain_room(), *pilasters, *curtain], (2, 1.7), (4, 2.4)))

    assert corners(structure) == RECTANGLE


def test_beams_across_the_room_are_no_walls_though_something_hides_pieces_of_them() -> None:
    beams = [box((x, x + 0.2), (0, 4), (2.4, 2.6)) for x in (0.9, 2.2, 3.5, 4.8)]
    lamp = box((1.1, 1.2), (1.9, 2.2), (2.3, 2.6))  # on the face of the first beam, whose halves are no lintels either
    structure = find_structure(scanned([*plain_room(), *beams, lamp], (2, 1.7), (4, 2.4)))

    assert corners(structure) == RECTANGLE


def test_walls_under_the_open_sky_may_end_at_different_heights() -> None:
    floor, south, east, north, west = plain_room(ceiling=False)
    low = [Box((*b.centre[:2], z / 2), (*b.size[:2], z), b.yaw) for b, z in ((south, 2.0), (north, 3.2))]
    cabinet = box((2, 3), (3.4, 4), (0, 1.9))
    structure = find_structure(scanned([floor, low[0], east, low[1], west, cabinet], (2, 1.7), (4, 2.4)))

    assert corners(structure) == RECTANGLE
    assert sorted(round(wall.height, 1) for wall in structure.walls) == [2.0, 2.6, 2.6, 3.2]


def test_a_wall_under_a_lowered_ceiling_is_a_wall_and_the_step_overhead_is_none() -> None:
    # Along y = 4 the ceiling is 40 cm lower, 1 m wide: that wall ends at 2.2 m, the others at 2.6 m.
    structure = find_structure(scanned([*plain_room(), box((0, 6), (3, 4), (2.2, 2.6))], (2, 1.5), (4, 2)))

    assert corners(structure) == RECTANGLE
    assert structure.ceiling_height == pytest.approx(2.6, abs=0.001)
    assert sorted(round(wall.height, 2) for wall in structure.walls) == [2.2, 2.6, 2.6, 2.6]


def test_a_turned_and_shifted_room_gets_its_four_walls_to_a_millimetre_and_a_twentieth_of_a_degree() -> None:
    structure = find_structure(scanned(plain_room(), (2, 1.5), (4, 2.5)))

    assert abs(structure.floor_height) < 0.001
    assert structure.ceiling_height == pytest.approx(2.6, abs=0.001)
    assert len(structure.walls) == 4
    back = inverted(WORLD)
    for wall in structure.walls:
        bottom_left, normal = transformed(wall.origin[None], back)[0], rotated(wall.normal[None], back)[0]
        axis = np.round(normal)
        plane = {(1, 0): 0.0, (-1, 0): -6.0, (0, 1): 0.0, (0, -1): -4.0}[(int(axis[0]), int(axis[1]))]
        assert abs(bottom_left @ axis - plane) < 0.001
        assert np.arccos(min(1.0, normal @ axis)) < np.deg2rad(0.05)
        assert wall.width == pytest.approx(6.0 if axis[1] else 4.0, abs=0.002)
        assert wall.height == pytest.approx(2.6, abs=0.002)


def test_walls_run_counter_clockwise_and_u_points_right_for_who_faces_the_wall() -> None:
    structure = find_structure(scanned(plain_room(), (2, 1.5)))

    centre = structure.polygon.mean(axis=0)
    for number, wall in enumerate(structure.walls):
        assert (centre - wall.origin[:2]) @ wall.normal[:2] > 0  # the normal points into the room
        following = structure.walls[(number + 1) % 4]
        right_end = wall.origin + wall.width * wall.u
        before = structure.walls[number - 1]
        assert np.allclose(before.origin, right_end, atol=0.01)  # seen from above the next wall is to the left
        assert np.allclose(following.origin + following.width * following.u, wall.origin, atol=0.01)


def test_cabinet_and_table_are_no_walls() -> None:
    structure = find_structure(scanned([*plain_room(), CABINET, TABLE], (2, 1.5), (4.6, 2.6)))

    assert corners(structure) == RECTANGLE
    assert len(structure.walls) == 4


@pytest.mark.parametrize("swing_deg", [35, 80, 100])
def test_neither_an_open_leaf_nor_the_corridor_beyond_it_is_a_wall(swing_deg: float) -> None:
    a = np.deg2rad(swing_deg)
    leaf = Box((2 + 0.45 * np.cos(a), 0.45 * np.sin(a), 1.03), (0.9, 0.04, 2.04), a)
    room = [*with_doorway(plain_room(), 1, 2.0, 2.9, 2.1), *CORRIDOR, leaf]
    structure = find_structure(scanned(room, (3.2, 2.2), (4.5, 1.6)))

    assert corners(structure) == RECTANGLE
    assert len(structure.walls) == 4


def test_the_line_of_a_leaf_ajar_takes_nothing_of_the_wall_that_it_meets_beside_the_door() -> None:
    # The leaf stands 3 deg open to the corridor, its face 14 cm behind the wall's at the hinge, x = 2.9: the two planes
    # meet at 2.9 + 0.14 / tan(3 deg) = 5.6, and are within 3 cm of each other from there to the corner.
    a = np.deg2rad(3)
    leaf = Box((2.9 - 0.45 * np.cos(a), -0.16 - 0.45 * np.sin(a), 1.03), (0.9, 0.04, 2.04), a)
    room = [*with_doorway(plain_room(), 1, 2.0, 2.9, 2.1), *CORRIDOR, leaf]
    structure = find_structure(scanned(room, (3.2, 2.2), (4.5, 1.6)))

    assert corners(structure) == RECTANGLE
    assert len(structure.walls) == 4


def test_a_doorway_without_a_lintel_does_not_end_the_wall() -> None:
    room = [*with_doorway(plain_room(ceiling=False), 1, 2.0, 2.9, 2.6), *CORRIDOR[:2]]
    structure = find_structure(scanned(room, (3.2, 2.2), (4.5, 1.6)))

    assert corners(structure) == RECTANGLE
    assert len(structure.walls) == 4


def test_without_a_ceiling_the_walls_end_where_they_end() -> None:
    structure = find_structure(scanned([*plain_room(ceiling=False), CABINET], (2, 1.5), (4, 2.4)))

    assert structure.ceiling_height is None
    assert corners(structure) == RECTANGLE
    assert [round(wall.height, 1) for wall in structure.walls] == [2.6] * 4


def test_where_the_fourth_wall_is_missing_the_polygon_is_closed_by_no_wall() -> None:
    room = [piece for number, piece in enumerate(plain_room(ceiling=False)) if number != 2]
    ground = box((-30, 30), (-30, 30), (-0.5, -0.25))
    structure = find_structure(scanned([*room, ground], (2, 1.5), (4, 2.5)))

    assert len(structure.walls) == 3
    assert np.count_nonzero(structure.polygon_walls == -1) == 1
    # the side walls end at x = 6.2; their ends are known to the spacing of the points
    assert np.allclose(corners(structure), [(0, 0), (0, 4), (6.2, 0), (6.2, 4)], atol=0.05)


def l_room() -> list[Box]:
    """6 x 6 m without its upper right quarter."""
    return [
        box((-0.2, 6.2), (-0.2, 6.2), (-0.2, 0)),
        box((-0.2, 6.2), (-0.2, 6.2), (2.6, 2.8)),
        box((-0.2, 6.2), (-0.2, 0), (0, 2.6)),
        box((6, 6.2), (0, 3), (0, 2.6)),
        box((3, 6), (3, 3.2), (0, 2.6)),
        box((3, 3.2), (3, 6), (0, 2.6)),
        box((-0.2, 3.2), (6, 6.2), (0, 2.6)),
        box((-0.2, 0), (0, 6.2), (0, 2.6)),
    ]


def test_an_l_shaped_room_has_six_walls() -> None:
    structure = find_structure(scanned(l_room(), (4.5, 1), (1.5, 4.5)))

    assert corners(structure) == [(0, 0), (0, 6), (3, 3), (3, 6), (6, 0), (6, 3)]
    assert len(structure.walls) == 6 and (structure.polygon_walls >= 0).all()
    points = transformed(np.array([[1.0, 5, 1], [5, 1, 1], [5, 5, 1], [1, 5, 3], [1, 5, -1]]), WORLD)
    assert structure.interior(points).tolist() == [True, True, False, False, False]


def test_the_part_of_an_l_shaped_room_that_is_round_the_corner_is_open_not_wall() -> None:
    structure = find_structure(scanned(l_room(), (4.5, 1)))

    # the wall y = 3 goes from x = 3 to 6 and no further; its end is known to the spacing of the points
    assert dict(level(structure))[(0.0, -1.0, 0.0)] == pytest.approx(3.0, abs=0.05)
    assert np.count_nonzero(structure.polygon_walls == -1) == 1


def test_an_oblique_wall_keeps_its_direction() -> None:
    # a wall at 45 deg cuts the corner (8, 6): its face runs through (7, 5) - 0.1 (sin, cos), x + y = 12 - 0.1414
    room = [*plain_room(8, 6), Box((7, 5, 1.3), (4, 0.2, 2.6), -np.pi / 4)]
    structure = find_structure(scanned(room, (2, 2), (6, 3)))

    assert corners(structure) == [(0, 0), (0, 6), (5.86, 6), (8, 0), (8, 3.86)]
    assert ((-0.71, -0.71, 0.0), 3.03) in level(structure)  # (8 - 5.8586) sqrt 2


def test_a_column_is_a_hole_with_four_walls_of_its_own() -> None:
    room = [*plain_room(8, 6), box((4, 4.4), (3, 3.4), (0, 2.6))]
    structure = find_structure(scanned(room, (2, 2), (6, 4), (2, 5), (6, 1.7)))

    assert len(structure.walls) == 8 and len(structure.holes) == 1
    inside, beside = transformed(np.array([[4.2, 3.2, 1.0], [4.6, 3.2, 1.0]]), WORLD)
    assert structure.interior(np.array([inside, beside])).tolist() == [False, True]


def test_without_a_floor_there_is_no_room() -> None:
    with pytest.raises(MissionError, match="no floor"):
        find_structure(scanned(plain_room()[1:], (2, 1.5)))


def test_without_a_wall_there_is_no_room() -> None:
    with pytest.raises(MissionError, match="no wall"):
        find_structure(scanned([box((-30, 30), (-30, 30), (-0.2, 0)), TABLE], (2, 1.5)))


@pytest.mark.parametrize(
    "piece",
    [
        pytest.param(box((0, 6), (2.8, 3.0), (2.3, 2.6)), id="beam"),
        pytest.param(box((1, 3), (3.65, 4), (1.4, 2.6)), id="hanging cupboard"),
        pytest.param(box((0, 6), (3.92, 4), (2.5, 2.6)), id="moulding"),
    ],
)
def test_what_hangs_from_the_ceiling_is_no_wall(piece: Box) -> None:
    structure = find_structure(scanned([*plain_room(), piece], (2, 1.5), (4.4, 2.2)))

    assert corners(structure) == RECTANGLE


def test_a_leaf_as_high_as_a_roofless_wall_is_no_wall() -> None:
    a = np.deg2rad(20)
    leaf = Box((2 + 0.45 * np.cos(a), -0.02 + 0.45 * np.sin(a), 1.05), (0.9, 0.04, 2.1), a)
    room = [*with_doorway(plain_room(height=2.1, ceiling=False), 1, 2.0, 2.9, 2.1), leaf]
    structure = find_structure(scanned(room, (3.4, 2.3), (4.6, 1.8)))

    assert corners(structure) == RECTANGLE


def test_without_a_scan_that_found_its_place_there_is_no_room() -> None:
    with pytest.raises(MissionError, match="no scan"):
        find_structure([])
