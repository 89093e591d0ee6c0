"""Viewers that follow a mission: they get all of it, and the file does not depend on them."""

from __future__ import annotations

import logging
import os
import signal
import socket
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from time import monotonic, sleep

import pytest
import rerun as rr
from rerun.chunk import RrdReader

from mission.__main__ import main
from mission.errors import UsageError
from mission.recording import live
from mission.recording.rerun_sink import RerunSink
from tests.mission.recording_story import story
from tests.mission.rerun_file import column, record


@contextmanager
def following(path: Path, url: str | None = None) -> Iterator[tuple[subprocess.Popen[bytes], str]]:
    """A viewer without a window, and its URL; it writes down what it is sent, or else what it finds at another URL."""
    port = free_port()
    where = [url] if url else ["--bind", "127.0.0.1", "--port", str(port)]
    viewer = subprocess.Popen([live.VIEWER, "--save", path, *where], stderr=subprocess.DEVNULL)
    try:
        if not url:
            wait(lambda: live._listens("127.0.0.1", port))
        yield viewer, live.address(port)
    finally:
        viewer.kill()
        viewer.wait()


def free_port() -> int:
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        return int(free.getsockname()[1])


def wait(for_what: Callable[[], bool]) -> None:
    end = monotonic() + 20
    while not for_what():
        assert monotonic() < end
        sleep(0.05)


def lines(path: Path) -> int:
    """Of the log, in a file that is being written."""
    if not path.exists() or not path.stat().st_size:
        return 0
    try:
        chunks = RrdReader(path).stream().filter(content="/log").to_chunks()
    except Exception:  # in the middle of a chunk
        return 0
    return sum(chunk.num_rows for chunk in chunks)


@pytest.mark.filterwarnings("ignore:.*footer")
def test_a_viewer_that_is_connected_gets_every_event(tmp_path: Path) -> None:
    got = tmp_path / "got.rrd"
    with following(got) as (_, url):
        streams = live.live_streams(connect=url)
        with RerunSink(tmp_path / "mission.rrd", streams) as sink:
            for event in story():
                sink.handle(event)
        wait(lambda: lines(got) == len(story()))
    assert len(column(tmp_path / "mission.rrd", "/log", "TextLog:text")) == len(story())


@pytest.mark.skipif(sys.platform != "linux", reason="reads Linux's tables of sockets")
@pytest.mark.filterwarnings("ignore:.*footer")
def test_what_is_served_is_found_from_its_beginning_by_this_machine_alone(tmp_path: Path) -> None:
    got, port = tmp_path / "got.rrd", free_port()
    with RerunSink(tmp_path / "mission.rrd", live.live_streams(serve=port)) as sink:
        for event in story()[:5]:
            sink.handle(event)
        tables = [Path(f"/proc/net/{kind}").read_text().splitlines() for kind in ("tcp", "tcp6")]
        sockets = [line.split() for table in tables for line in table]
        listening = {local for _, local, _, state, *_ in sockets if state == "0A"}
        assert {local for local in listening if local.endswith(f":{port:04X}")} == {f"0100007F:{port:04X}"}
        with following(got, live.address(port)):  # comes late
            wait(lambda: lines(got) == 5)


def test_a_viewer_that_goes_away_takes_nothing_with_it(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    path = tmp_path / "mission.rrd"
    with following(tmp_path / "got.rrd") as (viewer, url):
        streams = live.live_streams(connect=url)
        with caplog.at_level(logging.WARNING), RerunSink(path, streams) as sink:
            for event in story()[:4]:
                sink.handle(event)
            viewer.kill()
            viewer.wait()
            for event in story()[4:]:
                sink.handle(event)
    assert len(column(path, "/log", "TextLog:text")) == len(story())
    assert [record.message for record in caplog.records] == ["a viewer is gone; the recording goes on"]


def test_what_the_file_says_is_an_error_with_a_viewer_as_without(monkeypatch: pytest.MonkeyPatch) -> None:
    def full(self: rr.RecordingStream, **_: float) -> None:
        raise RuntimeError("file: No space left on device")

    monkeypatch.setattr(rr.RecordingStream, "flush", full)
    with pytest.raises(RuntimeError, match="No space"):
        live.flush(rr.RecordingStream("door-mission"), streams=[rr.GrpcSink()])


@pytest.mark.parametrize("url", ["somewhere", "http://127.0.0.1:9876/proxy", "rerun+http://h:99999/proxy", "rerun://"])
def test_what_is_no_address_of_a_viewer_is_refused(url: str) -> None:
    with pytest.raises(UsageError, match="expected a URL"):
        live.live_streams(connect=url)


def test_a_port_that_is_taken_is_refused_before_the_mission_begins(capsys: pytest.CaptureFixture[str]) -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        assert main(["run", "room.xml", "--serve", str(port)]) == 2
    assert capsys.readouterr().err.startswith(f"error: --serve: port {port} cannot be had")


def test_a_viewer_that_is_not_there_is_an_error_of_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    url = live.address(free_port())
    assert main(["run", "room.xml", "--connect", url]) == 2
    assert capsys.readouterr().err == f"error: --connect {url}: no viewer listens there\n"


@pytest.mark.filterwarnings("ignore:.*footer")
def test_a_viewer_that_is_opened_gets_every_event_and_stays(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    got, program, pid = tmp_path / "got.rrd", tmp_path / "viewer", tmp_path / "pid"
    program.write_text(f'#!/bin/sh\necho $$ > {pid}\nexec {live.VIEWER} --save {got} "$@"\n')  # it has no window
    program.chmod(0o755)
    monkeypatch.setenv("DISPLAY", ":77")
    monkeypatch.setattr(live, "VIEWER", program)
    monkeypatch.setattr(live, "FRESH", 0.0)
    try:
        with RerunSink(tmp_path / "mission.rrd", live.live_streams(view=True)) as sink:
            for event in story():
                sink.handle(event)
        wait(lambda: lines(got) == len(story()))
    finally:
        os.kill(int(pid.read_text()), signal.SIGKILL)


@pytest.mark.parametrize("display", ["", ":77"])
def test_without_a_screen_there_is_no_view(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], display: str
) -> None:
    """The second viewer has a screen, or so it is told, and ends at once."""
    monkeypatch.setenv("DISPLAY", display)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    monkeypatch.setattr(live, "VIEWER", Path("/bin/false"))
    monkeypatch.setattr(live, "FRESH", 0.0)
    assert main(["run", "room.xml", "--view"]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("error: --view: ")


def test_a_recording_is_the_same_with_followers_and_without(tmp_path: Path) -> None:
    alone = record(tmp_path / "alone.rrd", story())
    with RerunSink(tmp_path / "served.rrd", live.live_streams(serve=free_port())) as sink:
        for event in story():
            sink.handle(event)
    for entity, what in (("/world/scans/001/points", "Points3D:positions"), ("/report/summary", "TextDocument:text")):
        assert column(alone, entity, what) == column(tmp_path / "served.rrd", entity, what)
