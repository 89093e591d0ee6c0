"""The command `bench walls`: scan, detect, judge, and write what came out."""

from __future__ import annotations

import argparse
import logging
import sys
from collections.abc import Collection, Sequence
from functools import partial
from pathlib import Path

from detector.room import DetectorError
from mission.bench.parallel import Workers, default_jobs
from mission.bench.terminal import Runner, print_tables, progress_bar, run_tasks
from mission.bench.walls.cache import cached_scan, default_folder
from mission.bench.walls.judging import WallJudgement, judge_room
from mission.bench.walls.report import BenchReport, write_report
from mission.bench.walls.rooms import CATEGORIES, BenchRoom, rooms
from mission.bench.walls.variants import Variant, variants
from mission.config import MissionConfig, read_config
from mission.errors import MissionError, UsageError
from mission.folders import DONE, FAILED, INTERRUPTED, make_folder, viewer_command
from mission.terminal import log_console, refuse
from sim.errors import SimError

Judged = dict[Variant, list[WallJudgement]]
"""Judgements of all walls, by what was varied."""


def bench_walls(options: argparse.Namespace) -> int:
    """Run the benchmark as the command line says and return the exit status."""
    logging.basicConfig(level=logging.WARNING, format="%(levelname)s: %(message)s")
    log = log_console()
    try:
        config = read_config(options.config, options.set)
        categories = _categories(options)
        cache = Path(options.cache) if options.cache else default_folder()
        cache.mkdir(parents=True, exist_ok=True)  # now, not after minutes of scanning
        folder = make_folder(options.out, scene_name="bench-walls", first_file="result.json")
        with Workers(options.backend, options.jobs or default_jobs()) as workers, progress_bar(log) as progress:
            run = partial(run_tasks, workers, progress)
            judged = judge(
                generate(list(dict.fromkeys(options.seed)), categories, run=run),
                variants(config, ablate=options.ablate, sweep=options.sweep),
                cache=cache,
                run=run,
            )
        report = BenchReport(judged, ablate=options.ablate, sweep=options.sweep, config=config)
        print_tables(report.tables())
        write_report(folder, report)
    except (SimError, MissionError, OSError) as error:
        return refuse(error)
    except DetectorError as error:
        print(f"error: {error}", file=sys.stderr)
        return FAILED
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        return INTERRUPTED
    log.print(f"doors.csv, result.json and pictures:  {folder}", highlight=False, markup=False, soft_wrap=True)
    log.print(
        f"open the recording:  {viewer_command(folder / 'walls.rrd')}", highlight=False, markup=False, soft_wrap=True
    )
    return DONE


def generate(seeds: Sequence[int], categories: Collection[str] | None, *, run: Runner) -> list[tuple[int, BenchRoom]]:
    """The rooms of all seeds, each with its seed."""
    generated = run("generating", {f"seed {seed}": partial(rooms, seed, categories) for seed in seeds})
    return [(seed, room) for seed, built in zip(seeds, generated, strict=True) for room in built]


def judge(
    chosen: Sequence[tuple[int, BenchRoom]],
    configs: dict[Variant, MissionConfig],
    *,
    cache: Path,
    run: Runner,
) -> Judged:
    """Judge rooms in all variants.

    Args:
        chosen: Rooms with their seeds.
        configs: Parameters of each variant; they differ in the detector's only.
        cache: Folder of scanned rooms.
        run: Runs the tasks.

    Returns:
        Judgements by variant, in the order of rooms and their walls.
    """
    if len(configs) > 1:  # else each room is scanned when it is judged
        config = next(iter(configs.values()))
        run(
            "scanning",
            {
                f"{room.name}, seed {seed}": partial(_scan, room, config, seed=seed, folder=cache)
                for seed, room in chosen
            },
        )
    tasks = {
        f"{room.name}, seed {seed}, {variant}": partial(judge_room, room, config, seed=seed, cache=cache)
        for variant, config in configs.items()
        for seed, room in chosen
    }
    judged = run("detecting", tasks)
    count = len(chosen)
    return {
        variant: [judgement for walls in judged[k * count : (k + 1) * count] for judgement in walls]
        for k, variant in enumerate(configs)
    }


def _scan(room: BenchRoom, config: MissionConfig, *, seed: int, folder: Path) -> None:
    """Put a room into the cache; that it cannot be scanned is told when it is judged."""
    try:
        cached_scan(room, config, seed=seed, folder=folder)
    except MissionError:
        logging.getLogger(__name__).info("room %s cannot be scanned", room.name)


def _categories(options: argparse.Namespace) -> tuple[str, ...] | None:
    """Those that were asked for; None for all.

    Raises:
        UsageError: There is no such category.
    """
    if not options.category:
        return ("specular",) if options.ablate == "highlights" else None
    for category in options.category:
        if category not in CATEGORIES:
            raise UsageError(f"--category {category!r}: known are {', '.join(map(repr, CATEGORIES))}")
    return tuple(dict.fromkeys(options.category))
