"""The command `bench planners`: explore every room with every planner, and compare."""

from __future__ import annotations

import argparse
import logging
import sys
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import get_args

import numpy as np
from numpy.typing import NDArray

import assets
from mission.bench.parallel import Workers, default_jobs
from mission.bench.planners.exploring import explore
from mission.bench.planners.report import PlannersReport, write_report
from mission.bench.planners.rooms import TrueRoom, rooms_of
from mission.bench.planners.truth import CELL, visible_structure
from mission.bench.terminal import Runner, print_tables, progress_bar, run_tasks
from mission.bench.walls.scanning import scanner_mount
from mission.candidates import PlanningParameters
from mission.config import MissionConfig, read_config
from mission.errors import MissionError
from mission.folders import DONE, INTERRUPTED, make_folder
from mission.scene_file import find_scene
from mission.terminal import log_console, refuse
from sim.errors import SimError
from sim.scene import load_scene

SCENES = ("room.xml", "flat.xml", "building.xml")
"""By default, those of them that are there."""
MAX_SCANS = 10
"""Of a room unless `planning.max_scans` says otherwise: the baselines, too, shall get to the end."""


def bench_planners(options: argparse.Namespace) -> int:
    """Run the benchmark as the command line says and return the exit status."""
    logging.basicConfig(level=logging.ERROR, format="%(levelname)s: %(message)s")
    log = log_console()
    try:
        config = for_planning(read_config(options.config, options.set))
        scenes = [find_scene(scene) for scene in options.scene or _shipped()]
        planners = options.planner or list(get_args(PlanningParameters.model_fields["planner"].annotation))
        folder = make_folder(options.out, scene_name="bench-planners", first_file="result.json")
        with Workers(options.backend, options.jobs or default_jobs()) as workers, progress_bar(log) as progress:
            run = partial(run_tasks, workers, progress)
            report = compare(
                list(dict.fromkeys(scenes)),
                list(dict.fromkeys(planners)),
                config,
                seeds=list(dict.fromkeys(options.seed)),
                run=run,
            )
        print_tables(report.tables())
        write_report(folder, report)
    except (SimError, MissionError, OSError) as error:
        return refuse(error)
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        return INTERRUPTED
    log.print(f"tables.md, result.json and pictures:  {folder}", highlight=False, markup=False, soft_wrap=True)
    return DONE


def compare(
    scenes: Sequence[Path], planners: Sequence[str], config: MissionConfig, *, seeds: Sequence[int], run: Runner
) -> PlannersReport:
    """Explore all rooms of the scenes with all planners and seeds.

    Raises:
        SimError: A scene cannot be loaded.
    """
    found = run("looking", {f"rooms of {scene.name}": partial(find_rooms, scene) for scene in scenes})
    rooms = [(scene, room) for scene, in_scene in zip(scenes, found, strict=True) for room in in_scene]
    structures = run(
        "looking",
        {f"{scene.name}, room {room.number}": partial(find_structure, scene, room) for scene, room in rooms},
    )
    tasks = {
        f"{scene.name}, room {room.number}, {planner}, seed {seed}": partial(
            explore, scene, room.number, room.world_from_base, cells, using(config, planner), seed=seed
        )
        for (scene, room), cells in zip(rooms, structures, strict=True)
        for planner in planners
        for seed in seeds
    }
    areas = {
        (scene.name, room.number): len(cells) * CELL**2 for (scene, room), cells in zip(rooms, structures, strict=True)
    }
    return PlannersReport(run("exploring", tasks), areas, config)


def find_rooms(scene: Path) -> list[TrueRoom]:
    """The rooms of a scene."""
    return rooms_of(load_scene(scene))


def find_structure(scene: Path, room: TrueRoom) -> NDArray[np.float64]:
    """(C, 3) cells of a room's visible structure."""
    return visible_structure(load_scene(scene), room, scanner_mount())


def for_planning(config: MissionConfig) -> MissionConfig:
    """Draft scans, which plan alike, and scans enough for the baselines, unless they were set otherwise."""
    scanner, planning = config.scanner, config.planning
    if "pattern" not in scanner.model_fields_set:
        scanner = scanner.model_copy(update={"pattern": "draft"})
    if "max_scans" not in planning.model_fields_set:
        planning = planning.model_copy(update={"max_scans": MAX_SCANS})
    return config.model_copy(update={"scanner": scanner, "planning": planning})


def using(config: MissionConfig, planner: str) -> MissionConfig:
    """The configuration with another planner."""
    return config.model_copy(update={"planning": config.planning.model_copy(update={"planner": planner})})


def _shipped() -> list[str]:
    return [scene for scene in SCENES if (assets.FOLDER / "rooms" / scene).is_file()]
