"""The building benchmark: which faces stand beside which rows of the paper, and what is written."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from mission.__main__ import main
from mission.bench.building.command import write_files
from mission.bench.building.faces import Face, beside_paper, door_faces
from mission.bench.building.paper import MEAN, TABLE_3
from mission.bench.building.tables import table_3
from mission.config import MissionConfig
from mission.report import Report
from tests.mission import recording_room as made
from tests.mission.recording_story import story


@pytest.fixture
def report() -> Report:
    """Of a mission in one room with three doors: one 31 deg open and one closed are found, a slide is missed."""
    told = Report()
    for event in story():
        told.handle(event)
    return told


def test_the_paper_s_means_are_those_of_its_rows() -> None:
    for name, mean in MEAN.items():
        assert np.mean([getattr(row, name) for row in TABLE_3]) == pytest.approx(mean, abs=6e-4), name


def test_each_face_stands_beside_a_row_of_the_paper_whose_door_stands_like_it() -> None:
    faces = [Face(1, "a", 3.0, None), Face(1, "b", 35.0, None), Face(2, "a", 3.0, None), Face(2, "c", 20.0, None)]
    pairs = beside_paper(faces)
    named = {(row.name if row else None): (face.room, face.door) if face else None for row, face in pairs}
    assert named["#1"] == (1, "b")
    assert named["#2"] == (1, "a") and named["#5"] == (2, "a"), "one row for each side of the door"
    assert named[None] == (2, "c"), "the paper has none at 20 deg"
    assert sum(face is None for face in named.values()) == 6, "rooms that were not visited"


def test_the_faces_of_a_room_are_the_doors_that_it_found_and_those_that_it_missed(report: Report) -> None:
    faces = [(face.room, face.door, face.found is not None) for face in door_faces(report)]
    assert faces == [(1, "hall/door 1", True), (1, "store", True), (1, "lift", False)]
    assert door_faces(report)[0].true_angle_deg == pytest.approx(np.degrees(made.JOINT))


def test_the_table_has_all_nine_rows_of_the_paper_and_ours_beside_those_that_we_have(report: Report) -> None:
    rows = {row[8]: row for row in table_3(report).rows}
    assert rows["#1"][0] == "not visited"
    assert rows["#1"][9:] == ("34.96", "0.993", "0.989", "0.035", "0.017")
    assert rows["-"][:4] == ("hall/door 1", "1", "31.00", "30.00"), "the paper has none at 31 deg"
    assert rows["#4"][:4] == ("store", "1", "0.00", "0.00")
    assert rows["#6"][:4] == ("lift", "1", "0.00", "missed")
    assert rows["found"][4] == "2 of 9"


def test_result_json_is_flat_and_counts_faces_of_rooms_that_were_not_visited(report: Report, tmp_path: Path) -> None:
    write_files(tmp_path, report, seed=3, config=MissionConfig())
    result = json.loads((tmp_path / "result.json").read_text())
    assert (result["doors"], result["found"], result["false_positives"]) == (9, 2, 0)
    keys = {"precision", "recall", "e_abs", "e_rel", "angle_mae_deg", "angle_max_deg"}
    assert keys <= result.keys()
    assert "| hall/door 1 |" in (tmp_path / "tables.md").read_text()


def test_a_parameter_that_does_not_exist_is_refused_in_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["bench", "building", "--set", "scanner.nonsense=1"]) == 2
    assert capsys.readouterr().err.count("\n") == 1
