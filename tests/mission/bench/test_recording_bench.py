"""The benchmark of recordings, on a small one."""

from __future__ import annotations

import json
from pathlib import Path

from mission.bench.recording.command import measure, result, table
from mission.recording.mcap_sink import McapSink
from mission.recording.rerun_sink import RerunSink
from tests.mission.recording_story import story


def test_costs_are_those_of_the_files_and_nothing_is_left_behind(tmp_path: Path) -> None:
    with McapSink(tmp_path / "mission.mcap") as mcap, RerunSink(tmp_path / "mission.rrd") as rrd:
        for event in story():
            mcap.handle(event)
            rrd.handle(event)
    cost = measure(tmp_path, scans=2, share=0.05)
    assert cost.mcap_bytes_per_scan == (tmp_path / "mission.mcap").stat().st_size // 2
    assert cost.rrd_bytes_per_scan == (tmp_path / "mission.rrd").stat().st_size // 2
    assert 0 < cost.read_seconds_per_scan < 5
    assert abs(cost.memory_growth_bytes_per_scan) < 10e6  # the story's scans are of some kilobytes
    assert sorted(path.name for path in tmp_path.iterdir()) == ["mission.mcap", "mission.rrd"]
    flat = json.loads(json.dumps(result(cost, seed=0, config={})))
    assert {"mcap_bytes_per_scan", "rrd_bytes_per_scan", "logging_share"} <= set(flat)
    assert "5.0%" in table(cost).markdown()
