"""Tables of benchmarks in the terminal."""

from __future__ import annotations

import sys
from collections.abc import Sequence

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table
from rich.text import Text

from mission.bench.walls.tables import BenchTable

TABLE_WIDTH = 150
"""Where no terminal tells its width."""


def print_tables(tables: Sequence[BenchTable]) -> None:
    """Print them one below the other."""
    console = Console(width=None if sys.stdout.isatty() else TABLE_WIDTH)
    for table in tables:
        shown = Table(title=table.title, title_justify="left", box=SIMPLE_HEAD, show_edge=False, pad_edge=False)
        for place, column in enumerate(table.header):
            shown.add_column(Text(column), justify="right" if place else "left")
        for row in table.rows:
            shown.add_row(*map(Text, row))
        console.print(shown)
        console.print()
