"""Plots, state lanes, log and table of the Rerun recording."""

from __future__ import annotations

from functools import singledispatchmethod
from typing import TYPE_CHECKING

import numpy as np
import rerun as rr

from mission.evaluation import DoorEvaluation
from mission.events import (
    DoorsDetected,
    DoorsEvaluated,
    Drove,
    Event,
    Labelled,
    MissionFinished,
    MissionStarted,
    Planned,
    Scanned,
)
from mission.joints import opening
from mission.recording import entities
from mission.recording.drawing import palette
from mission.recording.entities import child
from mission.recording.sentences import level, sentence

if TYPE_CHECKING:
    from sim.door_truth import DoorTruth

ACTIVITY_COLOURS = {
    "start": (120, 120, 120),
    "scan": (60, 140, 210),
    "plan": (150, 110, 200),
    "drive": (230, 130, 50),
    "detect": (70, 165, 90),
    "end": (120, 120, 120),
}
DOOR_COLOURS = {"closed": (170, 80, 70), "semi-open": (210, 160, 50), "open": (70, 165, 90)}
ACTIVITIES: dict[type[Event], str] = {
    MissionStarted: "start",
    Scanned: "scan",
    Planned: "plan",
    Drove: "drive",
    DoorsDetected: "detect",
    MissionFinished: "end",
}
"""Lane of the mission: what the event is the first outcome of."""


JOINT_COLOUR = (170, 170, 170)


class Plots:
    """Draws what is a number, a state or a sentence."""

    def __init__(self, rec: rr.RecordingStream) -> None:
        """Draw into a recording."""
        self._rec = rec
        self._true_doors: tuple[DoorTruth, ...] = ()
        self._evaluations: dict[str, DoorEvaluation] = {}
        self._joints: dict[str, float] = {}
        self._styled: set[str] = set()

    def draw(self, event: Event) -> None:
        """Draw one event."""
        self._rec.log(entities.LOG, rr.TextLog(sentence(event), level=level(event)))
        activity = ACTIVITIES.get(type(event))
        if activity is not None:
            self._rec.log(entities.ACTIVITY, rr.StateChange(state=activity))
        self._plot(event)

    @singledispatchmethod
    def _plot(self, event: Event) -> None:
        """Plot one event; most carry no number to plot."""

    @_plot.register
    def _(self, event: MissionStarted) -> None:
        self._true_doors = event.true_doors
        self._rec.log(entities.ACTIVITY, _lane(ACTIVITY_COLOURS), static=True)
        for door in event.true_doors:
            self._style_joint(door.name, JOINT_COLOUR)
        self._plot_joints({door.name: opening(door) for door in event.true_doors})

    @_plot.register
    def _(self, event: Drove) -> None:
        if len(event.times):
            angles = event.true_door_angles[-1]
            self._plot_joints({door.name: float(a) for door, a in zip(self._true_doors, angles, strict=True)})

    @_plot.register
    def _(self, event: Labelled) -> None:
        self._plot_coverage(event.room, "walls", event.voxels.coverage)

    @_plot.register
    def _(self, event: Planned) -> None:
        self._plot_coverage(event.room, "structure", event.plan.coverage)

    @_plot.register
    def _(self, event: DoorsEvaluated) -> None:
        self._evaluations |= {evaluation.door_id: evaluation for evaluation in event.doors}
        for evaluation in event.doors:
            if evaluation.true_name is not None:
                colour = palette(list(self._evaluations).index(evaluation.door_id))
                self._style_joint(evaluation.true_name, colour)
            lane = child(entities.DOOR_STATES, evaluation.door_id)
            self._rec.log(lane, _lane(DOOR_COLOURS), static=True)
            self._rec.log(lane, rr.StateChange(state=evaluation.door.state))
            self._rec.log(child(entities.TABLE, evaluation.door_id), row(evaluation))
        self._plot_estimates()

    @_plot.register
    def _(self, event: MissionFinished) -> None:
        self._plot_estimates()

    def _style_joint(self, name: str, colour: tuple[int, int, int]) -> None:
        """A thin line, in the colour of the estimate once there is one."""
        style = rr.SeriesLines(names=f"joint of {name}", colors=colour, widths=1.0)
        self._rec.log(child(entities.ANGLES, "joint", name), style, static=True)

    def _plot_joints(self, angles: dict[str, float]) -> None:
        sliding = {door.name for door in self._true_doors if door.kind == "sliding"}
        self._joints = {name: angle for name, angle in angles.items() if name not in sliding}
        for name, angle in self._joints.items():
            self._rec.log(child(entities.ANGLES, "joint", name), rr.Scalars(np.degrees(angle)))

    def _plot_estimates(self) -> None:
        """Estimates, and the joints once more, for a line to end beside them."""
        self._plot_joints(self._joints)
        for number, evaluation in enumerate(self._evaluations.values()):
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

    def _plot_coverage(self, room: int, what: str, coverage: float) -> None:
        """Walls and the whole structure, which a floor under furniture belongs to, are two lines."""
        entity = child(entities.COVERAGE, room, what)
        if entity not in self._styled:
            self._styled.add(entity)
            colour, name = palette(len(self._styled)), f"room {room}: {what} seen [%]"
            self._rec.log(entity, rr.SeriesLines(names=name, colors=colour, widths=2.0), static=True)
        self._rec.log(entity, rr.Scalars(100.0 * coverage))


def _lane(colours: dict[str, tuple[int, int, int]]) -> rr.StateConfiguration:
    """Colours of the states of a lane."""
    return rr.StateConfiguration(values=list(colours), labels=list(colours), colors=list(colours.values()))


def row(evaluation: DoorEvaluation) -> rr.AnyValues:
    """A row of the table of doors; unknown numbers are left out: NaN would not be equal to that of a replay."""
    door, areas = evaluation.door, evaluation.overlap
    numbers = {
        "width_m": door.rectangle.width,
        "height_m": door.rectangle.height,
        "angle_deg": np.degrees(door.opening_angle),
        "angle_std_deg": np.degrees(evaluation.opening_angle_std),
        "opened_fraction": door.opened_fraction,
        "joint_deg": None if evaluation.true_angle is None else np.degrees(evaluation.true_angle),
        "error_deg": None if evaluation.angle_error is None else np.degrees(evaluation.angle_error),
        "precision": areas.precision if areas else None,
        "recall": areas.recall if areas else None,
        "confidence": door.confidence,
    }
    known = {name: float(number) for name, number in numbers.items() if number is not None and np.isfinite(number)}
    return rr.AnyValues(True, kind=door.kind, state=door.state, truth=evaluation.true_name or "", **known)
