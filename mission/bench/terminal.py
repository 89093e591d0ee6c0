"""What a person at the terminal sees of a benchmark: a bar while it runs, tables at the end."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping, Sequence
from typing import Protocol, TypeVar

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn
from rich.table import Table
from rich.text import Text

from mission.bench.parallel import Workers
from mission.bench.tables import BenchTable

TABLE_WIDTH = 150
"""Where no terminal tells its width."""

T = TypeVar("T")


class Runner(Protocol):
    """What runs tasks."""

    def __call__(self, what: str, tasks: Mapping[str, Callable[[], T]], /) -> list[T]:
        """What the tasks return, in their order; `what` and their names tell a person what goes on."""


def progress_bar(console: Console) -> Progress:
    """A bar that counts tasks."""
    return Progress(
        SpinnerColumn(),
        TextColumn("{task.description:<10}"),
        BarColumn(bar_width=24),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        console=console,
        transient=True,
    )


def run_tasks(workers: Workers, progress: Progress, what: str, tasks: Mapping[str, Callable[[], T]]) -> list[T]:
    """Run tasks behind a bar; where there is no terminal, a line tells of each."""
    names, results = list(tasks), dict[int, T]()
    for number, result in progress.track(workers.run(tasks.values()), total=len(tasks), description=what):
        results[number] = result
        if not progress.console.is_terminal:
            progress.console.print(
                f"{what} {len(results)}/{len(tasks)}: {names[number]}", highlight=False, markup=False
            )
    return [results[number] for number in range(len(tasks))]


def print_tables(tables: Sequence[BenchTable]) -> None:
    """Print tables on standard output."""
    console = Console(width=None if sys.stdout.isatty() else TABLE_WIDTH)
    for table in tables:
        console.print(_as_rich(table))
        console.print()


def _as_rich(table: BenchTable) -> Table:
    shown = Table(title=table.title, title_justify="left", box=SIMPLE_HEAD, show_edge=False, pad_edge=False)
    for place, column in enumerate(table.header):
        shown.add_column(Text(column), justify="right" if place else "left")
    for row in table.rows:
        shown.add_row(*map(Text, row), style="dim" if row[0].startswith("  ") else None)
    return shown
