"""The command `compare`: two recorded missions side by side."""

from __future__ import annotations

import argparse
from pathlib import Path

from rich.box import SIMPLE_HEAD
from rich.markup import escape
from rich.table import Table

from mission.comparison import differences, doors_compared, doors_differ, stage_times
from mission.errors import MissionError
from mission.events import Coloured, DoorsDetected, Photographed, Scanned
from mission.folders import BELOW, DONE
from mission.recording.mcap_reader import read_events
from mission.report import Report
from mission.terminal import refuse, result_console


def compare(options: argparse.Namespace) -> int:
    """Print what differs, and return 1 if anything does."""
    try:
        paths = Path(options.first), Path(options.second)
        first, second = map(_report, paths)
    except MissionError as error:
        return refuse(error)
    console = result_console()
    rows = differences(first, second)
    for title, lines in (("the missions", rows), ("wall clock, no two runs have the same", stage_times(*paths))):
        if lines:
            table = Table("what", "A", "B", title=title, title_justify="left", box=SIMPLE_HEAD, pad_edge=False)
            for line in lines:
                table.add_row(*map(escape, line))
            console.print(table)
    changed = doors_differ(first, second)
    if changed:
        console.print(doors_compared(first, second, "A", "B"))
    if not rows and not changed:
        console.print("nothing differs")
    return BELOW if rows or changed else DONE


def _report(path: Path) -> Report:
    report = Report()
    for event in read_events(path, without=(Scanned, Photographed, Coloured, DoorsDetected)):
        report.handle(event)
    return report
