"""What a mission takes of this machine, in the Rerun recording: time a stage, and memory."""

from __future__ import annotations

import rerun as rr

from mission.events import DoorsEvaluated, Event, MissionFinished, MissionStarted, Planned
from mission.memory import peak_memory
from mission.recording import entities
from mission.recording.rerun_figures import draw_bars
from mission.stopwatch import Stopwatch


class Costs:
    """Draws wall clock time and memory, all of it below /timing: no two runs have the same."""

    def __init__(self, rec: rr.RecordingStream, stopwatch: Stopwatch) -> None:
        """Draw into a recording what a stopwatch has counted."""
        self._rec, self._stopwatch = rec, stopwatch

    def draw(self, event: Event) -> None:
        """Draw what it took up to an event, scan by scan."""
        match event:
            case MissionStarted():
                line, points = rr.SeriesLines(names="most so far", widths=2.0), rr.SeriesPoints(markers="circle")
                self._rec.log(entities.MEMORY, line, points, static=True)
            case Planned() | DoorsEvaluated() | MissionFinished():
                self._rec.log(entities.MEMORY, rr.Scalars(peak_memory() / 1e6))
                rows = [(stage, seconds, f"{seconds:.1f} s") for stage, seconds in self._stopwatch.seconds.items()]
                draw_bars(self._rec, entities.MISSION_STAGES, rows)
