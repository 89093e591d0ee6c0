"""What can go wrong in a mission."""

from __future__ import annotations

from pathlib import Path
from shutil import disk_usage

_FULL = 2**20
"""A disk with less space is full [bytes]."""


class MissionError(Exception):
    """The mission cannot go on; the message says why in one line."""


class UsageError(MissionError):
    """The command line, a configuration or an output folder is wrong; the message says what and where in one line."""


class RecordingError(MissionError):
    """A recording cannot be written; the message says which and why in one line."""

    def __init__(self, path: Path, reason: object) -> None:
        full = disk_usage(path.parent).free < _FULL
        super().__init__(f"cannot write {path}: {'no space left on the disk' if full else reason}")
