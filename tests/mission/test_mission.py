"""Whole missions: small ones on the draft pattern."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from mcap.reader import make_reader

import mission.surveyor
from mission.__main__ import main
from mission.driving import Drive, drive
from mission.surveyor import NO_ARRIVAL

pytestmark = pytest.mark.slow

DRAFT = ("--set", "scanner.pattern=draft")

DOORLESS = """
<mujoco>
  <worldbody>
    <geom type="plane" size="0 0 1" rgba="0.6 0.5 0.4 1"/>
    <geom type="box" pos="0 2.5 1.3" size="3 0.1 1.3"/>
    <geom type="box" pos="0 -2.5 1.3" size="3 0.1 1.3"/>
    <geom type="box" pos="3 0 1.3" size="0.1 2.6 1.3"/>
  </worldbody>
</mujoco>
"""


@pytest.fixture(scope="module")
def furnished(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The output folder of a draft mission in room.xml."""
    out = tmp_path_factory.mktemp("furnished") / "out"
    assert main(["run", "room.xml", *DRAFT, "--max-scans", "3", "--quiet", "--out", str(out)]) == 0
    return out


def test_the_doors_of_the_furnished_room_are_found_and_nothing_else(furnished: Path) -> None:
    (room,) = json.loads((furnished / "doors.json").read_text())["rooms"]
    found = {door["truth"]["door"]: door for door in room["doors"]}
    assert set(found) == {"study_door", "hall_door", "store_door"}
    for door in found.values():
        truth = door["truth"]
        assert abs(truth["angle_error_deg"]) < 1.5
        assert min(truth["precision"], truth["recall"]) > 0.95  # at 0.2 deg a pixel of 5 mm is often empty


def test_the_summary_tells_time_memory_versions_and_configuration(furnished: Path) -> None:
    summary = json.loads((furnished / "summary.json").read_text())
    assert summary["outcome"] == "completed"
    assert set(summary["stage_seconds"]) >= {"scan", "photograph", "register", "plan", "drive", "detect", "recording"}
    assert 1e8 < summary["peak_memory_bytes"] < 3e9
    assert summary["config"]["scanner"]["pattern"] == "draft"
    assert summary["versions"]["mujoco"] != "not installed"
    assert all(scan["translation_error_m"] < 0.005 for scan in summary["registration"])


def test_one_seed_gives_the_same_bytes_on_one_core_and_on_two(furnished: Path, tmp_path: Path) -> None:
    command = [sys.executable, "-m", "mission", "run", "room.xml", *DRAFT, "--max-scans", "3", "--quiet"]
    one_core = ["taskset", "-c", "0"] if sys.platform == "linux" else []
    other_hashes = os.environ | {"PYTHONHASHSEED": "5"}
    subprocess.run([*one_core, *command, "--out", str(tmp_path)], check=True, env=other_hashes)
    for name in ("doors.json", "mission.mcap"):
        assert (tmp_path / name).read_bytes() == (furnished / name).read_bytes(), name


def test_a_room_with_three_walls_no_ceiling_and_no_door_is_a_success(tmp_path: Path, capsys) -> None:
    scene = tmp_path / "doorless.xml"
    scene.write_text(DOORLESS)
    assert main(["run", str(scene), *DRAFT, "--max-scans", "2", "--json", "--out", str(tmp_path / "out")]) == 0
    printed = json.loads(capsys.readouterr().out)
    assert printed["doors"]["rooms"][0]["doors"] == []
    assert printed["doors"]["rooms"][0]["walls"] == 3
    assert printed["summary"]["metrics"]["doors"] == 0


@pytest.mark.parametrize(("outcome", "stop_reason"), [("blocked", NO_ARRIVAL), ("stuck", "stuck for 30 s")])
def test_a_robot_that_never_arrives_ends_the_room_and_says_why(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, outcome: Any, stop_reason: str
) -> None:
    legs = []

    def ended(*arguments: Any, **keywords: Any) -> Drive:
        legs.append(replace(drive(*arguments, **keywords), outcome=outcome, reason="a box is in the way"))
        return legs[-1]

    monkeypatch.setattr(mission.surveyor, "drive", ended)
    assert main(["run", "room.xml", *DRAFT, "--quiet", "--out", str(tmp_path)]) == 0
    (room,) = json.loads((tmp_path / "summary.json").read_text())["rooms"]
    assert (room["scans"], room["stop_reason"]) == (1, stop_reason)
    assert len(legs) == (3 if outcome == "blocked" else 1)  # 30 s of patience are not spent again and again


def test_a_box_that_is_put_in_the_way_is_driven_round_without_a_touch(tmp_path: Path) -> None:
    # It stands beside the first leg's end, where the robot turns, and comes when that leg has begun.
    obstacle = "--obstacle=-1.7,-0.6"
    assert main(["run", "room.xml", *DRAFT, "--max-scans", "2", obstacle, "--quiet", "--out", str(tmp_path)]) == 0
    summary = json.loads((tmp_path / "summary.json").read_text())
    (room,) = summary["rooms"]
    assert (room["scans"], room["stop_reason"]) == (2, "scan limit")
    with (tmp_path / "mission.mcap").open("rb") as file:
        log = b"".join(message.data for _, _, message in make_reader(file).iter_messages())
    assert b"an obstacle stands at (-1.70, -0.60)" in log
    assert b"an obstacle 0.0" in log  # what stopped the robot
    assert not summary["contacts"]


def test_a_mission_below_the_bar_exits_with_1(tmp_path: Path, capsys) -> None:
    options = ["--max-scans", "1", "--fail-under", "coverage=1", "--quiet", "--out", str(tmp_path)]
    assert main(["run", "room.xml", *DRAFT, *options]) == 1
    assert "coverage is 0." in capsys.readouterr().err


@pytest.mark.parametrize("after", ["Registered", "Planned"])
def test_an_interrupted_mission_leaves_readable_files(tmp_path: Path, after: str) -> None:
    code = (
        "import sys, mission.events as e, mission.report as r; from mission.__main__ import main\n"
        "handle = r.Report.handle\n"
        "def say(self, event):\n"
        "    handle(self, event)\n"
        "    print(type(event).__name__, flush=True)\n"
        "r.Report.handle = say\n"
        "sys.exit(main(sys.argv[1:]))"
    )
    command = [sys.executable, "-c", code, "run", "room.xml", *DRAFT, "--quiet", "--out", str(tmp_path)]
    environment = os.environ | {"PYTHONPATH": str(Path(__file__).parents[2])}
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment) as process:
        assert process.stdout is not None
        for line in process.stdout:
            if line.strip() == after:
                time.sleep(0.05)  # into the next stage
                process.send_signal(signal.SIGINT)
                break
        process.stdout.read()
    assert process.returncode == 130
    assert json.loads((tmp_path / "doors.json").read_text())["rooms"][0]["scans"] in {0, 1}
    assert json.loads((tmp_path / "summary.json").read_text())["outcome"] == "interrupted"
    with (tmp_path / "mission.mcap").open("rb") as file:
        assert sum(1 for _ in make_reader(file, validate_crcs=True).iter_messages()) > 5
    verified = subprocess.run(
        [Path(sys.executable).with_name("rerun"), "rrd", "verify", tmp_path / "mission.rrd"],
        capture_output=True,
        text=True,
    )
    assert "1 file verified" in verified.stdout + verified.stderr
