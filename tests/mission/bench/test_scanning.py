"""Scanned benchmark rooms: the truth they are compared with, their walls, and their way through the cache."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from small_room import ANGLE, small_room

from detector.parameters import DetectorParameters
from mission.bench.walls import cache as cache_module
from mission.bench.walls.cache import cached_scan, fingerprint, read
from mission.bench.walls.judging import is_on_face
from mission.bench.walls.rooms import BenchDoor, BenchRoom
from mission.bench.walls.scanning import ODOMETRY_ERROR, ScannedRoom, judged_doors, scanner_mount
from mission.bench.walls.sources import imported_files
from mission.config import MissionConfig, read_config
from sim.errors import SimError


def with_door(door: BenchDoor) -> BenchRoom:
    """The small room with another door to judge in its first wall."""
    room = small_room()
    return replace(room, walls=(replace(room.walls[0], doors=(door,)), *room.walls[1:]))


def test_the_truth_of_a_door_is_its_joint() -> None:
    truths = judged_doors(small_room())
    assert truths[frozenset({"north_leaf"})].leaves[0].opening_angle == pytest.approx(0, abs=1e-9)
    assert truths[frozenset({"east_leaf"})].leaves[0].opening_angle == pytest.approx(ANGLE)


def test_a_door_that_is_none_is_named_with_those_that_are() -> None:
    with pytest.raises(SimError, match="'cupboard'.*north_leaf"):
        judged_doors(with_door(BenchDoor(("cupboard",), (0.0,), 0.0, 0.0)))


def test_a_door_that_stands_elsewhere_than_the_generator_says_is_refused() -> None:
    with pytest.raises(SimError, match="stands at 0.0000, not at 0.5000"):
        judged_doors(with_door(BenchDoor(("north_leaf",), (0.5,), 0.0, 0.0)))


def test_the_beams_begin_on_the_mast() -> None:
    # mopad.xml: the scanner stands at z = 0.95 m on the base, its beams begin 0.2 m above
    assert scanner_mount()[:3, 3] == pytest.approx([0, 0, 1.15], abs=1e-9)


@pytest.mark.slow  # a room is scanned
def test_every_judged_wall_is_found(scanned: ScannedRoom) -> None:
    for wall in small_room().walls:
        (found,) = [w for w in scanned.walls if is_on_face(w, wall)]
        assert found.width == pytest.approx(np.linalg.norm(np.subtract(wall.end, wall.origin)), abs=0.02)
        assert np.allclose(found.origin, wall.origin, atol=0.02)


@pytest.mark.slow  # a room is scanned
def test_the_wall_opposite_is_on_no_judged_face(scanned: ScannedRoom) -> None:
    north = small_room().walls[0]
    turned = replace(north, origin=north.end, end=north.origin)  # the same plane, seen from outside
    assert not any(is_on_face(wall, turned) for wall in scanned.walls)


@pytest.mark.slow  # a room is scanned
def test_registered_poses_are_better_than_the_odometry(scanned: ScannedRoom) -> None:
    first, second = scanned.pose_errors
    assert first == 0  # the start pose is known
    assert 0 < second < ODOMETRY_ERROR[0] / 10


@pytest.mark.slow  # a room is scanned
def test_gloss_is_seen_on_the_glossy_wall_only(scanned: ScannedRoom) -> None:
    scan = scanned.scans[0]
    points = scan.view().points_in_world[scan.gloss > 12]
    assert len(points) > 50
    assert np.all(points[:, 0] > 4.9)


@pytest.mark.slow  # a room is scanned
def test_a_room_comes_out_of_the_cache_as_it_went_in(
    scanned: ScannedRoom, draft: MissionConfig, cache: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cache_module, "scan_room", None)  # whoever scans now fails
    again = cached_scan(small_room(), draft, seed=0, folder=cache)
    for a, b in zip(scanned.room().views, again.room().views, strict=True):
        assert np.array_equal(a.points_in_world, b.points_in_world)
        assert np.array_equal(a.colours, b.colours)
        assert np.array_equal(a.coloured, b.coloured)
        assert np.array_equal(a.camera_in_world, b.camera_in_world)
    for a, b in zip(scanned.walls, again.walls, strict=True):
        assert np.array_equal(a.origin, b.origin)
        assert np.array_equal(a.voxel_labels, b.voxel_labels)
        assert (a.width, a.height, a.voxel_size) == (b.width, b.height, b.voxel_size)
    assert (again.floor_height, again.ceiling_height) == (scanned.floor_height, scanned.ceiling_height)


def test_what_a_scan_depends_on_changes_its_fingerprint_and_nothing_else_does(draft: MissionConfig) -> None:
    room = small_room()
    usual = fingerprint(room, draft, seed=0)
    other_detector = draft.model_copy(update={"detector": DetectorParameters(alpha1=0.4)})
    assert fingerprint(room, other_detector, seed=0) == usual
    assert fingerprint(room, read_config(None, []), seed=0) != usual
    assert fingerprint(room, draft, seed=1) != usual
    assert fingerprint(replace(room, xml=room.xml.replace("0.72", "0.71")), draft, seed=0) != usual
    assert fingerprint(replace(room, assets={"tiles.png": b"1"}), draft, seed=0) != usual
    assert fingerprint(replace(room, scan_places=room.scan_places[:1]), draft, seed=0) != usual


def test_scans_depend_on_the_simulator_and_the_mission_but_not_on_the_detector() -> None:
    files = imported_files("mission.bench.walls.scanning")
    assert {"sim.shading", "sim.render.renderer", "mission.wall_finder", "mission.colouring"} <= set(files)
    assert {name for name in files if name.startswith("detector")} == {"detector", "detector.room"}


@pytest.mark.slow  # a room is scanned
def test_a_broken_file_in_the_cache_is_replaced(
    scanned: ScannedRoom, draft: MissionConfig, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cache_module, "scan_room", lambda *_, **__: scanned)
    path = tmp_path / f"{fingerprint(small_room(), draft, seed=0)}.npz"
    path.write_bytes(b"no room")
    cached_scan(small_room(), draft, seed=0, folder=tmp_path)
    assert len(read(path).scans) == 2


@pytest.mark.slow  # a room is scanned
def test_the_rooms_unused_for_longest_make_room(
    scanned: ScannedRoom, draft: MissionConfig, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cache_module, "scan_room", lambda *_, **__: scanned)
    old, recent = tmp_path / "old.npz", tmp_path / "recent.npz"
    for path, seconds in ((old, 1_000), (recent, 2_000)):
        path.write_bytes(bytes(1_000_000))
        os.utime(path, (seconds, seconds))
    cached_scan(small_room(), draft, seed=0, folder=tmp_path)
    size = sum(path.stat().st_size for path in tmp_path.glob("*.npz")) - 2_000_000
    monkeypatch.setattr(cache_module, "CAPACITY", 2 * size + 1_000_000)  # the next room fits beside all but `old`
    cached_scan(small_room(), draft, seed=1, folder=tmp_path)
    assert recent.exists()
    assert not old.exists()
