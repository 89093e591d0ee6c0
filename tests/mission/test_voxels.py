"""Voxel labels of rooms that one can label in one's head."""

from __future__ import annotations

import numpy as np
import pytest

from detector.room import VoxelLabel
from mission.rigid import inverted, rotated
from mission.samples import PosedSample, place, sample_scan
from mission.structure import Structure, find_structure
from mission.voxels import CEILING, FLOOR, VoxelModel, label_voxels, room_from
from tests.mission.boxroom import Box, box, moved, plain_room, pose, scan, with_doorway

SHIFT, YAW = (10.0, -7.0), 0.5
WORLD = pose(*SHIFT, YAW, 0)
OCCUPIED, OCCLUDED, OPENING = VoxelLabel.OCCUPIED, VoxelLabel.OCCLUDED, VoxelLabel.OPENING

BEHIND_THE_DOOR = box((-3, 9), (-4, -0.2), (-0.2, 0))
"""Floor, and nothing else."""


def modelled(boxes: list[Box], *places: tuple[float, float]) -> tuple[Structure, VoxelModel, list[PosedSample]]:
    built = moved(boxes, YAW, SHIFT)
    samples = []
    for number, (x, y) in enumerate(places):
        at = WORLD @ pose(x, y, yaw=number)
        samples.append(place(sample_scan(scan(built, at, noise=0.003, seed=number)), at))
    structure = find_structure(samples)
    return structure, label_voxels(structure, samples), samples


def labels_of(model: tuple[Structure, VoxelModel, list[PosedSample]], normal: tuple[int, int]) -> np.ndarray:
    """Labels of the wall that faces a direction of the room's own axes."""
    structure, voxels, _ = model
    facing = [rotated(wall.normal[None], inverted(WORLD))[0][:2] @ np.array(normal) for wall in structure.walls]
    return voxels.walls[int(np.argmax(facing))]


def unseen_floor(voxels: VoxelModel) -> float:
    """Share of the floor's area that is Occluded."""
    floor = voxels.surfaces == FLOOR
    return float(voxels.areas[floor & (voxels.labels == OCCLUDED)].sum() / voxels.areas[floor].sum())


def doorway() -> list[Box]:
    """The wall y = 0 (left end at x = 6, u = 6 - x) has a doorway from x = 2.1 to 2.9, 2.1 m high."""
    return with_doorway(plain_room(), 1, 2.1, 2.9, 2.1)


def test_a_closed_empty_room_is_occupied_all_round() -> None:
    model = modelled(plain_room(), (2, 1.8), (4, 2.2))
    voxels = model[1]

    assert labels_of(model, (0, 1)).shape == (13, 30)  # 2.6 and 6.0 m in voxels of 0.2 m
    assert labels_of(model, (1, 0)).shape == (13, 20)
    assert all((labels == OCCUPIED).all() for labels in voxels.walls)
    assert voxels.coverage == 1
    assert len(voxels.clutter) == 0


@pytest.mark.parametrize("places", [((2.5, 2.4),), ((2.5, 2.4), (4.2, 2.6))], ids=["one scan", "two scans"])
def test_a_doorway_into_the_void_is_opening_and_the_wall_round_it_occupied(
    places: tuple[tuple[float, float], ...],
) -> None:
    labels = labels_of(modelled([*doorway(), BEHIND_THE_DOOR], *places), (0, 1))

    # u from 3.1 to 3.9: columns 16 to 18 are clear of the jambs; v up to 2.1: row 3 spans 1.8 to 2.0; in the last row
    # the beams end on the floor just behind the wall
    assert (labels[3:12, 16:19] == OPENING).all()
    assert (labels[:, :15] == OCCUPIED).all() and (labels[:, 20:] == OCCUPIED).all()
    assert (labels[:2] == OCCUPIED).all()


def test_a_closed_leaf_recessed_by_10_cm_is_occupied() -> None:
    leaf = box((2.1, 2.9), (-0.14, -0.10), (0.01, 2.1))
    labels = labels_of(modelled([*doorway(), BEHIND_THE_DOOR, leaf], (2.5, 2.4)), (0, 1))

    assert (labels[3:12, 15:20] == OCCUPIED).all()


def test_what_a_cabinet_hides_is_occluded_until_a_scan_sees_it() -> None:
    # A cabinet 1.0 m wide and 1.6 m high stands 1 m in front of the wall y = 4, from x = 2.5 to 3.5.
    room = [*plain_room(), box((2.5, 3.5), (2.6, 3.0), (0, 1.6))]
    before = labels_of(modelled(room, (3, 1)), (0, -1))
    after = labels_of(modelled(room, (3, 1), (0.8, 3.2), (5.2, 3.2)), (0, -1))

    # from (3, 1) the wall is hidden at least over the cabinet's own width, x = 2.5 to 3.5, up to 1.6 m: rows from 5
    assert (before[6:, 13:17] == OCCLUDED).all()
    assert (after[6:12, 13:17] == OCCUPIED).all()


