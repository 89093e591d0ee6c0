"""The command `run`: one mission, its sinks, its files and its exit status."""

from __future__ import annotations

import argparse
import json
import logging
import math
import sys
from collections.abc import Iterable, Iterator, Mapping
from contextlib import ExitStack
from pathlib import Path
from time import perf_counter

from rich.console import Console

import assets
from mission.config import MissionConfig, read_config
from mission.errors import MissionError, UsageError
from mission.events import Event
from mission.interrupts import Interrupts
from mission.mission import Mission
from mission.progress import TerminalProgress
from mission.report import Report, write_json
from mission.sink import Sink
from mission.stopwatch import Stopwatch
from sim.errors import SimError
from sim.scene import Scene, load_scene

logger = logging.getLogger(__name__)

DONE, BELOW, BAD_INPUT, FAILED, INTERRUPTED = 0, 1, 2, 3, 130
"""Exit status."""

LOG_WIDTH = 120
"""Of what is printed where no terminal tells its width, such as on a CI machine."""

METRICS = ("recall", "precision", "found", "coverage")
"""What --fail-under knows: larger is better, 1 is perfect."""


def run(options: argparse.Namespace) -> int:
    """Run a mission as the command line says and return the exit status."""
    start = perf_counter()
    logging.basicConfig(level=logging.ERROR, format="%(levelname)s %(name)s: %(message)s")
    wide = None if sys.stderr.isatty() else LOG_WIDTH
    console = Console(stderr=True, quiet=options.quiet or options.json, width=wide)
    try:
        bars = dict(_setting("--fail-under", text) for text in options.fail_under)
        _check_metrics(bars)
        settings = [*options.set, *([f"planning.max_scans={options.max_scans}"] if options.max_scans else [])]
        config = read_config(options.config, settings)
        angles = {name: math.radians(angle) for name, angle in (_setting("--door", text) for text in options.door)}
        scene = load_scene(find_scene(options.scene), door_angles=angles, keyframe=options.keyframe)
        folder = make_folder(options.out, scene_name=options.scene)
        report, status = carry_out(scene, config, seed=options.seed, folder=folder, console=console, start=start)
    except (SimError, MissionError) as error:
        print(f"error: {' '.join(str(error).split())}", file=sys.stderr)
        return BAD_INPUT
    if options.json:
        summary = json.loads((folder / "summary.json").read_text())
        print(json.dumps({"doors": report.doors(), "summary": summary}, indent=2))
    console.print(f"open the recording:  rerun {folder / 'mission.rrd'}", highlight=False, soft_wrap=True)
    return status or _judge(report, bars)


def carry_out(
    scene: Scene, config: MissionConfig, *, seed: int, folder: Path, console: Console, start: float
) -> tuple[Report, int]:
    """Run the mission into all sinks; whatever happens, the files are complete at the end.

    Returns:
        What was found, and the exit status.
    """
    from mission.recording.mcap_sink import McapSink
    from mission.recording.rerun_sink import RerunSink

    report = Report()
    progress = TerminalProgress(console)
    stopwatch = Stopwatch(progress.stage)
    with Interrupts() as interrupts:
        with ExitStack() as stack:
            mission = stack.enter_context(Mission(scene, config, seed=seed, stopwatch=stopwatch))
            sinks: list[Sink] = [
                stack.enter_context(progress),
                report,
                stack.enter_context(RerunSink(folder / "mission.rrd")),
                stack.enter_context(McapSink(folder / "mission.mcap")),
            ]
            status = _pump(mission, sinks, interrupts, stopwatch)
            with stopwatch("recording"):
                stack.close()
        write_json(folder / "doors.json", report.doors())
        write_json(folder / "summary.json", report.summary(stopwatch.seconds, perf_counter() - start))
    return report, status


def _pump(mission: Mission, sinks: Iterable[Sink], interrupts: Interrupts, stopwatch: Stopwatch) -> int:
    """Hand every event to every sink; end the stream properly if the mission is stopped or breaks."""
    status = DONE
    events = _events(mission, interrupts)
    try:
        for event in events:
            _hand_out(event, sinks, stopwatch)
    except KeyboardInterrupt:
        status = INTERRUPTED
        _hand_out(mission.finished("interrupted", "stopped by the user"), sinks, stopwatch)
    except MissionError as error:
        status = FAILED
        print(f"error: {error}", file=sys.stderr)
        _hand_out(mission.finished("failed", str(error)), sinks, stopwatch)
    except Exception as error:  # a defect of ours: say so in full, after the recordings are safe
        status = FAILED
        logger.exception("the mission broke")
        _hand_out(mission.finished("failed", f"{type(error).__name__}: {error}"), sinks, stopwatch)
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


def _hand_out(event: Event, sinks: Iterable[Sink], stopwatch: Stopwatch) -> None:
    with stopwatch("recording"):
        for sink in sinks:
            sink.handle(event)


def find_scene(scene: str) -> Path:
    """The scene file: a path, or else a name in assets/rooms/.

    Raises:
        UsageError: There is no such file.
    """
    rooms = assets.FOLDER / "rooms"
    for path in (Path(scene), rooms / scene):
        if path.is_file():
            return path
    shipped = ", ".join(sorted(path.name for path in rooms.glob("*.xml")))
    raise UsageError(f"no such scene: {scene} (shipped scenes: {shipped})")


def make_folder(out: Path | None, *, scene_name: str) -> Path:
    """Make the folder for the results.

    Raises:
        UsageError: It cannot be made or written.
    """
    try:
        if out is None:
            runs, stem = Path("runs"), Path(scene_name).stem
            number = next(n for n in range(1, sys.maxsize) if not (runs / f"{stem}-{n}").exists())
            out = runs / f"{stem}-{number}"
        out.mkdir(parents=True, exist_ok=True)
        for name in ("mission.rrd", "mission.mcap", "doors.json", "summary.json"):
            (out / name).unlink(missing_ok=True)
        (out / "mission.rrd").touch()
    except OSError as error:
        raise UsageError(f"cannot write the results: {error.strerror}: {error.filename}") from error
    return out


def _setting(option: str, text: str) -> tuple[str, float]:
    name, equals, value = text.rpartition("=")
    try:
        number = float(value)
    except ValueError:
        number = math.nan
    if not equals or not name or not math.isfinite(number):
        raise UsageError(f"{option} {text}: expected NAME=NUMBER")
    return name, number


def _check_metrics(bars: Mapping[str, float]) -> None:
    for name in bars:
        if name not in METRICS:
            raise UsageError(f"--fail-under {name}: unknown metric; known: {', '.join(METRICS)}")


def _judge(report: Report, bars: Mapping[str, float]) -> int:
    """Compare the metrics with the bars; a metric that has no value, such as precision without doors, passes."""
    metrics = report.metrics()
    if metrics["doors"]:
        metrics["found"] = (metrics["found"] or 0) / metrics["doors"]
    else:
        metrics["found"] = None
    status = DONE
    for name, bar in bars.items():
        value = metrics[name]
        if value is not None and value < bar:
            print(f"below --fail-under: {name} is {value:.4f}, asked for {bar:g}", file=sys.stderr)
            status = BELOW
    return status
