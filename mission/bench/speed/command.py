"""The command `bench speed`: how fast scans, photographs, detector, missions and start-up are."""

from __future__ import annotations

import argparse
import json
import logging
import sys
from collections.abc import Callable

from mission.bench.speed.beams import compare_casters
from mission.bench.speed.detecting import time_detector
from mission.bench.speed.missions import time_mission, time_start_up
from mission.bench.speed.photographs import time_photographs
from mission.bench.speed.report import SpeedReport, write_report
from mission.bench.speed.worlds import cluttered_world, scene_world
from mission.bench.terminal import print_tables, progress_bar
from mission.bench_arguments import SPEED_PARTS as PARTS
from mission.errors import MissionError
from mission.folders import DONE, INTERRUPTED, make_folder
from mission.terminal import log_console, refuse
from sim.errors import SimError

SCENE = "room.xml"
LARGE = ("flat.xml", "building.xml")
QUICK = ("scanner.pattern=draft", "planning.max_scans=2")


def bench_speed(options: argparse.Namespace) -> int:
    """Run the benchmark as the command line says and return the exit status."""
    logging.basicConfig(level=logging.ERROR, format="%(levelname)s: %(message)s")
    log = log_console(quiet=options.json)
    try:
        folder = make_folder(options.out, scene_name="bench-speed", first_file="result.json")
        report = SpeedReport(options.repeats)
        chosen = {name: part for name, part in parts(report).items() if name in (options.part or PARTS)}
        with progress_bar(log) as progress:
            for name, part in progress.track(chosen.items(), description="timing"):
                if not log.is_terminal:
                    log.print(f"timing {name}", highlight=False)
                part()
        write_report(folder, report)
    except (SimError, MissionError, OSError) as error:
        return refuse(error)
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        return INTERRUPTED
    if options.json:
        print(json.dumps(report.result(), indent=2))
    else:
        print_tables(report.tables())
    log.print(f"tables.md, result.json and picture:  {folder}", highlight=False, markup=False, soft_wrap=True)
    return DONE


def parts(report: SpeedReport) -> dict[str, Callable[[], None]]:
    """What each part does to the report."""
    return {
        "scans": lambda: _scans(report),
        "photographs": lambda: _photographs(report),
        "detector": lambda: _detector(report),
        "missions": lambda: _missions(report),
        "start-up": lambda: report.start_up.update(time_start_up(min(report.repeats, 3))),
    }


def _scans(report: SpeedReport) -> None:
    for make in (lambda: scene_world(SCENE), cluttered_world):
        with make() as world:
            report.casters[world.name] = compare_casters(world, report.repeats)


def _photographs(report: SpeedReport) -> None:
    with scene_world(SCENE) as world:
        report.shots, times = time_photographs(world, report.repeats)
    report.photographs.update(times)


def _detector(report: SpeedReport) -> None:
    with scene_world(SCENE) as world:
        report.detector = time_detector(world, report.repeats)


def _missions(report: SpeedReport) -> None:
    report.missions.append(time_mission(SCENE, bare=True))
    report.missions += [time_mission(scene, *QUICK) for scene in LARGE]
