"""Recordings told again, judged again, saved and compared; and those that cannot be."""

from __future__ import annotations

import json
import os
import struct
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from mcap.writer import Writer

from mission.__main__ import main
from mission.events import DoorsEvaluated, Event, MissionFinished, MissionStarted
from mission.recording import entities
from mission.recording.mcap_reader import DamagedError, read_events
from mission.recording.mcap_sink import McapSink
from mission.recording.mcap_topics import PROFILE
from tests.mission.events_alike import differences
from tests.mission.recording_story import story
from tests.mission.rerun_file import RERUN

WITHOUT_SIMULATOR = """
import sys
class Nobody:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] == "mujoco":
            raise ModuleNotFoundError("there is no mujoco")
sys.meta_path.insert(0, Nobody())
from mission.__main__ import main
sys.exit(main(sys.argv[1:]))
"""


def record(path: Path, events: list[Event]) -> Path:
    with McapSink(path) as sink:
        for event in events:
            sink.handle(event)
    return path


@pytest.fixture
def recording(tmp_path: Path) -> Path:
    (tmp_path / "told").mkdir()
    return record(tmp_path / "told" / "mission.mcap", story())


def test_what_is_told_again_is_the_same_to_the_last_bit(recording: Path) -> None:
    told = read_events(recording)
    found = [where for one, other in zip(story(), told, strict=True) for where in differences(one, other)]
    # the story's clouds are made up; those that are read follow from scan, photographs and pose
    assert [where for where in found if not where.startswith("event.view")] == []


def test_a_replay_writes_what_the_mission_wrote(recording: Path, tmp_path: Path) -> None:
    assert main(["replay", str(recording), "--quiet", "--out", str(tmp_path / "again")]) == 0
    doors = json.loads((tmp_path / "again" / "doors.json").read_text())
    assert [door["id"] for door in doors["rooms"][0]["doors"]] == ["1.2-a", "1.3-a"]
    summary = json.loads((tmp_path / "again" / "summary.json").read_text())
    assert (summary["outcome"], summary["replayed"]) == ("completed", str(recording))
    assert sorted(path.name for path in (tmp_path / "again").iterdir()) == ["doors.json", "mission.rrd", "summary.json"]


def test_results_never_go_where_the_recording_is(recording: Path, capsys: pytest.CaptureFixture[str]) -> None:
    before = recording.read_bytes()
    assert main(["replay", str(recording), "--redetect", "--quiet", "--out", str(recording.parent)]) == 2
    assert "the folder of the recording itself" in capsys.readouterr().err
    assert recording.read_bytes() == before


def test_parameters_are_for_judging_again(recording: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["replay", str(recording), "--set", "detector.alpha1=0.4", "--quiet"]) == 2
    assert capsys.readouterr().err == "error: --set changes nothing without --redetect\n"


