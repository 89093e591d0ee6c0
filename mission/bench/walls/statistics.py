"""What the judgements of many walls amount to."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from mission.bench.walls.glossy import NONE, HighlightCount
from mission.bench.walls.judging import WallJudgement
from mission.bench.walls.rows import DoorRow

Metrics = dict[str, float | int | None]
OPEN_DEG = 0.05
"""A hinged door whose true or measured angle is above this counts in the errors of angles [deg]."""


def metrics(rows: Sequence[DoorRow]) -> Metrics:
    """Counts, and means and maxima over the found doors; None where there is nothing to average.

    Errors of angles are over hinged doors that stand open or are said to: closed ones would only dilute them.
    """
    true = [row for row in rows if not row.is_false_positive]
    found = [row for row in true if row.found]
    errors = angle_errors(rows)
    means = {
        name: _rounded(np.mean, [value for row in found if (value := getattr(row, name)) is not None])
        for name in ("precision", "recall", "e_abs", "e_rel", "f05", "f1", "f2")
    }
    return {
        "doors": len(true),
        "found": len(found),
        "false_positives": len(rows) - len(true),
        **means,
        "angle_mae_deg": _rounded(np.mean, errors),
        "angle_max_deg": _rounded(np.max, errors),
    }


def angle_errors(rows: Sequence[DoorRow]) -> list[float]:
    """Absolute errors of the opening angle of hinged doors that stand open or are said to [deg]."""
    return [
        abs(row.angle_error_deg)
        for row in rows
        if row.angle_error_deg is not None
        and row.true_kind != "sliding"
        and max(row.true_angle_deg or 0.0, row.angle_deg or 0.0) > OPEN_DEG
    ]


def least(rows: Sequence[DoorRow], name: str) -> float | None:
    """The worst value of a measure over the found doors."""
    return _rounded(np.min, [value for row in rows if (value := getattr(row, name)) is not None])


def failures(rows: Sequence[DoorRow]) -> float | None:
    """Share of the true doors that was not found."""
    true = [row for row in rows if not row.is_false_positive]
    return sum(not row.found for row in true) / len(true) if true else None


def rows_of(judgements: Sequence[WallJudgement]) -> list[DoorRow]:
    """All doors of all walls, in order."""
    return [row for judgement in judgements for row in judgement.rows]


def stage_times(judgements: Sequence[WallJudgement]) -> dict[str, tuple[float, float]]:
    """Mean time of each stage of the detector per wall [ms] and per area of wall [ms/m2]."""
    detected = [judgement for judgement in judgements if judgement.pictures]
    area = sum(judgement.area for judgement in detected)
    totals: dict[str, float] = {}
    for stage, seconds in (pair for judgement in detected for pair in judgement.stage_seconds.items()):
        totals[stage] = totals.get(stage, 0.0) + 1e3 * seconds
    return {stage: (total / len(detected), total / area) for stage, total in totals.items()}


def highlights(judgements: Sequence[WallJudgement]) -> HighlightCount:
    """Of all walls together."""
    return sum((judgement.highlights for judgement in judgements), NONE)


@dataclass(frozen=True)
class ReliabilityBin:
    """Detections of similar confidence."""

    confidence: float
    """Mean of what the detector says."""
    true: float
    """Share of them that are doors."""
    count: int


def reliability(rows: Sequence[DoorRow], bins: int = 10) -> list[ReliabilityBin]:
    """How often detections of each confidence are doors; empty for a detector that does not say."""
    said = [(row.confidence, not row.is_false_positive) for row in rows if row.confidence is not None]
    groups: dict[int, list[tuple[float, bool]]] = {}
    for confidence, is_door in said:
        groups.setdefault(min(int(confidence * bins), bins - 1), []).append((confidence, is_door))
    return [
        ReliabilityBin(float(np.mean([c for c, _ in group])), float(np.mean([t for _, t in group])), len(group))
        for _, group in sorted(groups.items())
    ]


def _rounded(measure: Callable[..., np.floating], values: Sequence[float]) -> float | None:
    return round(float(measure(values)), 4) + 0.0 if len(values) else None
