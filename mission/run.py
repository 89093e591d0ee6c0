"""The command `run`: one mission, its sinks, its files and its exit status."""

from __future__ import annotations

import argparse
import json
import logging
import math
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING

from detector.room import DetectorError
from mission.config import read_config
from mission.errors import MissionError, RecordingError, UsageError
from mission.events import Event
from mission.folders import (
    BELOW,
    DONE,
    FAILED,
    INTERRUPTED,
    make_folder,
    sole_use,
    viewer_command,
)
from mission.interrupts import Interrupts
from mission.mission import Mission
from mission.order import Order, read_order, write_order
from mission.progress import TerminalProgress
from mission.recording.cost import recording_cost
from mission.report import Report, write_json
from mission.resumption import Earlier, forget, is_complete, set_aside
from mission.scene_file import find_scene
from mission.sink import SideBySide, Sink
from mission.stopwatch import Stopwatch
from mission.terminal import log_console, refuse
from sim.errors import SimError
from sim.obstacles import Obstacle
from sim.scene import Scene, load_scene

if TYPE_CHECKING:  # rerun takes a while to import
    from mission.recording.live import Stream

logger = logging.getLogger(__name__)

METRICS = ("recall", "precision", "found", "coverage")
"""What --fail-under knows: larger is better, 1 is perfect."""


def run(options: argparse.Namespace) -> int:
    """Run a mission as the command line says and return the exit status."""
    from mission.recording.live import address, live_streams

    start = perf_counter()
    silent = options.quiet or options.json
    logging.basicConfig(level=logging.ERROR if silent else logging.WARNING, format="%(levelname)s: %(message)s")
    console = log_console(quiet=silent)
    held = ExitStack()
    try:
        bars = dict(_setting("--fail-under", text) for text in options.fail_under)
        _check_metrics(bars)
        folder = _begun_folder(options)
        order = read_order(folder) if folder else _order(options)
        if folder:
            held.enter_context(sole_use(folder))
        if folder and is_complete(folder, order):
            console.print(f"the mission is complete, there is nothing to go on with: {folder}", soft_wrap=True)
            return _results(folder, bars, as_json=options.json)
        streams = live_streams(view=options.view, connect=options.connect, serve=options.serve)
        if options.serve is not None:
            console.print(f"watch the mission:  rerun {address(options.serve)}", highlight=False, soft_wrap=True)
        scene = _scene(order)
        recording = set_aside(folder, order, scene.xml) if folder else None
        progress = TerminalProgress(console)
        stopwatch = Stopwatch(progress.stage)
        earlier = Earlier(recording)
        if folder:
            kept = f"what was scanned before is taken from {recording}" if recording else "from its beginning"
            console.print(f"the mission goes on: {kept}", highlight=False, soft_wrap=True)
        with Mission(scene, order.config, seed=order.seed, stopwatch=stopwatch, earlier=earlier) as mission:
            if folder is None:
                folder = make_folder(options.out, scene_name=options.scene)
                held.enter_context(sole_use(folder))
                forget(folder)
                write_order(folder, order)
            _, status = carry_out(mission, folder, progress=progress, stopwatch=stopwatch, start=start, streams=streams)
    except (SimError, MissionError) as error:
        return refuse(error)
    finally:
        held.close()
    judged = _results(folder, bars, as_json=options.json)
    if status == INTERRUPTED:
        console.print(f"go on with it:  python -m mission run --resume {folder}", highlight=False, soft_wrap=True)
    console.print(f"open the recording:  {viewer_command(folder / 'mission.rrd')}", highlight=False, soft_wrap=True)
    return status or judged


def _results(folder: Path, bars: Mapping[str, float], *, as_json: bool) -> int:
    """Print the results in a folder if they are asked for, and compare them with the bars."""
    doors, summary = (json.loads((folder / name).read_text()) for name in ("doors.json", "summary.json"))
    if as_json:
        print(json.dumps({"doors": doors, "summary": summary}, indent=2))
    return _judge(summary["metrics"], bars)


def carry_out(
    mission: Mission,
    folder: Path,
    *,
    progress: TerminalProgress,
    stopwatch: Stopwatch,
    start: float,
    streams: Sequence[Stream] = (),
) -> tuple[Report, int]:
    """Run the mission into all sinks; whatever happens, the files are complete at the end.

    Args:
        mission: At its start.
        folder: Where the files go.
        progress: Tells a person.
        stopwatch: That the mission counts its stages with.
        start: Of the program, by `perf_counter` [s].
        streams: To viewers that follow.

    Returns:
        What was found, and the exit status.
    """
    from mission.recording.mcap_sink import McapSink
    from mission.recording.rerun_sink import RerunSink

    report = Report()
    with Interrupts() as interrupts, ExitStack() as files:
        files.callback(_write_reports, folder, report, stopwatch, start)  # last of all, whatever happens
        sinks: list[Sink] = [
            report,
            files.enter_context(progress),
            files.enter_context(RerunSink(folder / "mission.rrd", streams)),
            files.enter_context(McapSink(folder / "mission.mcap")),
        ]
        status = _pump(mission, sinks, interrupts, stopwatch)
    return report, status


def _write_reports(folder: Path, report: Report, stopwatch: Stopwatch, start: float) -> None:
    wall_clock = perf_counter() - start
    scans = sum(room.scans for room in report.rooms.values())
    cost = recording_cost(folder, scans=scans, seconds=stopwatch.seconds.get("recording", 0.0), wall_clock=wall_clock)
    summary = {"arguments": sys.argv[1:]} | report.summary(stopwatch.seconds, wall_clock) | {"recording": cost}
    for name, content in (("doors.json", report.doors()), ("summary.json", summary)):
        try:
            write_json(folder / name, content)
        except OSError as error:
            raise RecordingError(folder / name, error) from error


