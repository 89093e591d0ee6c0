"""What commands say at the terminal, and how they refuse."""

from __future__ import annotations

import sys

from rich.console import Console

from mission.folders import BAD_INPUT

LOG_WIDTH = 120
"""Of what is printed where no terminal tells its width, such as on a CI machine."""


def log_console(*, quiet: bool = False) -> Console:
    """Standard error, for what a person is told, so that results can be piped."""
    return Console(stderr=True, quiet=quiet, width=None if sys.stderr.isatty() else LOG_WIDTH)


def result_console() -> Console:
    """Standard output, for results."""
    return Console(width=None if sys.stdout.isatty() else LOG_WIDTH)


def refuse(error: Exception) -> int:
    """Say in one line what was wrong, and return the exit status of bad input."""
    print(f"error: {' '.join(str(error).split())}", file=sys.stderr)
    return BAD_INPUT
