"""Whole missions and the start-up of the program, each in a process of its own."""

from __future__ import annotations

import json
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter
from typing import Any

import numpy as np

from mission.bench.speed.beams import PATTERN
from mission.bench.speed.floor import render_panorama, render_photographs
from mission.bench.speed.timing import Timing
from mission.bench.speed.worlds import World, scene_world
from mission.errors import MissionError
from sim.photo import CameraParameters
from sim.scanner import PATTERNS


@dataclass(frozen=True)
class MissionTime:
    """One mission."""

    scene: str
    pattern: str
    seconds: float
    """Wall clock of the whole program [s]."""
    stages: dict[str, float]
    """Seconds of each stage."""
    rooms: tuple[tuple[int, int, float], ...]
    """Number, scans and seconds of each room."""
    peak_memory: int
    """[bytes]"""
    bare_renders: float | None = None
    """Time of the renders alone for as many scans and photographs [s]; None if not measured."""


def time_mission(scene: str, *settings: str, bare: bool = False) -> MissionTime:
    """Run `python -m mission run SCENE` and read its summary.

    Args:
        scene: As for `run`.
        settings: Parameters, such as "scanner.pattern=draft".
        bare: Whether to time the bare renders of as many scans, too, from the scene's start.

    Raises:
        MissionError: The mission failed.
    """
    with TemporaryDirectory() as folder:
        chosen = [word for setting in settings for word in ("--set", setting)]
        start = perf_counter()
        done = _python("run", scene, "--quiet", "--out", folder, *chosen)
        seconds = perf_counter() - start
        if done.returncode:
            raise MissionError(f"run {scene} ended with status {done.returncode}: {done.stderr.strip()}")
        summary = json.loads((Path(folder) / "summary.json").read_text())
    rooms = tuple((room["id"], room["scans"], room["wall_clock_seconds"]) for room in summary["rooms"])
    return MissionTime(
        scene=scene,
        pattern=summary["config"]["scanner"]["pattern"],
        seconds=seconds,
        stages=summary["stage_seconds"],
        rooms=rooms,
        peak_memory=summary["peak_memory_bytes"],
        bare_renders=_bare_seconds(scene, summary) if bare else None,
    )


def _bare_seconds(scene: str, summary: dict[str, Any]) -> float:
    """Time of the renders of all scans and photographs of a mission [s]."""
    scans = len(summary["registration"])
    with scene_world(scene) as world:
        _render_once(world)
        times = [_render_once(world) for _ in range(3)]
    return scans * float(np.median(times))


def _render_once(world: World) -> float:
    start = perf_counter()
    render_panorama(world, PATTERNS[PATTERN])
    render_photographs(world, CameraParameters())
    return perf_counter() - start


def time_start_up(repeats: int) -> dict[str, Timing]:
    """Of `--help`, and of a mission of one draft scan from start to end."""
    with TemporaryDirectory() as folder:
        one_scan = ("run", "room.xml", "--quiet", "--max-scans", "1", "--set", "scanner.pattern=draft", "--out", folder)
        return {
            "--help": _timed(repeats, "--help"),
            "run --max-scans 1 on draft": _timed(repeats, *one_scan),
        }


def _timed(repeats: int, *arguments: str) -> Timing:
    seconds = []
    for _ in range(repeats):  # the median does not mind a cold first one
        start = perf_counter()
        done = _python(*arguments)
        if done.returncode:
            raise MissionError(f"{' '.join(arguments)} ended with status {done.returncode}: {done.stderr.strip()}")
        seconds.append(perf_counter() - start)
    return Timing(tuple(seconds))


def _python(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, "-m", "mission", *arguments], capture_output=True, text=True, check=False)
