"""The command `bench recording`: what recording a mission costs, and how fast it is read back."""

from __future__ import annotations

import argparse
import logging
from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np

from mission.bench.tables import BenchTable
from mission.bench.terminal import print_tables
from mission.config import read_config
from mission.errors import MissionError
from mission.events import Coloured, Event
from mission.folders import BAD_INPUT, make_folder
from mission.memory import current_memory, release_freed_memory
from mission.mission import Mission
from mission.progress import TerminalProgress
from mission.recording.mcap_reader import read_events
from mission.recording.mcap_sink import McapSink
from mission.recording.rerun_sink import RerunSink
from mission.report import write_json
from mission.run import carry_out
from mission.scene_file import find_scene
from mission.sink import Sink
from mission.stopwatch import Stopwatch
from mission.terminal import log_console, refuse
from mission.versions import versions
from sim.errors import SimError
from sim.scene import load_scene

ROUNDS = 3
"""How often the mission is recorded again, into files that grow, to see what memory does; the first brings what is
needed once."""
MCAP_LIMIT, RRD_LIMIT, SHARE_LIMIT = 45e6, 8e6, 0.10
"""A panorama_60 scan in either file at most [bytes], and the share of the mission's wall clock."""


@dataclass(frozen=True)
class RecordingCost:
    """What a mission's recordings cost."""

    scans: int
    mcap_bytes_per_scan: int
    rrd_bytes_per_scan: int
    logging_share: float
    """Of the mission's wall clock."""
    memory_growth_bytes_per_scan: int
    """Of the process, by each further scan that it records."""
    read_seconds_per_scan: float
    """Until every event is there again, every checksum checked and every scan coloured."""
    replay_seconds_per_scan: float
    """The same with a new recording for the viewer."""


def bench_recording(options: argparse.Namespace) -> int:
    """Run the benchmark as the command line says and return the exit status."""
    start = perf_counter()
    logging.basicConfig(level=logging.WARNING, format="%(levelname)s: %(message)s")
    log = log_console()
    try:
        config = read_config(options.config, options.set)
        progress = TerminalProgress(log)
        stopwatch = Stopwatch(progress.stage)
        scene = load_scene(find_scene(options.scene))
        with Mission(scene, config, seed=options.seed, stopwatch=stopwatch) as mission:
            folder = make_folder(options.out, scene_name="bench-recording", first_file="result.json")
            report, status = carry_out(mission, folder, progress=progress, stopwatch=stopwatch, start=start)
        scans = sum(room.scans for room in report.rooms.values())
        if status or not scans:
            return status or BAD_INPUT
        share = stopwatch.seconds.get("recording", 0.0) / (perf_counter() - start)
        log.print("reading the recording back", highlight=False)
        cost = measure(folder, scans=scans, share=share)
    except (SimError, MissionError, OSError) as error:
        return refuse(error)
    write_json(folder / "result.json", result(cost, seed=options.seed, config=config.model_dump(mode="json")))
    (folder / "tables.md").write_text(table(cost).markdown())
    print_tables([table(cost)])
    return status


def measure(folder: Path, *, scans: int, share: float) -> RecordingCost:
    """What the recordings in a folder cost, and what it takes to read them.

    Args:
        folder: With mission.mcap and mission.rrd; files for the measurement come and go in it.
        scans: That are in them.
        share: Of the wall clock that recording them took.
    """
    recording = folder / "mission.mcap"
    start = perf_counter()
    for _ in read_events(recording):
        pass
    read = perf_counter() - start
    start = perf_counter()
    with RerunSink(folder / "again.rrd") as sink:
        for event in read_events(recording):
            sink.handle(event)
    replayed = perf_counter() - start
    growth = memory_growth(recording, folder)
    return RecordingCost(
        scans=scans,
        mcap_bytes_per_scan=recording.stat().st_size // scans,
        rrd_bytes_per_scan=(folder / "mission.rrd").stat().st_size // scans,
        logging_share=round(share, 4),
        memory_growth_bytes_per_scan=growth,
        read_seconds_per_scan=round(read / scans, 3),
        replay_seconds_per_scan=round(replayed / scans, 3),
    )


def memory_growth(recording: Path, folder: Path) -> int:
    """How much more memory the process holds for each further scan that it records [bytes]."""
    files = [folder / "again.mcap", folder / "again.rrd"]
    held: list[int] = []
    with ExitStack() as stack:
        sinks: list[Sink] = [stack.enter_context(McapSink(files[0])), stack.enter_context(RerunSink(files[1]))]
        for event in _again(recording, ROUNDS):
            for sink in sinks:
                sink.handle(event)
            if isinstance(event, Coloured):
                release_freed_memory()
                held.append(current_memory())
    for file in files:
        file.unlink()
    rounds = np.array(held, float).reshape(ROUNDS, -1)
    return int((rounds[-1] - rounds[-2]).mean() / rounds.shape[1])


def _again(recording: Path, rounds: int) -> Iterator[Event]:
    """A mission's events several times in a row, as steps of one that goes on."""
    step = 0
    for _ in range(rounds):
        for event in read_events(recording):
            yield replace(event, step=step)
            step += 1


def result(cost: RecordingCost, *, seed: int, config: dict[str, Any]) -> dict[str, Any]:
    """The content of result.json: flat, for other tools."""
    return {"bench": "recording", "seed": seed, **asdict(cost), "config": config, "versions": versions()}


def table(cost: RecordingCost) -> BenchTable:
    """What it costs, beside what it may."""
    rows = (
        ("MCAP, a scan", f"{cost.mcap_bytes_per_scan / 1e6:.1f} MB", f"{MCAP_LIMIT / 1e6:.0f} MB"),
        ("RRD, a scan", f"{cost.rrd_bytes_per_scan / 1e6:.1f} MB", f"{RRD_LIMIT / 1e6:.0f} MB"),
        ("share of the mission's wall clock", f"{cost.logging_share:.1%}", f"{SHARE_LIMIT:.0%}"),
        ("memory, a further scan", f"{cost.memory_growth_bytes_per_scan / 1e6:+.1f} MB", "0 MB"),
        ("read back, a scan", f"{cost.read_seconds_per_scan:.2f} s", ""),
        ("replayed for the viewer, a scan", f"{cost.replay_seconds_per_scan:.2f} s", ""),
    )
    return BenchTable(f"recording {cost.scans} scans", ("what", "measured", "at most"), rows)
