"""A mission that was stopped, gone on with: it is carried out again with what its scanner and camera delivered before.

Drives are driven again, for the physics has no other way back to where it was; they come out the same. Scans and
photographs, which take the time, are those of the interrupted recording as long as they were taken at the same places.
"""

from __future__ import annotations

import logging
from collections.abc import Iterator
from itertools import count
from pathlib import Path

import numpy as np

from mission.errors import UsageError
from mission.events import Event, MissionFinished, MissionStarted, Photographed, Registered, Scanned
from mission.order import Order
from mission.recording.kinds import EVENTS
from mission.recording.mcap_reader import DamagedError, read_events
from mission.rigid import Pose
from sim.photo import Photo
from sim.scan import Scan

logger = logging.getLogger(__name__)

RECORDINGS = ("mission.mcap", "mission.rrd")
RESULTS = ("doors.json", "summary.json")


class Earlier:
    """What an interrupted mission measured, in its order; nothing of a mission that is new."""

    def __init__(self, recording: Path | None = None) -> None:
        """Look into the recording of the same mission, which may end anywhere."""
        self._events = _readable(recording, Scanned, Photographed) if recording else iter(())
        self._next = next(self._events, None)

    def scan(self, true_world_from_scanner: Pose) -> Scan | None:
        """The next scan, if it was taken from the very same pose (4, 4)."""
        event = self._next
        if not isinstance(event, Scanned):
            return None
        if not np.array_equal(event.true_world_from_scanner, true_world_from_scanner):
            logger.warning(
                "the robot is elsewhere than it was for scan %d: all else is measured anew", event.scan_number
            )
            self._next = None
            return None
        self._next = next(self._events, None)
        return event.scan

    def photos(self) -> tuple[Photo, ...] | None:
        """The photographs of the scan just given."""
        event = self._next
        if not isinstance(event, Photographed):
            return None
        self._next = next(self._events, None)
        return event.photos


def set_aside(folder: Path, order: Order, scene_xml: str) -> Path | None:
    """Rename the recordings of an interrupted mission, so that they are not lost.

    Args:
        folder: Of the mission.
        order: What was asked for: recordings of anything else are left alone.
        scene_xml: The scene as it is now.

    Returns:
        Of all that were ever set aside, the MCAP with the most scans; None if there is none.

    Raises:
        UsageError: The scene has changed since; then nothing is renamed.
    """
    first = _start(folder / RECORDINGS[0])
    if first is not None and _is_of(first, order) and first.scene_xml != scene_xml:
        raise UsageError(f"the scene has changed since, so the mission cannot go on: {first.scene}")
    number = next(n for n in count(1) if not any(_aside(folder, name, n).exists() for name in RECORDINGS))
    for name in RECORDINGS:
        if (folder / name).exists():
            (folder / name).rename(_aside(folder, name, number))
    kept = [_aside(folder, RECORDINGS[0], n) for n in range(1, number + 1)]
    starts = {path: _start(path) for path in kept}
    own = [path for path, start in starts.items() if start and _is_of(start, order) and start.scene_xml == scene_xml]
    return max(own, key=_scans, default=None)


def forget(folder: Path) -> None:
    """Remove what earlier missions into the same folder have set aside: theirs are replaced, too."""
    for name in RECORDINGS:
        stem, _, suffix = name.partition(".")
        for path in folder.glob(f"{stem}.interrupted-*.{suffix}"):
            path.unlink()


def is_complete(folder: Path, order: Order) -> bool:
    """Whether the mission that was asked for came to its end and nothing is missing."""
    if not all((folder / name).exists() for name in (*RECORDINGS, *RESULTS)):
        return False
    first = _start(folder / RECORDINGS[0])
    if first is None or not _is_of(first, order):
        return False
    last = next(_readable(folder / RECORDINGS[0], MissionFinished), None)
    return isinstance(last, MissionFinished) and last.outcome == "completed"


def _start(recording: Path) -> MissionStarted | None:
    """How a recording begins; None if nobody can tell."""
    first = next(_readable(recording, MissionStarted), None) if recording.exists() else None
    return first if isinstance(first, MissionStarted) else None


def _is_of(started: MissionStarted, order: Order) -> bool:
    """Whether a mission is the one that was asked for, as far as its start tells."""
    return started.seed == order.seed and started.config == order.config.model_dump(mode="json")


def _aside(folder: Path, name: str, number: int) -> Path:
    stem, _, suffix = name.partition(".")
    return folder / f"{stem}.interrupted-{number}.{suffix}"


def _scans(recording: Path) -> int:
    return sum(1 for _ in _readable(recording, Registered))


def _readable(recording: Path, *kinds: type[Event]) -> Iterator[Event]:
    """The events of some kinds, up to where the file ends or is damaged."""
    try:
        yield from read_events(recording, without=[kind for kind in EVENTS.values() if kind not in kinds])
    except DamagedError:
        return
    except UsageError as error:
        logger.warning("nothing can be taken from the interrupted recording: %s", error)
