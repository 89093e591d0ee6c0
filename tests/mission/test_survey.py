"""What a scan from another place would add to what was seen."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from mission.survey import Survey, SurveyParameters
from sim.scan import ScannerParameters
from tests.mission.voxel_room import OCCLUDED, OPENING, ROOM, SCANNER, Voxels, room_voxels


def survey_of(voxels: Voxels, scanners: list[tuple[float, float]]) -> Survey:
    return Survey(
        voxels,
        np.empty((0, 3)),
        np.array([(x, y, SCANNER) for x, y in scanners]),
        floor_height=0.0,
        room=ROOM,
        scanner=ScannerParameters(),
        parameters=SurveyParameters(),
    )


def test_what_a_scan_failed_to_see_is_not_expected_again_from_the_same_direction() -> None:
    # The patch was in full view of the first scan and yet stayed occluded: something unknown stands before it.
    voxels = room_voxels().labelled(OCCLUDED, (5.99, 6.01), (2.0, 3.0), (0.6, 2.0))
    survey = survey_of(voxels, [(2.0, 2.5)])
    assert survey.preview(np.array([2.2, 2.6, SCANNER])).gain == 0.0
    # At (4, 4.6) the direction differs by some 46 deg: 5 x 7 cells of 0.04 m2
    assert survey.preview(np.array([4.0, 4.6, SCANNER])).gain == pytest.approx(1.4)


def test_walls_seen_only_obliquely_are_worth_a_better_view() -> None:
    # From (1.5, 0.6) the wall y = 0 beyond x = 2.8 is seen at more than 65 deg (tan 65 = 2.14).
    survey = survey_of(room_voxels(), [(1.5, 0.6)])
    assert survey.preview(np.array([1.5, 0.6, SCANNER])).quality == 0.0
    assert survey.preview(np.array([4.0, 2.5, SCANNER])).quality > 3.0


def test_a_doorway_wants_to_be_seen_from_both_sides() -> None:
    # A doorway of 0.8 x 2.0 m = 1.6 m2 in the wall y = 0, whose normal is +y: anticlockwise of it lies -x.
    doorway = room_voxels().labelled(OPENING, (2.6, 3.4), (-0.01, 0.01), (0.0, 2.0))
    left, ahead, right = (np.array([x, 2.2, SCANNER]) for x in (1.2, 3.0, 4.8))
    survey = survey_of(doorway, [(1.2, 2.2)])
    assert survey.preview(left).doorway == 0.0
    assert survey.preview(ahead).doorway == 0.0  # within 20 deg of the normal is neither side
    assert survey.preview(right).doorway == pytest.approx(1.6)
    assert survey_of(doorway, [(1.2, 2.2), (4.8, 2.2)]).preview(right).doorway == 0.0
    # A window is no doorway.
    window = room_voxels().labelled(OPENING, (2.6, 3.4), (-0.01, 0.01), (0.9, 2.0))
    assert survey_of(window, [(1.2, 2.2)]).preview(right).doorway == 0.0


def test_a_turned_and_shifted_room_is_worth_the_same() -> None:
    voxels = room_voxels().labelled(OCCLUDED, (5.99, 6.01), (2.0, 4.4), (0.0, 2.6))
    yaw, shift = np.radians(30), np.array([100.0, -7.0, -3.0])
    turn = np.array([[np.cos(yaw), -np.sin(yaw), 0], [np.sin(yaw), np.cos(yaw), 0], [0, 0, 1]])
    turned = replace(voxels, cells_in_world=voxels.cells_in_world @ turn.T + shift, normals=voxels.normals @ turn.T)
    here, there = np.array([[1.2, 0.8, SCANNER]]), np.array([3.5, 3.1, SCANNER])
    before = Survey(
        voxels,
        np.empty((0, 3)),
        here,
        floor_height=0.0,
        room=ROOM,
        scanner=ScannerParameters(),
        parameters=SurveyParameters(),
    )
    after = Survey(
        turned,
        np.empty((0, 3)),
        here @ turn.T + shift,
        floor_height=-3.0,
        room=ROOM @ turn[:2, :2].T + shift[:2],
        scanner=ScannerParameters(),
        parameters=SurveyParameters(),
    )
    expected, got = before.preview(there), after.preview(turn @ there + shift)
    assert got.gain == pytest.approx(expected.gain, abs=0.05) and got.gain > 3.0
    assert got.quality == pytest.approx(expected.quality, abs=0.1)
    assert got.overlap == pytest.approx(expected.overlap, abs=0.01)
