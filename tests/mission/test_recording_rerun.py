"""The Rerun recording as a file: complete and within bounds, whatever happens to the mission."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import rerun as rr
from rerun.chunk import RrdReader

from mission.events import Coloured, DoorsDetected, MissionFinished, MissionStarted
from mission.recording.rerun_sink import RerunSink
from mission.recording.sentences import sentence
from tests.mission.recording_room import view
from tests.mission.recording_story import bare_story, story
from tests.mission.rerun_file import column, event_of, points, record, verified

TIMELINES = {"step", "mission_time", "scan", "room"}


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return record(tmp_path_factory.mktemp("rrd") / "mission.rrd", story())


def test_a_finished_recording_verifies(recording: Path) -> None:
    assert verified(recording)


def test_a_mission_that_breaks_leaves_everything_so_far(tmp_path: Path) -> None:
    path = tmp_path / "broken.rrd"
    with pytest.raises(KeyboardInterrupt), RerunSink(path) as sink:
        for event in story()[:5]:
            sink.handle(event)
        raise KeyboardInterrupt
    assert verified(path)
    assert len(column(path, "/log", "TextLog:text")) == 5
    assert RrdReader(path).blueprints()


def test_every_handled_event_is_in_the_file_before_it_is_closed(tmp_path: Path) -> None:
    path, killed = tmp_path / "open.rrd", tmp_path / "killed.rrd"
    with RerunSink(path) as sink:
        for event in story()[:5]:
            sink.handle(event)
        killed.write_bytes(path.read_bytes())  # what a kill -9 would leave
    with pytest.warns(match="no footer"):
        chunks = RrdReader(killed).stream().filter(content="/log").to_chunks()
    assert sum(chunk.num_rows for chunk in chunks) == 5


def test_two_missions_are_two_recordings_to_a_viewer_that_shows_both(tmp_path: Path) -> None:
    start = event_of(MissionStarted)
    ids = set()
    for folder in ("a/try", "b/try"):
        (tmp_path / folder).mkdir(parents=True)
        path = record(tmp_path / folder / "mission.rrd", [start])
        ids |= {store.recording_id for store in RrdReader(path).recordings()}
    again = record(path, [replace(start, seed=4)])  # while the viewer is open
    ids |= {store.recording_id for store in RrdReader(again).recordings()}
    assert len(ids) == 3
    assert all("made_up" in identity for identity in ids)


@pytest.mark.parametrize("before", [True, False])
def test_strict_mode_is_left_as_it_was_found(tmp_path: Path, before: bool) -> None:
    rr.set_strict_mode(before)
    try:
        record(tmp_path / "mission.rrd", story()[:2])
        assert rr.strict_mode() == before
    finally:
        rr.set_strict_mode(False)


def test_a_mission_that_ends_before_it_started_is_recorded(tmp_path: Path) -> None:
    end = event_of(MissionFinished)
    assert column(record(tmp_path / "end.rrd", [end]), "/log", "TextLog:text") == [[sentence(end)]]


def test_whatever_changes_is_on_all_timelines(recording: Path) -> None:
    for chunk in RrdReader(recording).store().stream().to_chunks():
        if not chunk.is_static:
            assert set(chunk.timeline_names) == TIMELINES, chunk.entity_path


def test_a_dense_scan_takes_less_than_two_megabytes(tmp_path: Path) -> None:
    start, coloured = event_of(MissionStarted), event_of(Coloured)
    few = record(tmp_path / "few.rrd", [start, coloured])
    dense = replace(coloured, view=view(np.random.default_rng(1), 1_000_000))
    many = record(tmp_path / "many.rrd", [start, dense])
    assert many.stat().st_size - few.stat().st_size < 2_000_000  # 49,000 points of 5 cm on 115 m2, 16 bytes each


def test_a_mission_without_points_walls_doors_or_ways_is_recorded(tmp_path: Path) -> None:
    path = record(tmp_path / "bare.rrd", bare_story())
    assert verified(path)
    assert points(path, "/world/scans/001/points")[0].size == 0
    assert len(column(path, "/log", "TextLog:text")) == len(bare_story())


def test_a_wall_that_no_scan_saw_has_a_tab_without_views(tmp_path: Path) -> None:
    detected = event_of(DoorsDetected)
    unseen = replace(detected.results[1], views=(), highlights=(), view_numbers=())
    events = [event_of(MissionStarted), replace(detected, results=(unseen,))]
    assert verified(record(tmp_path / "unseen.rrd", events))
