"""Where results go, and the exit status of commands."""

from __future__ import annotations

import fcntl
import os
import shutil
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import count
from pathlib import Path

from mission.errors import UsageError

DONE, BELOW, BAD_INPUT, FAILED, INTERRUPTED = 0, 1, 2, 3, 130
"""Exit status."""


def make_folder(out: str | None, *, scene_name: str, first_file: str = "mission.rrd") -> Path:
    """Make the folder for the results.

    Args:
        out: As the user has it; None for runs/<scene>-<n>.
        scene_name: Names it where the user does not.
        first_file: That is written into it.

    Raises:
        UsageError: It cannot be made or written.
    """
    try:
        if out is None:
            return _numbered(Path("runs"), Path(scene_name).stem)
        if not out:
            raise UsageError("--out: the name of the folder is empty")
        folder = Path(out)
        folder.mkdir(parents=True, exist_ok=True)
        (folder / first_file).open("ab").close()  # can it be written?
    except OSError as error:
        raise UsageError(f"cannot write the results: {error.strerror}: {error.filename}") from error
    return folder


def _numbered(runs: Path, stem: str) -> Path:
    """A new folder of the next free number, which nobody else has taken meanwhile."""
    runs.mkdir(exist_ok=True)
    for number in count(1):
        folder = runs / f"{stem}-{number}"
        try:
            folder.mkdir()
        except FileExistsError:
            continue
        return folder
    raise AssertionError("unreachable")


@contextmanager
def sole_use(folder: Path) -> Iterator[None]:
    """Hold a folder for one mission; when its process ends, however it ends, the folder is free again.

    Raises:
        UsageError: Another mission is at work in it.
    """
    place = os.open(folder, os.O_RDONLY)
    try:
        fcntl.flock(place, fcntl.LOCK_EX | fcntl.LOCK_NB)
        yield
    except BlockingIOError as error:
        raise UsageError(f"a mission is still at work in this folder: {folder}") from error
    finally:
        os.close(place)


def viewer_command(recording: Path) -> str:
    """What opens a recording: the viewer on the path, or else the one beside this Python."""
    viewer = "rerun" if shutil.which("rerun") else str(Path(sys.executable).with_name("rerun"))
    return f"{viewer} {recording}"