def cut(data: bytes) -> bytes:
    return data[: len(data) // 2]


def flip(data: bytes) -> bytes:
    """One bit in the middle of the chunk in the middle."""
    place = len(data) // 2
    return data[:place] + bytes([data[place] ^ 4]) + data[place + 1 :]


def newer(data: bytes) -> bytes:
    return data.replace(f"{PROFILE}1".encode(), f"{PROFILE}7".encode(), 1)


def foreign(_: bytes) -> bytes:
    import io

    file = io.BytesIO()
    writer = Writer(file)
    writer.start(profile="ros2", library="")
    writer.finish()
    return file.getvalue()


@pytest.mark.parametrize(
    ("spoil", "says"),
    [
        (cut, "the file ends early; read up to step"),
        (flip, "the file is damaged"),
        (newer, "written by a newer version (format 7, this one reads up to 1)"),
        (foreign, "no recording of a mission (its profile is 'ros2')"),
        (lambda _: b"", "the file is empty"),
        (lambda _: b"#ROSBAG V2.0\n" + bytes(100), "not an MCAP file, but a ROS bag"),
        (lambda _: bytes(range(256)) * 20, "not an MCAP file, but something else"),
        (lambda data: data[:8], "nothing could be read"),
        (lambda data: data[:8] + b"\x01" + b"\xff" * 200, "nothing could be read"),
    ],
    ids=["cut", "flipped", "newer", "foreign", "empty", "bag", "garbage", "magic", "lengths"],
)
def test_a_file_that_cannot_be_read_is_told_in_one_line(
    recording: Path, capsys: pytest.CaptureFixture[str], spoil: Callable[[bytes], bytes], says: str
) -> None:
    spoilt = recording.with_name("spoilt.mcap")
    spoilt.write_bytes(spoil(recording.read_bytes()))
    for command in ("replay", "recover"):
        out = recording.parent / command
        status = main([command, str(spoilt), "--quiet", "--out", str(out)])
        printed = capsys.readouterr()
        if command == "recover" and status == 0:  # of a cut or damaged file what is before it is saved
            assert "read up to step" in says or "damaged" in says
            continue
        assert (status, printed.out, printed.err.count("\n")) == (2, "", 1)
        assert says in printed.err
    assert main(["compare", str(recording), str(spoilt)]) == 2
    assert capsys.readouterr().err.count("\n") == 1


def test_every_bit_that_flips_is_noticed(recording: Path) -> None:
    data = recording.read_bytes()
    spoilt = recording.with_name("spoilt.mcap")
    for place in range(9, len(data), len(data) // 60):
        spoilt.write_bytes(data[:place] + bytes([data[place] ^ 0x10]) + data[place + 1 :])
        with pytest.raises(Exception, match="damaged|ends early|version|profile|empty"):
            list(read_events(spoilt))


def test_what_a_kill_leaves_is_saved_up_to_the_last_event(recording: Path, tmp_path: Path) -> None:
    whole = recording.read_bytes()
    part = recording.with_name("part.mcap")
    part.write_bytes(whole[: len(whole) * 2 // 3])
    good = []
    with pytest.raises(DamagedError):
        for event in read_events(part):
            good.append(event)
    assert main(["recover", str(part), "--quiet", "--out", str(tmp_path / "saved")]) == 0
    saved = list(read_events(tmp_path / "saved" / "part.mcap"))
    assert 3 < len(saved) == len(good) < len(story())
    assert all(not differences(one, other) for one, other in zip(good, saved, strict=True))
    assert (
        subprocess.run([RERUN, "mcap", "check", tmp_path / "saved" / "part.mcap"], capture_output=True).returncode == 0
    )
    assert part.stat().st_size == len(whole) * 2 // 3  # the damaged one is as it was


def test_a_recording_without_scans_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    told = [event for event in story() if isinstance(event, MissionStarted | MissionFinished)]
    path = record(tmp_path / "short.mcap", told)
    assert main(["replay", str(path), "--quiet", "--out", str(tmp_path / "out")]) == 2
    assert capsys.readouterr().err == f"error: {path} holds no scan\n"


def test_a_mission_is_like_itself(recording: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["compare", str(recording), str(recording)]) == 0
    assert capsys.readouterr().out == "nothing differs\n"


def test_doors_and_times_that_differ_are_told(recording: Path, capsys: pytest.CaptureFixture[str]) -> None:
    def changed(event: Event) -> Event:
        if isinstance(event, DoorsEvaluated):
            return replace(event, doors=event.doors[:1])
        return replace(event, time=event.time + 10**9) if isinstance(event, MissionFinished) else event

    other = record(recording.with_name("other.mcap"), [changed(event) for event in story()])
    assert main(["compare", str(recording), str(other)]) == 1
    said = capsys.readouterr().out
    assert "1.3-a" in said and "not found" in said
    assert "mission time [s]" in said


def test_a_size_that_a_file_claims_takes_no_memory(recording: Path) -> None:
    data = bytearray(recording.read_bytes())
    place = data.index(b"\x06", 60)  # the first chunk: opcode, length, two times, size when unpacked
    data[place + 25 : place + 33] = struct.pack("<Q", 2**40)
    spoilt = recording.with_name("spoilt.mcap")
    spoilt.write_bytes(data)
    with pytest.raises(DamagedError, match="wrong size|early|damaged"):
        list(read_events(spoilt))


@pytest.fixture(scope="module")
def mission(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The output folder of a draft mission in room.xml."""
    folder = tmp_path_factory.mktemp("mission") / "out"
    options = ["--set", "scanner.pattern=draft", "--max-scans", "2", "--quiet"]
    assert main(["run", "room.xml", *options, "--out", str(folder)]) == 0
    return folder


@pytest.mark.slow
def test_judged_again_without_the_simulator_the_doors_are_the_same_to_the_last_byte(
    mission: Path, tmp_path: Path
) -> None:
    command = [sys.executable, "-c", WITHOUT_SIMULATOR, "replay", str(mission / "mission.mcap"), "--quiet"]
    done = subprocess.run([*command, "--redetect", "--out", str(tmp_path)], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "doors.json").read_bytes() == (mission / "doors.json").read_bytes()
    old, new = ([*read_events(folder / "mission.mcap")] for folder in (mission, tmp_path))
    found = [where for one, other in zip(old, new, strict=True) for where in differences(one, other)]
    assert found == []


@pytest.mark.slow
def test_a_replay_looks_the_same(mission: Path, tmp_path: Path) -> None:
    command = [sys.executable, "-m", "mission", "replay", str(mission / "mission.mcap"), "--quiet"]
    subprocess.run([*command, "--out", str(tmp_path)], check=True, env=os.environ | {"PYTHONHASHSEED": "5"})
    assert (tmp_path / "doors.json").read_bytes() == (mission / "doors.json").read_bytes()
    for name, folder in (("one", mission), ("other", tmp_path)):
        apart = ["--drop-timeline", "log_time", "--drop-entity", "/__properties"]
        bars = (
            f"{stages}/{part}" for stages in (entities.MISSION_STAGES, entities.STAGES) for part in ("bars", "labels")
        )
        for timed in (entities.MEMORY, *bars):
            apart += ["--drop-entity", timed]
        filtered, optimized = tmp_path / f"{name}.filtered.rrd", tmp_path / f"{name}.rrd"
        rerun("filter", folder / "mission.rrd", *apart, "-o", filtered)
        rerun("optimize", filtered, "-o", optimized)
    rerun("compare", "--unordered", tmp_path / "one.rrd", tmp_path / "other.rrd")


@pytest.mark.slow
def test_another_parameter_leads_to_other_doors(
    mission: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    options = ["--redetect", "--set", "detector.min_height=2.1", "--quiet", "--out", str(tmp_path)]
    assert main(["replay", str(mission / "mission.mcap"), *options]) == 0
    assert "not found" in capsys.readouterr().out


def rerun(*arguments: Any) -> None:
    done = subprocess.run([RERUN, "rrd", *map(str, arguments)], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
