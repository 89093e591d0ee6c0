"""Missions that are killed at any moment, and gone on with."""

from __future__ import annotations

import json
import os
import random
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from mission.__main__ import main
from mission.config import MissionConfig
from mission.errors import UsageError
from mission.events import Event, MissionFinished, MissionStarted, Photographed, Scanned
from mission.folders import sole_use
from mission.order import FILE, Order, read_order, write_order
from mission.recording.mcap_reader import DamagedError, read_events
from mission.recording.mcap_sink import McapSink
from mission.resumption import Earlier, forget, is_complete, set_aside
from tests.mission.recording_story import story
from tests.mission.rerun_file import RERUN

KILLS = int(os.environ.get("KILLS", "2"))
"""How often a mission is killed; 20 take some twenty minutes."""
QUICK = ["--set", "scanner.pattern=draft", "--set", "camera.shots=7", "--max-scans", "2", "--quiet"]


def record(path: Path, events: list[Event]) -> Path:
    with McapSink(path) as sink:
        for event in events:
            sink.handle(event)
    return path


def order(scene: Path) -> Order:
    config = MissionConfig.model_validate({"detector": {"alpha1": 0.4}})
    return Order(scene, 7, config, {"door": 0.5}, None, [(1.0, 2.0, None), (0.0, 1.0, 5.0)])


def test_an_order_comes_back_as_it_was(tmp_path: Path) -> None:
    asked = order(tmp_path / "flat.xml")
    write_order(tmp_path, asked)
    assert read_order(tmp_path) == asked


@pytest.mark.parametrize("text", ["", "{}", "[1]", '{"scene": 1}', "null"])
def test_what_is_no_order_is_refused(tmp_path: Path, text: str) -> None:
    (tmp_path / FILE).write_text(text)
    with pytest.raises(UsageError, match="not the order of a mission"):
        read_order(tmp_path)


def test_scans_and_photographs_come_back_in_their_order(tmp_path: Path) -> None:
    told = story()
    first, second = (event for event in told if isinstance(event, Scanned))
    photos = next(event for event in told if isinstance(event, Photographed)).photos
    until_second = told[: told.index(second) + 1]  # killed before the photographs of the second scan
    earlier = Earlier(record(tmp_path / "m.mcap", until_second))
    for scanned, taken in ((first, photos), (second, None)):
        scan = earlier.scan(scanned.true_world_from_scanner)
        assert scan is not None
        np.testing.assert_array_equal(scan.ranges, scanned.scan.ranges)
        got = earlier.photos()
        assert (got is None) == (taken is None)
        if got is not None and taken is not None:
            np.testing.assert_array_equal(got[0].image, taken[0].image)
    assert earlier.scan(first.true_world_from_scanner) is None


def test_from_another_place_a_scan_is_taken_anew_and_so_is_all_that_follows(tmp_path: Path) -> None:
    earlier = Earlier(record(tmp_path / "m.mcap", story()))
    first, second = (event.true_world_from_scanner for event in story() if isinstance(event, Scanned))
    assert earlier.scan(first + 1e-9) is None
    assert earlier.photos() is None
    assert earlier.scan(second) is None


ASKED = order(Path("room.xml"))


def carried_out(asked: Order = ASKED) -> list[Event]:
    """The story as the mission that was asked for."""
    first, *others = story()
    assert isinstance(first, MissionStarted)
    config = asked.config.model_dump(mode="json")
    return [replace(first, seed=asked.seed, config=config, scene_xml="<mujoco/>"), *others]


