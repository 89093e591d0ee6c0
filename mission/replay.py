"""The commands `replay` and `recover`: a recorded mission told again, judged again, or saved from a damaged file."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from pathlib import Path
from time import perf_counter

from detector.room import DetectorError
from mission.comparison import doors_compared, doors_differ
from mission.config import changed_config
from mission.errors import MissionError, UsageError
from mission.events import Event, MissionStarted
from mission.folders import DONE, FAILED, INTERRUPTED, make_folder, viewer_command
from mission.memory import release_freed_memory
from mission.progress import TerminalProgress
from mission.recording.mcap_reader import DamagedError, read_events
from mission.recording.mcap_sink import McapSink
from mission.redetection import UNUSED, USED, Redetection
from mission.report import Report, write_json
from mission.sink import Sink
from mission.stopwatch import Stopwatch
from mission.terminal import log_console, refuse, result_console

RECORDING = "mission.mcap"
"""Name of a recording in a folder of results."""


def replay(options: argparse.Namespace) -> int:
    """Tell a recorded mission again as the command line says, and return the exit status."""
    start = perf_counter()
    path = Path(options.recording)
    console = log_console(quiet=options.quiet)
    progress = TerminalProgress(console)
    stopwatch = Stopwatch(progress.stage)
    before = Report()
    try:
        if options.set and not options.redetect:
            raise UsageError("--set changes nothing without --redetect")
        events = _noted(read_events(path, without=UNUSED if options.redetect else ()), before)
        first = _first(events, path)
        if options.redetect:
            _check_used(options.set)
            config = changed_config(first.config, options.set)
            told = Redetection(first, config, stopwatch=stopwatch).run(events)
        else:
            told = _with(first, events)
        folder = _folder(options.out, path, "replay", ("mission.rrd", RECORDING, "doors.json", "summary.json"))
    except MissionError as error:
        return refuse(error)
    report = Report()
    with ExitStack() as files:
        files.callback(_write_reports, folder, report, path, stopwatch, start)
        sinks: list[Sink] = [report, files.enter_context(progress)]
        from mission.recording.rerun_sink import RerunSink

        sinks.append(files.enter_context(RerunSink(folder / "mission.rrd")))
        if options.redetect:
            sinks.append(files.enter_context(McapSink(folder / RECORDING)))
        status = _tell(told, sinks, stopwatch)
    if options.redetect and status == DONE:
        told_apart = (
            doors_compared(before, report, "then", "now") if doors_differ(before, report) else "no door differs"
        )
        result_console().print(told_apart)
    console.print(f"open the recording:  {viewer_command(folder / 'mission.rrd')}", highlight=False, soft_wrap=True)
    if not before.registrations and status == DONE:
        return refuse(UsageError(f"{path} holds no scan"))
    return status


def recover(options: argparse.Namespace) -> int:
    """Write what can be read of a recording into a clean one, and return the exit status."""
    path = Path(options.recording)
    console = log_console(quiet=options.quiet)
    try:
        events = read_events(path)
        first = _first(events, path)
        folder = _folder(options.out, path, "recovered", (path.name,))
        saved = folder / path.name
        last: Event = first
        fault = "nothing was wrong with it"
        with McapSink(saved) as sink:
            try:
                for last in _with(first, events):
                    sink.handle(last)
                    release_freed_memory()
            except DamagedError as error:
                fault = str(error)
    except (MissionError, OSError) as error:
        return refuse(error)
    console.print(fault, highlight=False, soft_wrap=True)
    console.print(f"{last.step + 1} events are saved in {saved}", highlight=False, soft_wrap=True)
    return DONE


def _check_used(settings: Sequence[str]) -> None:
    """Refuse parameters that would be recorded and change nothing."""
    for setting in settings:
        if not setting.startswith(tuple(f"{part}." for part in USED)):
            raise UsageError(f"--set {setting}: --redetect does not do this again; it uses {', '.join(USED)}")


def _first(events: Iterator[Event], path: Path) -> MissionStarted:
    first = next(events, None)
    if not isinstance(first, MissionStarted):
        raise UsageError(f"{path} does not begin with the start of a mission")
    return first


def _with(first: Event, events: Iterator[Event]) -> Iterator[Event]:
    yield first
    yield from events


def _noted(events: Iterator[Event], report: Report) -> Iterator[Event]:
    """The same events, which a report takes note of."""
    for event in events:
        report.handle(event)
        yield event


def _folder(out: str | None, path: Path, what: str, targets: Sequence[str]) -> Path:
    """Where the results go: never where the recording is, nor over it by another name.

    Args:
        out: As the user has it.
        path: The recording.
        what: Is done with it.
        targets: Names of the files that are written.
    """
    name = path.resolve().parent.name if path.name == RECORDING else path.stem
    if out is not None and Path(out).resolve() == path.resolve().parent:
        raise UsageError(f"--out {out} is the folder of the recording itself")
    for target in (Path(out) / target for target in targets if out is not None):
        if target.exists() and target.samefile(path):
            raise UsageError(f"--out {out}: {target} is the recording itself")
    return make_folder(out, scene_name=f"{name}-{what}.mcap", first_file=targets[0])


def _tell(told: Iterator[Event], sinks: list[Sink], stopwatch: Stopwatch) -> int:
    """Hand every event to every sink."""
    try:
        for event in told:
            with stopwatch("recording"):
                for sink in sinks:
                    sink.handle(event)
            release_freed_memory()
    except KeyboardInterrupt:
        return INTERRUPTED
    except UsageError as error:
        return refuse(error)
    except (MissionError, DetectorError, OSError) as error:
        print(f"error: {error}", file=sys.stderr)
        return FAILED
    return DONE


def _write_reports(folder: Path, report: Report, path: Path, stopwatch: Stopwatch, start: float) -> None:
    write_json(folder / "doors.json", report.doors())
    summary = report.summary(stopwatch.seconds, perf_counter() - start)
    write_json(folder / "summary.json", {"arguments": sys.argv[1:], "replayed": str(path)} | summary)