def _pump(mission: Mission, sinks: list[Sink], interrupts: Interrupts, stopwatch: Stopwatch) -> int:
    """Hand every event to every sink; end the stream properly if the mission is stopped or something breaks."""
    try:
        with SideBySide(sinks, stopwatch) as recording:
            for event in _events(mission, interrupts):
                recording.hand(event)
        return DONE
    except KeyboardInterrupt:
        last, status = mission.finished("interrupted", "stopped by the user"), INTERRUPTED
    except (MissionError, DetectorError, OSError) as error:
        print(f"error: {error}", file=sys.stderr)
        last, status = mission.finished("failed", str(error)), FAILED
    except Exception as error:  # a defect of ours: say so in full, after which the recordings are closed
        logger.exception("the mission broke")
        last, status = mission.finished("failed", f"{type(error).__name__}: {error}"), FAILED
    for sink in sinks:
        try:
            sink.handle(last)
        except Exception as error:  # the sink that broke the mission may break again; the others must end well
            print(f"error: the end is not recorded: {error}", file=sys.stderr)
    return status


def _events(mission: Mission, interrupts: Interrupts) -> Iterator[Event]:
    """The mission's events; Ctrl-C is raised inside the mission only, never inside a sink."""
    events = mission.run()
    while True:
        with interrupts.raised():
            event = next(events, None)
        if event is None:
            return
        yield event


def _shorthands(options: argparse.Namespace) -> list[str]:
    """Options that stand for a parameter."""
    given = {
        "planning.max_scans": options.max_scans,
        "planning.max_rooms": options.max_rooms,
        "planning.planner": options.planner,
    }
    return [f"{key}={value}" for key, value in given.items() if value is not None]


def _setting(option: str, text: str) -> tuple[str, float]:
    name, equals, value = text.rpartition("=")
    try:
        number = float(value)
    except ValueError:
        number = math.nan
    if not equals or not name or not math.isfinite(number):
        raise UsageError(f"{option} {text}: expected NAME=NUMBER")
    return name, number


def _order(options: argparse.Namespace) -> Order:
    """What the command line asks for."""
    if options.scene is None:
        raise UsageError("what is to be scanned? run SCENE, or run --resume DIR")
    obstacles = [_obstacle(text) for text in options.obstacle]
    return Order(
        scene=find_scene(options.scene),
        seed=options.seed,
        config=read_config(options.config, [*options.set, *_shorthands(options)]),
        door_angles={name: math.radians(angle) for name, angle in (_setting("--door", t) for t in options.door)},
        keyframe=options.keyframe,
        obstacles=[(obstacle.x, obstacle.y, obstacle.time) for obstacle in obstacles],
    )


def _scene(order: Order) -> Scene:
    """The scene that is asked for, as it is asked for."""
    return load_scene(
        find_scene(str(order.scene)),
        door_angles=order.door_angles,
        keyframe=order.keyframe,
        obstacles=[Obstacle(*obstacle) for obstacle in order.obstacles],
    )


def _begun_folder(options: argparse.Namespace) -> Path | None:
    """The folder of the mission to go on with; None to begin one."""
    if options.resume is None:
        return None
    others = {
        "SCENE": options.scene,
        "--out": options.out,
        "--seed": options.seed,
        "--door": options.door,
        "--obstacle": options.obstacle,
        "--keyframe": options.keyframe,
        "--config": options.config,
        "--set and the like": [*options.set, *_shorthands(options)],
    }
    if given := [name for name, value in others.items() if value]:
        raise UsageError(f"--resume takes scene, seed and parameters from its folder; leave out {', '.join(given)}")
    return Path(options.resume)


def _obstacle(text: str) -> Obstacle:
    try:
        numbers = [float(part) for part in text.split(",")]
    except ValueError:
        numbers = []
    if len(numbers) not in {2, 3} or not all(map(math.isfinite, numbers)) or (len(numbers) == 3 and numbers[2] < 0):
        raise UsageError(f"--obstacle {text}: expected X,Y in metres, or X,Y,SECONDS from the start")
    return Obstacle(*numbers)


def _check_metrics(bars: Mapping[str, float]) -> None:
    for name, bar in bars.items():
        if name not in METRICS:
            raise UsageError(f"--fail-under {name}: unknown metric; known: {', '.join(METRICS)}")
        if not 0 <= bar <= 1:
            raise UsageError(f"--fail-under {name}={bar:g}: expected a share from 0 to 1")


def _judge(metrics: Mapping[str, float | None], bars: Mapping[str, float]) -> int:
    """Compare with the bars; a missed door counts as recall 0, a false positive as precision 0, no door as nothing."""
    found, false_positives = metrics["found"] or 0, metrics["false_positives"] or 0
    values = {
        "recall": _over(metrics["recall"], found, metrics["doors"]),
        "precision": _over(metrics["precision"], found, found + false_positives),
        "found": _over(1.0, found, metrics["doors"]),
        "coverage": metrics["coverage"],
    }
    status = DONE
    for name, bar in bars.items():
        value = values[name]
        if value is not None and value < bar:
            print(f"below --fail-under: {name} is {value:.4f}, asked for {bar:g}", file=sys.stderr)
            status = BELOW
    return status


def _over(mean: float | None, found: float, count: float | None) -> float | None:
    """A mean over the found doors as one over all; None if there are none."""
    return (mean or 0.0) * found / count if count else None