def test_of_all_interrupted_recordings_none_is_lost_and_the_longest_serves(tmp_path: Path) -> None:
    told = carried_out()
    for events in (told, told[:4]):  # killed again, earlier than the first time
        record(tmp_path / "mission.mcap", events)
        (tmp_path / "mission.rrd").write_bytes(b"RRF2")
        serves = set_aside(tmp_path, ASKED, "<mujoco/>")
    assert serves == tmp_path / "mission.interrupted-1.mcap"
    names = {f"mission.interrupted-{n}.{suffix}" for n in (1, 2) for suffix in ("mcap", "rrd")}
    assert {path.name for path in tmp_path.iterdir()} == names
    forget(tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_the_recording_of_another_mission_does_not_serve(tmp_path: Path) -> None:
    record(tmp_path / "mission.mcap", carried_out(replace(ASKED, seed=8)))
    assert set_aside(tmp_path, ASKED, "<mujoco/>") is None
    record(tmp_path / "mission.mcap", carried_out(replace(ASKED, config=MissionConfig())))
    assert set_aside(tmp_path, ASKED, "<mujoco/>") is None


def test_only_a_mission_that_came_to_its_end_is_complete(tmp_path: Path) -> None:
    record(tmp_path / "mission.mcap", carried_out())
    (tmp_path / "mission.rrd").touch()
    assert not is_complete(tmp_path, ASKED)  # killed before its results were written
    for name in ("doors.json", "summary.json"):
        (tmp_path / name).touch()
    assert is_complete(tmp_path, ASKED)
    assert not is_complete(tmp_path, replace(ASKED, seed=8))
    record(tmp_path / "mission.mcap", [event for event in carried_out() if not isinstance(event, MissionFinished)])
    assert not is_complete(tmp_path, ASKED)


def test_a_folder_serves_one_mission_at_a_time_and_the_next_when_it_is_done(tmp_path: Path) -> None:
    with sole_use(tmp_path), pytest.raises(UsageError, match="still at work"), sole_use(tmp_path):
        pass
    with sole_use(tmp_path):
        pass


def test_a_scene_that_changed_since_is_refused_before_anything_is_renamed(tmp_path: Path) -> None:
    recording = record(tmp_path / "mission.mcap", carried_out()[:2])
    with pytest.raises(UsageError, match="the scene has changed"):
        set_aside(tmp_path, ASKED, "<mujoco model='other'/>")
    assert [*tmp_path.iterdir()] == [recording]


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["--resume", "{}"], "no mission was begun in this folder"),
        (["--resume", "{}/nowhere"], "no mission was begun in this folder"),
        (["room.xml", "--resume", "{}", "--max-scans", "2"], "leave out SCENE, --set and the like"),
        ([], "what is to be scanned?"),
    ],
)
def test_a_mission_that_cannot_go_on_is_told_in_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], arguments: list[str], says: str
) -> None:
    assert main(["run", *(argument.format(tmp_path) for argument in arguments)]) == 2
    printed = capsys.readouterr()
    assert (printed.out, printed.err.count("\n")) == ("", 1)
    assert says in printed.err


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, float]:
    """A mission's folder, and how long it took from when it was begun [s]."""
    folder = tmp_path_factory.mktemp("undisturbed")
    assert main(["run", "room.xml", *QUICK, "--out", str(folder)]) == 0
    return folder, time.time() - (folder / FILE).stat().st_mtime


@pytest.mark.slow
@pytest.mark.parametrize("kill", range(KILLS))
def test_killed_at_any_moment_it_leaves_what_happened_and_goes_on_to_the_same_doors(
    undisturbed: tuple[Path, float], tmp_path: Path, kill: int
) -> None:
    folder, seconds = undisturbed
    moment = random.Random(kill).uniform(0.0, 0.95) * seconds
    command = [sys.executable, "-m", "mission", "run", "room.xml", *QUICK, "--out", str(tmp_path)]
    mission = subprocess.Popen(command)
    while not (tmp_path / FILE).exists():
        time.sleep(0.02)
    time.sleep(moment)
    mission.kill()
    mission.wait()
    steps = readable_steps(tmp_path / "mission.mcap")
    assert steps == list(range(len(steps)))
    if steps:
        verify = [RERUN, "rrd", "verify", "--check-footers", "false", tmp_path / "mission.rrd"]
        done = subprocess.run(verify, capture_output=True, text=True)
        assert "1 file verified" in done.stdout + done.stderr
    assert main(["run", "--resume", str(tmp_path), "--quiet"]) == 0
    assert (tmp_path / "doors.json").read_bytes() == (folder / "doors.json").read_bytes()
    assert json.loads((tmp_path / "summary.json").read_text())["outcome"] == "completed"


def readable_steps(path: Path) -> list[int]:
    """Steps of the events that a killed mission left."""
    steps: list[int] = []
    if path.exists():
        try:
            for event in read_events(path):
                steps.append(event.step)
        except DamagedError:
            pass
        except UsageError as error:  # killed before anything was written
            assert "empty" in str(error)
    return steps