def test_the_far_end_of_a_corridor_s_walls_is_occluded_until_a_scan_looks_at_it_less_flatly() -> None:
    # 12 x 1.8 m: a scan at x = 2, 0.9 m from both walls, meets them at 78 deg at x = 2 + 0.9 tan 78 deg = 6.2.
    corridor = plain_room(12.0, 1.8)
    first = labels_of(modelled(corridor, (2, 0.9)), (0, -1))
    both = labels_of(modelled(corridor, (2, 0.9), (8, 0.9)), (0, -1))

    # the wall y = 1.8 starts at x = 0: columns from 31 lie beyond 6.2 m, though some beams end there; none is Opening
    assert (first[:, 31:] == OCCLUDED).all() and (first[5:, 17:29] == OCCUPIED).all()
    assert (both[5:, 47:] == OCCUPIED).all()  # 1.2 m from x = 8 nothing is nearer than the least range


def test_what_stands_too_near_to_the_scanner_to_return_makes_no_opening() -> None:
    # A board 0.8 m away, within the minimum range of 1.5 m: the beams towards the wall behind return nothing.
    room = [*plain_room(), box((1, 1.2), (1.5, 2.9), (0, 1.9))]
    for places in [((2, 2.2),), ((2, 2.2), (4, 2.2))]:
        labels = labels_of(modelled(room, *places), (1, 0))
        assert not (labels == OPENING).any()
        assert (labels[5:, 7:14] == OCCLUDED).all()  # behind the board


def test_the_last_column_may_stick_out_but_counts_only_what_is_wall() -> None:
    structure, voxels, _ = modelled(plain_room(width=6.1), (2, 1.8), (4, 2.2))

    for number, wall in enumerate(structure.walls):
        assert voxels.walls[number].shape[1] == (31 if wall.width > 5 else 20)
        area = voxels.areas[voxels.surfaces == number].sum()
        assert area == pytest.approx(wall.width * wall.height, rel=1e-3)


def test_the_table_of_structural_voxels_lies_on_the_surfaces_and_covers_them_once() -> None:
    structure, voxels, _ = modelled(plain_room(), (2, 1.8), (4, 2.2))

    for number, wall in enumerate(structure.walls):
        mine = voxels.surfaces == number
        depth = (voxels.cells_in_world[mine] - wall.origin) @ wall.normal
        assert np.abs(depth).max() < 1e-9
        assert np.allclose(voxels.normals[mine], wall.normal)
        assert (voxels.labels[mine] == voxels.walls[number].ravel()).all()
        first = voxels.cells_in_world[mine][0]  # top left: 10 cm from the left end and from the top
        assert np.allclose(first, wall.origin + 0.1 * wall.u + (wall.height - 0.1) * wall.v)
    for surface, height in ((FLOOR, 0.0), (CEILING, 2.6)):
        mine = voxels.surfaces == surface
        assert np.allclose(voxels.cells_in_world[mine, 2], height, atol=0.001)
        assert voxels.areas[mine].sum() == pytest.approx(24, rel=0.03)
        assert structure.interior(voxels.cells_in_world[mine, :2]).all()


def test_the_blind_disc_under_the_scanner_is_occluded_until_another_scan_sees_it() -> None:
    # 1.2 m above the floor and no lower than -40 deg: a disc of radius 1.43 m. A cell with any point is Occupied, so
    # the cells lose about half a cell of it: pi 1.33^2 = 5.6 m2 of the 24 m2
    _, one, _ = modelled(plain_room(), (3, 2))
    _, two, _ = modelled(plain_room(), (3, 2), (1, 2), (5, 2))

    assert unseen_floor(one) == pytest.approx(5.6 / 24, abs=0.015)
    assert unseen_floor(two) < 0.03


def test_points_of_furniture_are_clutter_and_those_of_walls_are_not() -> None:
    structure, voxels, _ = modelled([*plain_room(), box((4, 5), (1, 1.8), (0.6, 0.8))], (2, 2.6))

    assert len(voxels.clutter) > 10
    x, y, z = rotated(voxels.clutter - np.append(SHIFT, 0), inverted(WORLD)).T
    assert (x > 3.8).all() and (x < 5.2).all() and (y > 0.8).all() and (y < 2.0).all()
    assert (z > 0.49).all() and (z < 0.91).all()  # 0.6 and 0.8 m are borders of voxels
    assert np.allclose(voxels.clutter / 0.2 % 1, 0.5)  # a grid along the world's axes


def test_the_detector_gets_every_wall_with_its_labels() -> None:
    structure, voxels, _ = modelled([*doorway(), BEHIND_THE_DOOR], (2.5, 2.4))
    room = room_from(structure, voxels, [])

    assert len(room.walls) == 4
    assert room.ceiling_height == structure.ceiling_height
    for wall, rectangle, labels in zip(room.walls, structure.walls, voxels.walls, strict=True):
        assert np.allclose(wall.normal, rectangle.normal) and wall.voxel_labels is labels
