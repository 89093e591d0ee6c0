"""What a mission takes of this machine, in the Rerun recording: time a stage, and memory."""

from __future__ import annotations

import rerun as rr

from mission.events import Event, MissionStarted
from mission.recording import entities
from mission.recording.rerun_figures import draw_bars


class Costs:
    """Draws wall clock time and memory, all of it below /timing: no two runs have the same."""

    def __init__(self, rec: rr.RecordingStream) -> None:
        """Draw into a recording."""
        self._rec = rec

    def draw(self, event: Event) -> None:
        """Draw what it took up to an event, scan by scan."""
        if isinstance(event, MissionStarted):
            line, points = rr.SeriesLines(names="most so far", widths=2.0), rr.SeriesPoints(markers="circle")
            self._rec.log(entities.MEMORY, line, points, static=True)
        if event.cost is not None:
            self._rec.log(entities.MEMORY, rr.Scalars(event.cost.peak_memory / 1e6))
            rows = [(stage, seconds, f"{seconds:.1f} s") for stage, seconds in event.cost.stage_seconds]
            draw_bars(self._rec, entities.MISSION_STAGES, rows)
