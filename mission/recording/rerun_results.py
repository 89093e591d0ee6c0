"""The page of results in the Rerun recording: figures, a summary that a person can quote, the configuration."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence

import numpy as np
import rerun as rr

from mission.angles import degrees_text, opening_text, share_text
from mission.evaluation import DoorEvaluation
from mission.events import DoorsDetected, DoorsEvaluated, Event, Labelled, MissionFinished, MissionStarted
from mission.recording import entities
from mission.recording.rerun_figures import draw_axes, draw_bars, draw_coverage, draw_scatter
from mission.report import Report

KEY = """\
| in the room | |
| --- | --- |
| doors | the leaf as measured in colour, the joint's as a white ghost |
| walls | blue outlines; each has its number, and one with a door has a tab |
| points | in the photographs' colours; grey where no photograph saw them |
| way of the robot | driven, by its odometry: orange; true: white; planned: light blue |
| places to scan from | from violet (low score) to yellow (high score); small and grey: ruled out; arrow: the next one |
| red dots | what the Hokuyos saw last |

Further tabs show the planner's voxels (seen: blue; hidden so far: grey; opening: yellow), clutter, and the floor's grid
(free: green; occupied: red). Hover over anything for its numbers. The ceiling is there, but not shown: see the list of
entities (first button on the top right).
"""
"""What is what in the tab of the mission."""


class Results:
    """Gathers what the mission found and draws it."""

    def __init__(self, rec: rr.RecordingStream) -> None:
        """Draw into a recording."""
        self._rec = rec
        self._report = Report()
        self._stage_seconds: dict[str, float] = {}
        self._covered: dict[int, list[tuple[int, float]]] = {}

    def draw(self, event: Event) -> None:
        """Draw one event, after taking note of it."""
        self._report.handle(event)
        match event:
            case MissionStarted():
                self._write(entities.CONFIGURATION, configuration(event))
                self._write(entities.SUMMARY, summary(self._report))
                self._write(entities.KEY, KEY)
                draw_axes(self._rec)
            case Labelled():
                self._covered.setdefault(event.room, []).append((event.scan_number, event.voxels.coverage))
                draw_coverage(self._rec, [(f"room {room}", scans) for room, scans in self._covered.items()])
            case DoorsDetected():
                for stage, seconds in (pair for result in event.results for pair in result.stage_seconds):
                    self._stage_seconds[stage] = self._stage_seconds.get(stage, 0.0) + seconds
                rows = [(stage, seconds, f"{seconds:.2f} s") for stage, seconds in self._stage_seconds.items()]
                draw_bars(self._rec, entities.STAGES, rows)
            case DoorsEvaluated():
                doors = [door for room in self._report.rooms.values() for door in room.doors]
                draw_bars(self._rec, entities.ERRORS, [_error_row(door) for door in doors])
                draw_scatter(self._rec, doors)
                self._write(entities.SUMMARY, summary(self._report))
            case MissionFinished():
                self._write(entities.SUMMARY, summary(self._report))

    def _write(self, entity: str, markdown: str) -> None:
        self._rec.log(entity, rr.TextDocument(markdown, media_type="text/markdown"))


def summary(report: Report) -> str:
    """The mission in Markdown."""
    lines = ["# Mission"]
    if report.started:
        lines += [f"`{report.started.scene}`, seed {report.started.seed}", ""]
    if report.finished:
        minutes, seconds = divmod(round(report.finished.time / 1e9), 60)
        driven = f"{report.metres:.1f} m driven in {minutes} min {seconds} s of mission time"
        lines += [f"**{report.finished.outcome}**: {report.finished.reason}; {driven}", ""]
    lines += [*_metrics(report), "", *_poses(report), "", "Angles are in degrees, sizes in metres.", ""]
    for room in report.rooms.values():
        stop = f", stopped: {room.stop_reason}" if room.stop_reason else ""
        lines += [f"## Room {room.id}", f"{room.scans} scans, {room.coverage:.1%} of the walls seen{stop}", ""]
        lines += _door_table(room.doors)
        lines += [f"- missed: `{name}`" for name in room.missed]
    return "\n".join(lines)


def configuration(started: MissionStarted) -> str:
    """Parameters, as --set takes them, and versions in Markdown."""
    parameters = "\n".join(f"{name}={value}" for name, value in _flat(started.config))
    versions = "\n".join(f"- {name} {version}" for name, version in sorted(started.versions.items()))
    return f"## Configuration\n```\n{parameters}\n```\n## Versions\n{versions}\n"


def _flat(config: Mapping[str, object], path: str = "") -> Iterator[tuple[str, str]]:
    """Parameters by their full names, to six digits."""
    for name, value in config.items():
        if isinstance(value, Mapping):
            yield from _flat(value, f"{path}{name}.")
        else:
            yield f"{path}{name}", f"{value:.6g}" if isinstance(value, float) else str(json.dumps(value)).strip('"')


def _error_row(door: DoorEvaluation) -> tuple[str, float, str]:
    if door.true_name is None:
        return door.door_id, 0.0, "false positive"
    if door.angle_error is None:
        return door.door_id, 0.0, "angle not seen"
    return door.door_id, door.angle_error, f"{degrees_text(door.angle_error, digits=2)} deg"


def _door_table(doors: Sequence[DoorEvaluation]) -> list[str]:
    if not doors:
        return ["no doors", ""]
    head = ["door", "kind", "state", "size", "angle", "joint", "error", "prec.", "recall", "sure"]
    rows = [
        [*_description(evaluation), *_comparison(evaluation), share_text(evaluation.door.confidence)]
        for evaluation in doors
    ]
    return ["| " + " | ".join(row) + " |" for row in [head, ["---"] * len(head), *rows]] + [""]


def _description(evaluation: DoorEvaluation) -> list[str]:
    door = evaluation.door
    size = f"{door.rectangle.width:.2f} x {door.rectangle.height:.2f}"
    deviation = (
        f" ± {degrees_text(evaluation.opening_angle_std, digits=2)}"
        if np.isfinite(evaluation.opening_angle_std) and door.kind != "sliding"
        else ""
    )
    opening = opening_text(door.opening_angle, door.opened_fraction)
    return [evaluation.door_id, door.kind, door.state, size, opening + deviation]


def _comparison(evaluation: DoorEvaluation) -> list[str]:
    areas = evaluation.overlap
    if areas is None:
        return ["false positive", "-", "-", "-"]
    error = degrees_text(evaluation.angle_error, digits=2)
    joint = opening_text(evaluation.true_angle, evaluation.true_opened_fraction)
    return [joint, error, f"{areas.precision:.3f}", f"{areas.recall:.3f}"]


def _metrics(report: Report) -> list[str]:
    """The mission in one sentence."""
    metrics = report.metrics()
    if not metrics["doors"] and not metrics["false_positives"]:
        return ["No doors."] if report.finished else []
    wrong = f"{metrics['false_positives'] or 'no'} false positive{'s' * (metrics['false_positives'] != 1)}"
    parts = [f"**{metrics['found']} of {metrics['doors']} doors found, {wrong}**"]
    if metrics["precision"] is not None:
        parts.append(f"precision {metrics['precision']:.3f}, recall {metrics['recall']:.3f} in the mean")
    if metrics["angle_mae_deg"] is not None:
        mean, largest = metrics["angle_mae_deg"], metrics["angle_max_deg"]
        parts.append(f"opening angles off by {mean:.2f} deg in the mean, {largest:.2f} at most")
    return ["; ".join(parts) + "."]


def _poses(report: Report) -> list[str]:
    poses = report.pose_metrics()
    within, worst, turn = (poses[key] for key in ("within_room_median_m", "max_m", "max_deg"))
    if within is None or worst is None or turn is None:
        return []
    return [
        f"Places of the scans: off by {1e3 * within:.2f} mm within their rooms (median), in the building by "
        f"{1e3 * worst:.2f} mm and {turn:.3f} deg at most."
    ]
