"""The command line of `bench walls`: what it refuses, what it prints and writes, and that backends agree."""

from __future__ import annotations

import csv
import json
import subprocess
import sys
from pathlib import Path

import pytest
from PIL import Image
from rerun.chunk import RrdReader
from small_room import small_room

from mission.__main__ import main
from mission.bench.walls import command
from mission.bench.walls.rooms import BenchRoom
from mission.bench.walls.scanning import ScannedRoom

DRAFT = (
    *("--set", "scanner.pattern=draft", "--set", "camera.width=356"),
    *("--set", "camera.height=536", "--set", "camera.shots=7"),
)


@pytest.fixture
def refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> object:
    """Runs a command line that must be refused: status 2 and one line on standard error. Gives the line."""

    def run(*arguments: str) -> str:
        try:
            status: object = main(["bench", "walls", "--out", str(tmp_path / "out"), *arguments])
        except SystemExit as exit:
            status = exit.code
        assert status == 2
        printed = capsys.readouterr()
        assert printed.out == ""
        assert printed.err.count("\n") == 1
        return printed.err

    return run


def test_help_is_quick_and_shows_real_commands() -> None:
    done = subprocess.run(
        [sys.executable, "-X", "importtime", "-m", "mission", "bench", "walls", "--help"],
        capture_output=True,
        text=True,
        check=True,
    )
    assert "python -m mission bench walls --sweep alpha1" in done.stdout
    assert "numpy" not in done.stderr  # nothing slow is imported for it


def test_an_unknown_category_is_named_with_those_there_are(refused) -> None:
    line = refused("--category", "easy")
    assert "'easy'" in line
    assert "'very complex'" in line


def test_a_sweep_of_an_unknown_parameter_lists_the_known_ones(refused) -> None:
    assert "alpha3" in refused("--sweep", "beta")


def test_an_unknown_parameter_is_refused_before_anything_is_scanned(refused) -> None:
    assert "did you mean 'alpha1'" in refused("--set", "detector.alph1=0.5")


def test_a_backend_that_is_not_installed_names_what_to_install(refused, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "ray.util.joblib", None)
    assert "pip install" in refused("--backend", "ray")


def test_a_folder_that_cannot_be_written_is_refused(refused) -> None:
    assert "/dev/null" in refused("--out", "/dev/null/out")


def bench(out: Path, cache: Path, *arguments: str) -> dict[str, object]:
    """Run the benchmark on the small room; gives result.json."""
    assert main(["bench", "walls", "--out", str(out), "--cache", str(cache), *DRAFT, *arguments]) == 0
    return json.loads((out / "result.json").read_text())


def only_the_small_room(seed: int, categories: object) -> list[BenchRoom]:
    """Stands for the generator."""
    return [small_room()]


@pytest.fixture(scope="module")
def small(scanned: ScannedRoom) -> object:
    """The benchmark consists of the small room, which is in the cache."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(command, "rooms", only_the_small_room)
        yield


@pytest.fixture(scope="module")
def files(small, cache: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What a run on one core wrote."""
    out = tmp_path_factory.mktemp("bench")
    bench(out, cache, "--jobs", "1")
    return out


@pytest.mark.slow
def test_both_doors_of_the_small_room_are_found_and_nothing_else(files: Path) -> None:
    result = json.loads((files / "result.json").read_text())
    assert (result["doors"], result["found"], result["false_positives"]) == (2, 2, 0)
    assert result["angle_max_deg"] < 1.5
    assert set(result["categories"]) == {"simple", "specular"}
    assert result["categories"]["simple"]["doors"] == 1
    assert result["highlights_found"] >= 1
    assert result["peak_bytes"] > 1e8


@pytest.mark.slow
def test_rows_are_the_same_in_csv_and_json(files: Path) -> None:
    with (files / "doors.csv").open() as file:
        rows = list(csv.DictReader(file))
    doors = json.loads((files / "doors.json").read_text())["doors"]
    assert [row["door"] for row in rows] == [door["door"] for door in doors] == ["north_leaf", "east_leaf"]
    assert float(rows[1]["true_angle_deg"]) == doors[1]["true_angle_deg"] == 30.0


@pytest.mark.slow
def test_the_contact_sheet_shows_the_truth_in_blue_and_the_detection_in_red(files: Path) -> None:
    with Image.open(files / "walls_0.png") as sheet:
        colours = {colour for _, colour in sheet.getcolors(maxcolors=2**24)}
    assert {(40, 90, 255), (235, 30, 30)} <= colours


@pytest.mark.slow
def test_the_recording_holds_tables_figures_and_every_wall(files: Path) -> None:
    paths = {str(path) for path in RrdReader(files / "walls.rrd").store().schema().entity_paths()}
    assert {"/tables", "/figures/precision_recall"} <= paths
    for wall in ("simple_1.1", "specular_1.1"):
        assert {f"/walls/{wall}/0/{what}" for what in ("colour", "true", "found", "labels")} <= paths


@pytest.mark.slow
def test_two_dask_workers_give_the_same_as_two_processes_and_as_one(
    files: Path, small, cache: Path, tmp_path: Path
) -> None:
    bench(tmp_path / "dask", cache, "--jobs", "2", "--backend", "dask")
    bench(tmp_path / "loky", cache, "--jobs", "2")
    alone = (files / "doors.csv").read_bytes()
    assert (tmp_path / "dask" / "doors.csv").read_bytes() == alone
    assert (tmp_path / "loky" / "doors.csv").read_bytes() == alone


@pytest.mark.slow
def test_a_run_without_highlight_correction_is_told_apart(small, cache: Path, tmp_path: Path) -> None:
    result = bench(tmp_path, cache, "--ablate", "highlights", "--jobs", "1")
    assert set(result["variants"]) == {"as configured", "without highlights"}  # type: ignore[call-overload]
    assert "Table 5" in (tmp_path / "tables.md").read_text()
