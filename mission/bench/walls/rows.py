"""Rows of doors.csv: what became of each true door, and what was found where there is none."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from detector.result import Door
from mission.bench.walls.rooms import BenchDoor, BenchWall
from mission.evaluation import DoorEvaluation, true_opened_fraction
from sim.door_truth import DoorTruth


@dataclass(frozen=True, kw_only=True)
class DoorRow:
    """A true door, found or not, or a false positive: a row of doors.csv."""

    seed: int
    category: str
    wall: str
    door: str | None
    """Name of the true door; None for a false positive."""
    true_kind: str | None = None
    true_angle_deg: float | None = None
    """0 for closed and for sliding doors."""
    true_opened_fraction: float | None = None
    """Of sliding doors only."""
    panel_hidden: float | None = None
    frame_hidden: float | None = None
    found: bool = False
    """Whether there is a detection: all fields below are its."""
    kind: str | None = None
    state: str | None = None
    angle_deg: float | None = None
    angle_error_deg: float | None = None
    angle_std_deg: float | None = None
    opened_fraction: float | None = None
    confidence: float | None = None
    precision: float | None = None
    recall: float | None = None
    e_abs: float | None = None
    """[m2]"""
    e_rel: float | None = None
    f05: float | None = None
    f1: float | None = None
    f2: float | None = None

    @property
    def is_false_positive(self) -> bool:
        """A detection where there is no door."""
        return self.door is None


def door_rows(
    wall: BenchWall,
    seed: int,
    doors: Sequence[tuple[BenchDoor, DoorTruth]],
    evaluations: Sequence[DoorEvaluation],
) -> tuple[DoorRow, ...]:
    """The true doors of a wall from left to right, then the false positives on it."""
    found = {evaluation.true_name: evaluation for evaluation in evaluations}
    rows = [_true_row(wall, seed, door, truth) for door, truth in doors]
    rows = [_measured(row, found[row.door]) if row.door in found else row for row in rows]
    nothing = DoorRow(seed=seed, category=wall.category, wall=wall.name, door=None)
    false = [e for e in evaluations if e.true_name is None and _is_within(e, wall)]
    return (*rows, *(_measured(nothing, evaluation) for evaluation in false))


def confidence_of(door: Door) -> float | None:
    """How sure the detector is of a door, 0 to 1; None where it does not say."""
    return None if np.isnan(door.confidence) else door.confidence


def _true_row(wall: BenchWall, seed: int, door: BenchDoor, truth: DoorTruth) -> DoorRow:
    angles = [leaf.opening_angle for leaf in truth.leaves if not np.isnan(leaf.opening_angle)]
    return DoorRow(
        seed=seed,
        category=wall.category,
        wall=wall.name,
        door=truth.name,
        true_kind="sliding" if truth.kind == "sliding" else "double" if len(truth.leaves) > 1 else "single",
        true_angle_deg=_degrees(max(angles, default=0.0)),
        true_opened_fraction=true_opened_fraction(truth),
        panel_hidden=door.panel_hidden,
        frame_hidden=door.frame_hidden,
    )


def _measured(row: DoorRow, evaluation: DoorEvaluation) -> DoorRow:
    """The row with what the detector says."""
    found, areas = evaluation.door, evaluation.overlap
    row = replace(
        row,
        found=True,
        kind=found.kind,
        state=found.state,
        angle_deg=_degrees(found.opening_angle),
        angle_error_deg=_degrees(evaluation.angle_error),
        angle_std_deg=_degrees(evaluation.opening_angle_std),
        opened_fraction=None if np.isnan(found.opened_fraction) else found.opened_fraction,
        confidence=confidence_of(found),
    )
    if areas is None:
        return row
    return replace(
        row,
        precision=areas.precision,
        recall=areas.recall,
        e_abs=areas.absolute_error,
        e_rel=areas.relative_error,
        f05=areas.f_measure(0.5),
        f1=areas.f_measure(1.0),
        f2=areas.f_measure(2.0),
    )


def _is_within(evaluation: DoorEvaluation, wall: BenchWall) -> bool:
    """Whether the middle of a detection is on the judged face: what the mission found may reach beyond it."""
    origin, end = np.array(wall.origin), np.array(wall.end)
    length = float(np.linalg.norm(end - origin))
    place = float((evaluation.corners_in_world.mean(axis=0) - origin) @ (end - origin)) / length
    return 0 < place < length


def _degrees(angle: float | None) -> float | None:
    return None if angle is None or np.isnan(angle) else float(np.degrees(angle))
