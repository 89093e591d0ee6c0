"""Registration against known poses in a room of boxes."""

from __future__ import annotations

import hashlib
import os
import subprocess
import sys
from functools import cache

import numpy as np
import pytest

from mission.registration import Registrar
from mission.rigid import Pose, angle_between, from_rotation_vector
from mission.samples import ScanSample, sample_scan
from tests.mission.boxroom import Box, box, moved, plain_room, pose, scan

CABINET, TABLE = box((2, 3), (3.4, 4), (0, 2)), box((4, 5), (1, 1.8), (0.7, 0.75))
SHIFT, YAW = (10.0, -7.0), 0.5
HERE, THERE = (pose(*SHIFT, YAW, 0) @ p for p in (pose(2, 1.5, 0.2), pose(4, 2.2, 2.0)))


@cache
def scanned(from_there: bool = False, furniture: tuple[Box, ...] = (CABINET, TABLE)) -> ScanSample:
    room = moved([*plain_room(), *furniture], YAW, SHIFT)
    return sample_scan(scan(room, THERE if from_there else HERE, noise=0.003, seed=int(from_there)))


def off(place: Pose, shift: tuple[float, float, float], turn_deg: tuple[float, float, float]) -> Pose:
    guess = place.copy()
    guess[:3, :3] = from_rotation_vector(np.deg2rad(turn_deg), np.zeros(3))[:3, :3] @ place[:3, :3]
    guess[:3, 3] += shift
    return guess


@pytest.fixture
def registrar() -> Registrar:
    started = Registrar()
    started.register(scanned(), HERE)
    return started


def error(found: Pose, true: Pose) -> tuple[float, float]:
    return float(np.linalg.norm((found - true)[:3, 3])), float(np.rad2deg(angle_between(found, true)))


def test_the_first_scan_starts_the_map_where_it_was_guessed() -> None:
    first = Registrar().register(scanned(), HERE)

    assert first.accepted and first.fitness == 1 and first.rmse == 0
    assert np.array_equal(first.world_from_scanner, HERE)


@pytest.mark.parametrize("turn", [-5.0, 5.0])
def test_odometry_30_cm_and_5_deg_off_is_corrected_to_3_mm_and_3_hundredths_of_a_degree(
    registrar: Registrar, turn: float
) -> None:
    found = registrar.register(scanned(True), off(THERE, (0.25, -0.16, 0.01), (0.4, -0.3, turn)))

    metres, degrees = error(found.world_from_scanner, THERE)
    assert found.accepted
    assert metres < 0.003 and degrees < 0.03
    assert found.rmse < 0.003  # noise 3 mm, smoothed over some 25 beams


def test_a_moved_cabinet_does_not_pull_the_pose(registrar: Registrar) -> None:
    moved_by_8_cm = box((2.08, 3.08), (3.32, 3.92), (0, 2))
    found = registrar.register(scanned(True, (moved_by_8_cm, TABLE)), off(THERE, (0.05, 0.05, 0), (0, 0, 2)))

    assert found.accepted
    assert error(found.world_from_scanner, THERE)[0] < 0.003


def test_a_scan_of_another_room_is_rejected_and_leaves_the_map_alone(registrar: Registrar) -> None:
    elsewhere = sample_scan(scan(moved(plain_room(9, 7, 3.4), YAW + 0.4, SHIFT), pose(*SHIFT) @ pose(4, 4), seed=5))
    rejected = registrar.register(elsewhere, HERE)
    found = registrar.register(scanned(True), off(THERE, (0.05, 0.05, 0), (0, 0, 2)))

    assert not rejected.accepted and rejected.reason
    assert np.array_equal(rejected.world_from_scanner, HERE)
    assert found.accepted and error(found.world_from_scanner, THERE)[0] < 0.003


def test_between_two_endless_walls_the_way_along_them_is_free_and_the_scan_rejected() -> None:
    corridor = [
        box((-40, 40), (-0.2, 0), (0, 2.6)),
        box((-40, 40), (2, 2.2), (0, 2.6)),
        box((-40, 40), (-0.2, 2.2), (-0.2, 0)),
        box((-40, 40), (-0.2, 2.2), (2.6, 2.8)),
    ]
    registrar = Registrar()
    registrar.register(sample_scan(scan(corridor, pose(0, 1), noise=0.003)), pose(0, 1))
    found = registrar.register(sample_scan(scan(corridor, pose(1, 1), noise=0.003, seed=1)), pose(1.1, 1.05))

    assert not found.accepted
    assert "direction free" in found.reason


@pytest.mark.parametrize("along", [-0.15, 0.03, 0.08])
def test_the_few_points_at_the_ends_of_a_corridor_hold_the_way_along_it(along: float) -> None:
    # 12 x 1.8 m: its long walls, floor and ceiling fit from the start and say nothing about x; the ends do.
    corridor = plain_room(12.0, 1.8)
    registrar = Registrar()
    registrar.register(sample_scan(scan(corridor, pose(3, 0.9), noise=0.003)), pose(3, 0.9))
    found = registrar.register(
        sample_scan(scan(corridor, pose(8, 0.8, 1.0), noise=0.003, seed=1)), pose(8 + along, 0.8, 1.0)
    )

    assert found.accepted, found.reason
    assert error(found.world_from_scanner, pose(8, 0.8, 1.0))[0] < 0.003


@pytest.mark.slow
def test_one_core_and_two_give_the_same_bits() -> None:
    program = (
        "from tests.mission.test_registration import *; r = Registrar(); r.register(scanned(), HERE);"
        "print(hashlib.sha256(r.register(scanned(True), off(THERE, (.1, 0, 0), (0, 0, 2)))"
        ".world_from_scanner.tobytes()).hexdigest())"
    )

    def digest(threads: str) -> str:
        settings = {name: threads for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")}
        run = [sys.executable, "-c", program]
        return subprocess.run(run, env={**os.environ, **settings}, capture_output=True, text=True, check=True).stdout

    alone = digest("1")
    assert len(alone.strip()) == len(hashlib.sha256().hexdigest())
    assert alone == digest("2")
