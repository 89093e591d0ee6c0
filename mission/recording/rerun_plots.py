"""Plots, state lanes, log and table of the Rerun recording."""

from __future__ import annotations

from functools import singledispatchmethod
from typing import TYPE_CHECKING

import numpy as np
import rerun as rr

from mission.evaluation import DoorEvaluation
from mission.events import DoorsEvaluated, Drove, Event, Labelled, MissionFinished, MissionStarted, Planned
from mission.recording import entities
from mission.recording.drawing import opening, palette
from mission.recording.entities import child
from mission.recording.sentences import level, sentence

if TYPE_CHECKING:
    from sim.doors import DoorTruth

STATE_NAMES = {
    "MissionStarted": "start",
    "Scanned": "scan",
    "Photographed": "photograph",
    "Registered": "register",
    "Coloured": "colour",
    "Structured": "structure",
    "Labelled": "label",
    "Planned": "plan",
    "Drove": "drive",
    "DoorsDetected": "detect",
    "DoorsEvaluated": "evaluate",
    "MissionFinished": "finished",
}
"""Lane of the mission: what it has just done."""


JOINT_COLOUR = (170, 170, 170)


class Plots:
    """Draws what is a number, a state or a sentence."""

    def __init__(self, rec: rr.RecordingStream) -> None:
        """Draw into a recording."""
        self._rec = rec
        self._true_doors: tuple[DoorTruth, ...] = ()
        self._evaluations: list[DoorEvaluation] = []
        self._joints: dict[str, float] = {}

    def draw(self, event: Event) -> None:
        """Draw one event."""
        self._rec.log(entities.LOG, rr.TextLog(sentence(event), level=level(event)))
        state = STATE_NAMES.get(type(event).__name__)
        if state is not None:
            self._rec.log(entities.ACTIVITY, rr.StateChange(state=state))
        self._plot(event)

    @singledispatchmethod
    def _plot(self, event: Event) -> None:
        """Plot one event; most carry no number to plot."""

    @_plot.register
    def _(self, event: MissionStarted) -> None:
        self._true_doors = event.true_doors
        for door in event.true_doors:
            style = rr.SeriesLines(names=f"joint of {door.name}", colors=JOINT_COLOUR, widths=1.5)
            self._rec.log(child(entities.ANGLES, "joint", door.name), style, static=True)
        self._plot_joints({door.name: opening(door) for door in event.true_doors})

    @_plot.register
    def _(self, event: Drove) -> None:
        if len(event.times):
            angles = event.true_door_angles[-1]
            self._plot_joints({door.name: float(a) for door, a in zip(self._true_doors, angles, strict=True)})

    @_plot.register
    def _(self, event: Labelled) -> None:
        self._plot_coverage(event.room, event.voxels.coverage)

    @_plot.register
    def _(self, event: Planned) -> None:
        self._plot_coverage(event.room, event.plan.coverage)

    @_plot.register
    def _(self, event: DoorsEvaluated) -> None:
        self._evaluations += event.doors
        for evaluation in event.doors:
            self._rec.log(child(entities.DOOR_STATES, evaluation.door_id), rr.StateChange(state=evaluation.door.state))
            self._rec.log(child(entities.TABLE, evaluation.door_id), _row(evaluation))
        self._plot_estimates()

    @_plot.register
    def _(self, event: MissionFinished) -> None:
        self._plot_estimates()

    def _plot_joints(self, angles: dict[str, float]) -> None:
        sliding = {door.name for door in self._true_doors if door.kind == "sliding"}
        self._joints = {name: angle for name, angle in angles.items() if name not in sliding}
        for name, angle in self._joints.items():
            self._rec.log(child(entities.ANGLES, "joint", name), rr.Scalars(np.degrees(angle)))

    def _plot_estimates(self) -> None:
        """Estimates, and the joints once more, for a line to end beside them."""
        self._plot_joints(self._joints)
        for number, evaluation in enumerate(self._evaluations):
            angle = evaluation.door.opening_angle
            if np.isfinite(angle):
                variance = np.degrees(np.nan_to_num(evaluation.opening_angle_std)) ** 2
                self._rec.log(
                    child(entities.ANGLES, "estimate", evaluation.door_id),
                    rr.Measurements(
                        np.degrees(angle),
                        variances=variance,
                        units="deg",
                        colors=palette(number),
                        widths=3.0,
                        names=evaluation.door_id,
                    ),
                )

    def _plot_coverage(self, room: int, coverage: float) -> None:
        self._rec.log(child(entities.COVERAGE, room), rr.Scalars(100.0 * coverage))


def _row(evaluation: DoorEvaluation) -> rr.AnyValues:
    """A row of the table of doors; unknown numbers are NaN."""
    door, areas = evaluation.door, evaluation.overlap
    nan = float("nan")
    return rr.AnyValues(
        kind=door.kind,
        state=door.state,
        width_m=door.rectangle.width,
        height_m=door.rectangle.height,
        angle_deg=float(np.degrees(door.opening_angle)),
        angle_std_deg=float(np.degrees(evaluation.opening_angle_std)),
        joint_deg=nan if evaluation.true_angle is None else float(np.degrees(evaluation.true_angle)),
        error_deg=nan if evaluation.angle_error is None else float(np.degrees(evaluation.angle_error)),
        precision=areas.precision if areas else nan,
        recall=areas.recall if areas else nan,
        truth=evaluation.true_name or "",
    )
