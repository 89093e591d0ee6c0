"""Figures of the Rerun recording that are drawn by hand: angles against joints, bars, coverage by scan."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from mission.angles import degrees_text
from mission.evaluation import DoorEvaluation
from mission.recording import entities
from mission.recording.drawing import palette, true_label

AXIS = (150, 150, 150)
PITCH = 12.0
"""From line to line of what is written beside a figure, in the figure's units; each figure is 100 wide and high."""
BARS = rrb.VisualBounds2D(x_range=(-4, 150), y_range=(-8, 108))
ANGLES = rrb.VisualBounds2D(x_range=(-24, 226), y_range=(-120, 24))
COVERAGE = rrb.VisualBounds2D(x_range=(-20, 196), y_range=(-112, 28))
"""Of the figures with what is written beside them."""


def draw_axes(rec: rr.RecordingStream) -> None:
    """The paper of the figure of estimated over true angles: degrees, the estimate upwards."""
    ticks = range(0, 101, 20)
    grid = [[(t, 0), (t, -100)] for t in ticks] + [[(0, -t), (100, -t)] for t in ticks]
    _lines(rec, f"{entities.SCATTER}/grid", grid, radius=0.5, colour=(*AXIS, 60))
    _lines(rec, f"{entities.SCATTER}/diagonal", [[(0, 0), (100, -100)]], radius=1.0)
    places = [(t, 2) for t in ticks] + [(-8, -t - 4) for t in ticks[1:]] + [(50, 12), (8, -116)]
    _words(rec, f"{entities.SCATTER}/ticks", places, [*ticks, *ticks[1:], "joint [deg]", "estimate [deg]"])


def draw_scatter(rec: rr.RecordingStream, doors: Sequence[DoorEvaluation]) -> None:
    """Estimated over true opening angle, a point a door, with a bar of one standard deviation each way."""
    known = [(number, door) for number, door in enumerate(doors) if door.angle_error is not None]
    points = [(np.degrees(door.true_angle or 0.0), -np.degrees(door.door.opening_angle)) for _, door in known]
    stds = [float(np.degrees(np.nan_to_num(door.opening_angle_std))) for _, door in known]
    colours = [palette(number) for number, _ in known]
    rec.log(f"{entities.SCATTER}/doors", rr.Points2D(points, colors=colours, radii=rr.Radius.ui_points(5.0)))
    bars = [[(x, y - std), (x, y + std)] for (x, y), std in zip(points, stds, strict=True)]
    rec.log(f"{entities.SCATTER}/deviations", rr.LineStrips2D(bars, colors=colours, radii=rr.Radius.ui_points(1.5)))
    places = [(168.0, height) for height in column_heights(len(known), top=-118.0)]
    rec.log(
        f"{entities.SCATTER}/labels",
        rr.Points2D(places, colors=colours, radii=0.0, labels=[_said(door) for _, door in known], show_labels=True),
    )


def _said(door: DoorEvaluation) -> str:
    """ "1.2-a: 34.8 ± 0.1 deg (joint 35.0)"."""
    deviation = np.degrees(door.opening_angle_std)
    plus_minus = f" ± {deviation:.1g}" if deviation > 0 and door.door.kind != "sliding" else ""
    return f"{door.door_id}: {degrees_text(door.door.opening_angle)}{plus_minus} {true_label(door)}"


def column_heights(count: int, *, top: float, room: float = 130.0) -> list[float]:
    """Where to write so many lines one below the other; many come closer together."""
    pitch = min(PITCH, room / max(count, 1))
    return [top + pitch * number for number in range(count)]


def draw_bars(rec: rr.RecordingStream, entity: str, rows: Sequence[tuple[str, float, str]]) -> None:
    """A bar chart.

    Args:
        rec: Where to draw.
        entity: Path of the chart.
        rows: Name, size, and the size for people; from top to bottom.
    """
    longest = max((abs(size) for _, size, _ in rows), default=0.0) or 1.0
    tops = column_heights(len(rows), top=0.0, room=108.0)
    lengths = [80.0 * abs(size) / longest for _, size, _ in rows]
    colours = [palette(number) for number in range(len(rows))]
    strips = [[(0.0, top), (length, top)] for length, top in zip(lengths, tops, strict=True)]
    radius = 0.3 * min(PITCH, 108.0 / max(len(rows), 1))
    rec.log(f"{entity}/bars", rr.LineStrips2D(strips, colors=colours, radii=radius))
    labels = [f"{name}: {text}" for name, _, text in rows]
    places = [(118.0, top - 0.5 * PITCH) for top in tops]  # Rerun writes below the point
    rec.log(f"{entity}/labels", rr.Points2D(places, labels=labels, colors=colours, radii=0.0, show_labels=True))


def draw_coverage(rec: rr.RecordingStream, rooms: Sequence[tuple[str, Sequence[tuple[int, float]]]]) -> None:
    """What was seen of the walls after each scan.

    Args:
        rec: Where to draw.
        rooms: Name, and the number of each scan with the share of the walls that was seen after it.
    """
    last = max((scan for _, scans in rooms for scan, _ in scans), default=1)
    step = max(1, last // 5)
    _lines(rec, f"{entities.COVERED}/grid", [[(0, -p), (100, -p)] for p in (0, 50, 100)], radius=0.5, static=False)
    ticks = [(100.0 * scan / last, 2.0) for scan in range(step, last + 1, step)]
    places = [*ticks, *((-9.0, -p - 4.0) for p in (0, 50, 100)), (50.0, 11.0)]
    words = [*range(step, last + 1, step), "0 %", "50 %", "100 %", "scan"]
    _words(rec, f"{entities.COVERED}/ticks", places, words, static=False)
    strips = [[(100.0 * scan / last, -100.0 * share) for scan, share in scans] for _, scans in rooms]
    colours = [palette(number) for number in range(len(rooms))]
    rec.log(f"{entities.COVERED}/lines", rr.LineStrips2D(strips, colors=colours, radii=rr.Radius.ui_points(1.5)))
    dots = [(dot, colour) for strip, colour in zip(strips, colours, strict=True) for dot in strip]
    rec.log(
        f"{entities.COVERED}/scans",
        rr.Points2D([dot for dot, _ in dots], colors=[colour for _, colour in dots], radii=rr.Radius.ui_points(4.0)),
    )
    labels = [f"{name}: {scans[-1][1]:.1%} of the walls" for name, scans in rooms]
    places = [(150.0, height) for height in column_heights(len(rooms), top=-108.0)]
    rec.log(
        f"{entities.COVERED}/labels", rr.Points2D(places, labels=labels, colors=colours, radii=0.0, show_labels=True)
    )


def _lines(
    rec: rr.RecordingStream,
    entity: str,
    strips: Sequence[Sequence[tuple[float, float]]],
    *,
    radius: float,
    colour: tuple[int, ...] = AXIS,
    static: bool = True,
) -> None:
    rec.log(entity, rr.LineStrips2D(strips, colors=colour, radii=rr.Radius.ui_points(radius)), static=static)


def _words(
    rec: rr.RecordingStream,
    entity: str,
    places: Sequence[tuple[float, float]],
    words: Sequence[object],
    *,
    static: bool = True,
) -> None:
    labels = [str(word) for word in words]
    rec.log(entity, rr.Points2D(places, labels=labels, radii=0.0, colors=AXIS, show_labels=True), static=static)
