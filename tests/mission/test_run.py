"""How a mission's end, good or bad, becomes files and an exit status."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from rich.console import Console

import mission.recording.mcap_sink
from detector.metrics import Overlap
from mission import run
from mission.errors import MissionError
from mission.events import Event, MissionFinished, Remarked
from mission.progress import TerminalProgress
from mission.recording.cost import recording_cost
from mission.report import Report, RoomReport
from mission.stopwatch import Stopwatch


class Told:
    """A mission that says two things, and then breaks if it is told to."""

    def __init__(self, breaks_with: BaseException | None = None) -> None:
        self._breaks_with = breaks_with

    def run(self) -> Iterator[Event]:
        yield Remarked(step=0, time=0, level="info", text="hello")
        if self._breaks_with:
            raise self._breaks_with
        yield self.finished("completed", "all said")

    def finished(self, outcome: Any, reason: str) -> MissionFinished:
        return MissionFinished(step=1, time=1, outcome=outcome, reason=reason)


def carried_out(told: Told, folder: Path) -> tuple[int, dict[str, Any]]:
    """Exit status and summary."""
    progress = TerminalProgress(Console(quiet=True))
    _, status = run.carry_out(told, folder, progress=progress, stopwatch=Stopwatch(), start=0.0)  # type: ignore[arg-type]
    assert json.loads((folder / "doors.json").read_text())["schema"] == 1
    return status, json.loads((folder / "summary.json").read_text())


@pytest.mark.parametrize(
    ("breaks_with", "status", "outcome"),
    [
        (None, 0, "completed"),
        (MissionError("no floor"), 3, "failed"),
        (ZeroDivisionError("a defect"), 3, "failed"),
        (KeyboardInterrupt(), 130, "interrupted"),
    ],
)
def test_however_a_mission_ends_its_files_say_so(
    tmp_path: Path, breaks_with: BaseException | None, status: int, outcome: str
) -> None:
    got, summary = carried_out(Told(breaks_with), tmp_path)
    assert (got, summary["outcome"]) == (status, outcome)
    assert (tmp_path / "mission.rrd").stat().st_size > 0
    assert (tmp_path / "mission.mcap").read_bytes().endswith(b"\x89MCAP0\r\n")  # magic at the end: it was closed


def test_the_summary_tells_what_recording_cost(tmp_path: Path) -> None:
    _, summary = carried_out(Told(), tmp_path)
    assert summary["recording"].keys() == {"mcap_bytes_per_scan", "rrd_bytes_per_scan", "logging_share"}
    (tmp_path / "mission.rrd").write_bytes(bytes(900))
    (tmp_path / "mission.mcap").unlink()
    cost = recording_cost(tmp_path, scans=3, seconds=2.0, wall_clock=50.0)
    assert cost == {"mcap_bytes_per_scan": 0, "rrd_bytes_per_scan": 300, "logging_share": 0.04}


def test_a_full_disk_ends_the_mission_but_not_the_other_files(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def full(self: object, event: Event) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(mission.recording.mcap_sink.McapSink, "handle", full)
    status, summary = carried_out(Told(), tmp_path)
    assert (status, summary["outcome"]) == (3, "failed")
    said = capsys.readouterr().err
    assert "No space left" in said
    assert "Traceback" not in said


def report(found: int, missed: int, false_positives: int) -> Report:
    """A report of doors that were found with recall 1 and precision 1."""
    door = SimpleNamespace(overlap=Overlap(1.0, 0.0, 0.0), angle_error=0.0)
    nothing = SimpleNamespace(overlap=None, angle_error=None)
    room = RoomReport(1, doors=(door,) * found + (nothing,) * false_positives, missed=("lost",) * missed)  # type: ignore[arg-type]
    return Report(rooms={1: room})


@pytest.mark.parametrize(
    ("made", "bars", "status"),
    [
        (report(3, 0, 0), {"recall": 0.97, "precision": 0.97, "found": 1.0}, 0),
        (report(0, 3, 0), {"recall": 0.97}, 1),  # nothing found is recall 0, not "no recall"
        (report(1, 2, 0), {"recall": 0.5}, 1),  # 1/3
        (report(1, 0, 1), {"precision": 0.6}, 1),  # 1/2
        (report(2, 1, 0), {"found": 0.7}, 1),  # 2/3
        (report(0, 0, 0), {"recall": 0.97, "found": 1.0}, 0),  # a room without doors is a success
    ],
)
def test_the_bar_counts_missed_doors_and_false_positives(made: Report, bars: dict[str, float], status: int) -> None:
    assert run._judge(made.metrics(), bars) == status


def test_each_run_gets_a_folder_of_its_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    folders = [run.make_folder(None, scene_name="some/room.xml") for _ in range(2)]
    assert [str(folder) for folder in folders] == ["runs/room-1", "runs/room-2"]
