"""The mission as a Rerun recording: what a person looks at."""

from __future__ import annotations

import hashlib
import logging
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path
from types import TracebackType
from typing import Self

import numpy as np
import rerun as rr

from mission.errors import RecordingError
from mission.events import DoorsDetected, DoorsEvaluated, Event, MissionStarted, Structured
from mission.recording import entities
from mission.recording.blueprint import WallTab, blueprint, outlook
from mission.recording.drawing import outline
from mission.recording.live import Stream, flush
from mission.recording.rerun_clouds import Clouds
from mission.recording.rerun_costs import Costs
from mission.recording.rerun_doors import Doors
from mission.recording.rerun_photos import Photos
from mission.recording.rerun_plans import Plans
from mission.recording.rerun_plots import Plots
from mission.recording.rerun_results import Results
from mission.recording.rerun_rooms import Rooms
from mission.recording.rerun_walls import Walls
from mission.recording.rerun_world import World

logger = logging.getLogger(__name__)

APPLICATION = "door-mission"

_Drawer = World | Clouds | Plans | Doors | Photos | Walls | Rooms | Plots | Results | Costs
_DRAWERS = (World, Clouds, Plans, Doors, Photos, Walls, Rooms, Plots, Results, Costs)


class RerunSink:
    """Writes every event to an .rrd file as it happens; the layout of the viewer is inside.

    Timelines: `step` counts events and is the axis to review on (detection takes no mission time), `mission_time`
    is simulated time, `scan` and `room` count. Wall clock times are not recorded, save those that the detector took.
    """

    def __init__(self, path: Path, streams: Sequence[Stream] = ()) -> None:
        """Record into a file, which is overwritten; it is opened by the first event.

        Args:
            path: Of the file.
            streams: To viewers that follow; the file does not suffer when they go away.
        """
        self._path = path
        self._streams = tuple(streams)
        self._followed = True
        self._closing = ExitStack()
        self._drawers: list[_Drawer] = []
        self._scan_number = 0
        self._outlook = outlook(np.zeros((1, 3)))
        self._walls: list[WallTab] = []
        self._shown: tuple[WallTab, ...] = ()
        self._broken = False
        self._known_rooms: set[int] = set()
        self._judged_rooms: set[int] = set()

    def __enter__(self) -> Self:
        self._closing.callback(rr.set_strict_mode, rr.strict_mode())  # it is global, and not ours
        rr.set_strict_mode(True)  # a mistake in what is logged is an error, not a warning nobody reads
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        with self._closing:
            if self._shown != tuple(self._walls):
                self._send_layout(self._walls)

    def handle(self, event: Event) -> None:
        """Record one event; when this returns, the event is in the file.

        Raises:
            RecordingError: The file cannot be written; what comes after is lost.
        """
        if self._broken:
            return
        if not self._drawers:
            self._open(event)
        self._scan_number = getattr(event, "scan_number", self._scan_number)
        self._rec.set_time("step", sequence=event.step)
        self._rec.set_time("mission_time", duration=np.timedelta64(event.time, "ns"))
        self._rec.set_time("scan", sequence=self._scan_number)
        self._rec.set_time("room", sequence=event.room)
        for drawer in self._drawers:
            drawer.draw(event)
        self._lay_out(event)
        self._flush()

    def _flush(self) -> None:
        if self._broken:
            return
        try:
            followed = flush(self._rec, streams=self._streams)
        except RuntimeError as failure:
            self._broken = True
            raise RecordingError(self._path, failure) from failure
        if self._followed and not followed:
            logger.warning("a viewer is gone; the recording goes on")
        self._followed = followed

    def _open(self, first: Event) -> None:
        """Open the file; its id tells the viewer whether two recordings are one."""
        mission = (Path(first.scene).stem, str(first.seed)) if isinstance(first, MissionStarted) else ()
        place = hashlib.sha256(str(self._path.resolve()).encode()).hexdigest()[:8]
        self._rec = rec = rr.RecordingStream(APPLICATION, recording_id="-".join([*mission, place]))
        rec.set_log_time_enabled(False)
        rec.set_sinks(rr.FileSink(self._path), *self._streams)  # in this order: see flush
        self._closing.callback(rec.disconnect)  # writes the footer
        self._closing.callback(self._flush)
        legend = [rr.AnnotationInfo(number, label, colour) for number, label, colour in entities.LEGEND]
        for root in (entities.WORLD, entities.STAGES_OF_WALLS):
            rec.log(root, rr.AnnotationContext(legend), static=True)
        self._drawers = [drawer(rec) for drawer in _DRAWERS]

    def _lay_out(self, event: Event) -> None:
        """Fit the viewer's layout to what is known by now: an interrupted recording opens well, too.

        A layout takes space, and a viewer its time: there is one a room, with the walls of this room until the end.
        """
        match event:
            case MissionStarted():
                self._rec.send_recording_name(f"{event.scene}, seed {event.seed}")
                place = event.world_from_base[:3, 3]
                self._outlook = outlook(np.array([place - 3.0, place + 3.0]))
                self._send_layout(())
            case Structured() if event.structure.walls and event.room not in self._known_rooms:
                self._known_rooms.add(event.room)
                outlines = [outline(wall) for wall in event.structure.walls]
                first = len(self._known_rooms) == 1
                self._outlook = outlook(np.concatenate([*([] if first else [self._outlook.seen]), *outlines]))
                if first:
                    self._send_layout(())
            case DoorsDetected():
                self._walls += _wall_tabs(event)
            case DoorsEvaluated() if event.room not in self._judged_rooms:  # a room that links move is judged again
                self._judged_rooms.add(event.room)
                leaves = [leaf for door in event.doors for leaf in door.leaf_corners_in_world]
                self._outlook = outlook(np.concatenate([self._outlook.seen, *leaves]))
                self._send_layout([wall for wall in self._walls if wall.room == event.room and wall.has_doors])

    def _send_layout(self, walls: Sequence[WallTab]) -> None:
        self._shown = tuple(walls)
        self._rec.send_blueprint(blueprint(self._outlook, walls))


def _wall_tabs(event: DoorsDetected) -> list[WallTab]:
    """A tab a wall; each opens with the view that has the largest highlight."""
    return [
        WallTab(
            room=event.room,
            name=entities.wall_name(event.room, number),
            views=len(result.views),
            first_view=int(np.argmax([h.regions.sum() for h in result.highlights])) if result.views else None,
            has_doors=bool(result.doors),
            shape=(result.merged.depth.shape[0], result.merged.depth.shape[1]),
        )
        for number, result in enumerate(event.results, start=1)
    ]
