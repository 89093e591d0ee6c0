"""The page of results in the Rerun recording: figures, a summary that a person can quote, the configuration."""

from __future__ import annotations

import json
from collections.abc import Sequence

import numpy as np
import rerun as rr

from mission.angles import degrees_text, opening_text, share_text
from mission.evaluation import DoorEvaluation
from mission.events import DoorsDetected, DoorsEvaluated, Event, MissionFinished, MissionStarted
from mission.recording import entities
from mission.recording.drawing import angle_label, palette
from mission.report import Report

AXIS = (150, 150, 150)
LABEL = (86.0, 15.0)
"""Width and height of a label in the figure of angles, in its degrees."""


class Results:
    """Gathers what the mission found and draws it."""

    def __init__(self, rec: rr.RecordingStream) -> None:
        """Draw into a recording."""
        self._rec = rec
        self._report = Report()
        self._stage_seconds: dict[str, float] = {}

    def draw(self, event: Event) -> None:
        """Draw one event, after taking note of it."""
        self._report.handle(event)
        match event:
            case MissionStarted():
                self._write(entities.CONFIGURATION, configuration(event))
                self._write(entities.SUMMARY, summary(self._report))
                draw_axes(self._rec)
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
    for room in report.rooms.values():
        stop = f", stopped: {room.stop_reason}" if room.stop_reason else ""
        lines += [f"## Room {room.id}", f"{room.scans} scans, {room.coverage:.1%} of the walls seen{stop}", ""]
        lines += _door_table(room.doors)
        lines += [f"- missed: `{name}`" for name in room.missed]
    return "\n".join([*lines, "", *_metrics(report), *_poses(report)])


def configuration(started: MissionStarted) -> str:
    """Parameters and versions in Markdown."""
    versions = "\n".join(f"- {name} {version}" for name, version in sorted(started.versions.items()))
    return f"## Configuration\n```json\n{json.dumps(started.config, indent=2)}\n```\n## Versions\n{versions}\n"


def draw_axes(rec: rr.RecordingStream) -> None:
    """The paper of the figure of estimated over true angles: degrees, the estimate upwards."""
    ticks = range(0, 101, 20)
    grid = [[(t, 0), (t, -100)] for t in ticks] + [[(0, -t), (100, -t)] for t in ticks]
    rec.log(
        f"{entities.SCATTER}/grid",
        rr.LineStrips2D(grid, colors=(*AXIS, 60), radii=rr.Radius.ui_points(0.5)),
        static=True,
    )
    rec.log(
        f"{entities.SCATTER}/diagonal",
        rr.LineStrips2D([[(0, 0), (100, -100)]], colors=AXIS, radii=rr.Radius.ui_points(1.0)),
        static=True,
    )
    places = [(t, 2) for t in ticks] + [(-8, -t - 4) for t in ticks[1:]] + [(50, 12), (-8, -116)]
    names = [*map(str, ticks), *map(str, ticks[1:]), "joint [deg]", "estimate [deg]"]
    rec.log(
        f"{entities.SCATTER}/ticks",
        rr.Points2D(places, labels=names, radii=rr.Radius.ui_points(0.1), colors=AXIS, show_labels=True),
        static=True,
    )


def draw_scatter(rec: rr.RecordingStream, doors: Sequence[DoorEvaluation]) -> None:
    """Estimated over true opening angle, a point a door, with a bar of one standard deviation each way."""
    known = [(number, door) for number, door in enumerate(doors) if door.angle_error is not None]
    points = [(np.degrees(door.true_angle or 0.0), -np.degrees(door.door.opening_angle)) for _, door in known]
    stds = [float(np.degrees(np.nan_to_num(door.opening_angle_std))) for _, door in known]
    colours = [palette(number) for number, _ in known]
    rec.log(
        f"{entities.SCATTER}/doors",
        rr.Points2D(
            points,
            colors=colours,
            radii=rr.Radius.ui_points(6.0),
        ),
    )
    rec.log(
        f"{entities.SCATTER}/labels",
        rr.Points2D(
            label_places(points),
            colors=colours,
            radii=0.0,
            labels=[f"{door.door_id}: {angle_label(door)}" for _, door in known],
            show_labels=True,
        ),
    )
    bars = [[(x, y - std), (x, y + std)] for (x, y), std in zip(points, stds, strict=True)]
    rec.log(f"{entities.SCATTER}/deviations", rr.LineStrips2D(bars, colors=colours, radii=rr.Radius.ui_points(1.5)))


