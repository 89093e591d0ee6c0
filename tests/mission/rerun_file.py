"""Writing recordings for the viewer, and reading them back."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rerun.chunk import RrdReader

from mission.events import Event
from mission.recording.rerun_sink import RerunSink
from tests.mission.recording_story import story

RERUN = Path(sys.executable).with_name("rerun")


def record(path: Path, events: Iterable[Event]) -> Path:
    with RerunSink(path) as sink:
        for event in events:
            sink.handle(event)
    return path


def verified(path: Path) -> bool:
    done = subprocess.run([RERUN, "rrd", "verify", path], capture_output=True, text=True)
    return "1 file verified" in done.stdout + done.stderr  # a file that is none exits 0, too


def column(path: Path, entity: str, component: str) -> list[Any]:
    """All logged values of a component, in the order of their rows."""
    values: list[Any] = []
    for chunk in RrdReader(path).store().stream().filter(content=entity).to_chunks():
        batch = chunk.to_record_batch()
        if component in batch.schema.names:
            values += batch.column(component).to_pylist()
    return values


def points(path: Path, entity: str) -> list[NDArray[np.float64]]:
    return [np.array(cloud) for cloud in column(path, entity, "Points3D:positions")]


def event_of(kind: type[Any]) -> Any:
    return next(event for event in story() if isinstance(event, kind))
