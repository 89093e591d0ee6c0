"""The command `bench building`: a mission in building.xml, and its doors beside the paper's."""

from __future__ import annotations

import argparse
import logging
from pathlib import Path
from time import perf_counter
from typing import Any

from mission.bench.building import paper
from mission.bench.building.faces import door_faces
from mission.bench.building.tables import table_3
from mission.bench.terminal import print_tables
from mission.config import MissionConfig, read_config
from mission.errors import MissionError
from mission.folders import make_folder, viewer_command
from mission.mission import Mission
from mission.progress import TerminalProgress
from mission.report import Report, write_json
from mission.run import carry_out
from mission.scene_file import find_scene
from mission.stopwatch import Stopwatch
from mission.terminal import log_console, refuse
from mission.versions import versions
from sim.errors import SimError
from sim.scene import load_scene

SCENE = "building.xml"


def bench_building(options: argparse.Namespace) -> int:
    """Run the benchmark as the command line says and return the exit status."""
    start = perf_counter()
    logging.basicConfig(level=logging.WARNING, format="%(levelname)s: %(message)s")
    log = log_console()
    try:
        config = read_config(options.config, options.set)
        progress = TerminalProgress(log)
        stopwatch = Stopwatch(progress.stage)
        scene = load_scene(find_scene(SCENE))
        with Mission(scene, config, seed=options.seed, stopwatch=stopwatch) as mission:
            folder = make_folder(options.out, scene_name="bench-building", first_file="result.json")
            report, status = carry_out(mission, folder, progress=progress, stopwatch=stopwatch, start=start)
    except (SimError, MissionError, OSError) as error:
        return refuse(error)
    write_files(folder, report, seed=options.seed, config=config)
    print_tables([table_3(report)])
    log.print(
        f"open the recording:  {viewer_command(folder / 'mission.rrd')}", highlight=False, markup=False, soft_wrap=True
    )
    return status


def write_files(folder: Path, report: Report, *, seed: int, config: MissionConfig) -> None:
    """Write tables.md and result.json beside the recording."""
    (folder / "tables.md").write_text(table_3(report).markdown())
    write_json(folder / "result.json", result(report, seed=seed, config=config))


def result(report: Report, *, seed: int, config: MissionConfig) -> dict[str, Any]:
    """The content of result.json: flat, for other tools; a face in a room that was never entered is not found."""
    metrics = report.metrics()
    names = ("found", "false_positives", "precision", "recall", "e_abs", "e_rel", "angle_mae_deg", "angle_max_deg")
    return {
        "bench": "building",
        "seed": seed,
        "doors": max(len(paper.TABLE_3), len(door_faces(report))),
        **{name: metrics[name] for name in names},
        "rooms": len(report.rooms),
        "config": config.model_dump(mode="json"),
        "versions": versions(),
    }