def label_places(points: Sequence[tuple[float, float]]) -> list[tuple[float, float]]:
    """Where to write beside points of the figure, from the lowest up, so that no two labels lie on each other.

    All closed doors are in one point.
    """
    width, height = LABEL
    places: dict[int, tuple[float, float]] = {}
    for number in sorted(range(len(points)), key=lambda n: -points[n][1]):  # the estimate counts upwards, y down
        x, y = points[number][0] + 0.53 * width, points[number][1] - height
        for other_x, other_y in sorted(places.values(), key=lambda place: -place[1]):  # the lowest first
            if abs(x - other_x) < width and abs(y - other_y) < height:
                y = other_y - height
        places[number] = (x, y)
    return [places[number] for number in range(len(points))]


def draw_bars(rec: rr.RecordingStream, entity: str, rows: Sequence[tuple[str, float, str]]) -> None:
    """A bar chart.

    Args:
        rec: Where to draw.
        entity: Path of the chart.
        rows: Name, size, and the size for people; from top to bottom.
    """
    longest = max((abs(size) for _, size, _ in rows), default=0.0) or 1.0
    pitch = 100.0 / max(len(rows), 5)
    tops = [pitch * number for number in range(len(rows))]
    lengths = [100.0 * abs(size) / longest for _, size, _ in rows]
    colours = [palette(number) for number in range(len(rows))]
    strips = [[(0.0, top), (length, top)] for length, top in zip(lengths, tops, strict=True)]
    rec.log(f"{entity}/bars", rr.LineStrips2D(strips, colors=colours, radii=0.15 * pitch))
    labels = [f"{name}: {text}" for name, _, text in rows]
    places = [(50.0, top + 0.2 * pitch) for top in tops]  # Rerun writes below the point
    rec.log(f"{entity}/labels", rr.Points2D(places, labels=labels, colors=colours, radii=0.0, show_labels=True))


def _error_row(door: DoorEvaluation) -> tuple[str, float, str]:
    if door.true_name is None:
        return door.door_id, 0.0, "false positive"
    if door.angle_error is None:
        return door.door_id, 0.0, "angle not seen"
    return door.door_id, door.angle_error, f"{degrees_text(door.angle_error, digits=2)} deg"


def _door_table(doors: Sequence[DoorEvaluation]) -> list[str]:
    if not doors:
        return ["no doors", ""]
    head = [
        "door",
        "kind",
        "state",
        "size [m]",
        "angle [deg]",
        "joint [deg]",
        "error [deg]",
        "precision",
        "recall",
        "sure",
    ]
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
    metrics = report.metrics()
    words = {
        "doors": "true doors",
        "found": "found",
        "false_positives": "false positives",
        "precision": "mean precision",
        "recall": "mean recall",
        "angle_mae_deg": "mean angle error [deg]",
        "angle_max_deg": "largest angle error [deg]",
    }
    if not any(room.doors or room.missed for room in report.rooms.values()):
        return []
    return [f"- {text}: {metrics[key]}" for key, text in words.items() if metrics[key] is not None]


def _poses(report: Report) -> list[str]:
    poses = report.pose_metrics()
    if poses["max_m"] is None:
        return []
    words = {
        "within_room_median_m": "scans within a room: median error [m]",
        "within_room_max_m": "worst [m]",
        "max_m": "scans in the building: worst error [m]",
        "max_deg": "worst [deg]",
    }
    return ["- " + "; ".join(f"{text}: {poses[key]:.4f}" for key, text in words.items())]
