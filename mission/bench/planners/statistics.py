"""What a planner needs for a scene, from its explorations of the rooms."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from mission.bench.planners.exploring import Exploration

NBS = "nbs"
LEVELS = (0.90, 0.95, 0.98)
"""Coverages that the scans are counted to."""
TOLERANCE = 0.005
"""A coverage counts as the same within this: half a square metre of a hundred."""

Areas = Mapping[tuple[str, int], float]
"""Area of the visible structure of each room, by scene and number [m2]."""


@dataclass(frozen=True)
class Count:
    """Scans for some coverage, summed over the rooms of a scene, a mean over seeds."""

    scans: float
    all_reached: bool
    """False if some room ended before: it counts with one scan more than it had, so `scans` is a lower bound."""

    def __str__(self) -> str:
        return f"{self.scans:.1f}" if self.all_reached else f"≥ {self.scans:.1f}"


@dataclass(frozen=True)
class Comparison:
    """The next best scan beside a baseline, where both see as much."""

    scene: str
    baseline: str
    coverage: float
    """Mean over rooms and seeds of what both have at the end at least."""
    nbs_scans: float
    """That the next best scan needs for it, summed over the rooms, a mean over seeds."""
    baseline_scans: float


@dataclass(frozen=True)
class Summary:
    """Of a planner in a scene: sums over the rooms, means over seeds."""

    planner: str
    scene: str
    rooms: int
    scans: float
    metres: float
    """Driven [m]."""
    coverage: float
    """At the end: share of the visible structure of all rooms."""
    scans_to: tuple[Count, ...]
    """For each of `LEVELS`."""


def summary(runs: Sequence[Exploration], areas: Areas) -> Summary:
    """Of all explorations of one scene by one planner."""
    seeds = len({run.seed for run in runs})
    weights = [areas[run.scene, run.room] for run in runs]
    return Summary(
        planner=runs[0].planner,
        scene=runs[0].scene,
        rooms=len({run.room for run in runs}),
        scans=sum(len(run.coverage) for run in runs) / seeds,
        metres=sum(run.metres[-1] for run in runs) / seeds,
        coverage=float(np.average([run.coverage[-1] for run in runs], weights=weights)),
        scans_to=tuple(_count(runs, level, seeds) for level in LEVELS),
    )


def _count(runs: Sequence[Exploration], level: float, seeds: int) -> Count:
    needed = [run.scans_to(level) for run in runs]
    scans = [len(run.coverage) + 1 if count is None else count for run, count in zip(runs, needed, strict=True)]
    return Count(scans=sum(scans) / seeds, all_reached=None not in needed)


def comparison(best: Sequence[Exploration], others: Sequence[Exploration]) -> Comparison:
    """Compare explorations of one scene, room by room and seed by seed, at the coverage that both reach.

    Args:
        best: By the next best scan.
        others: By a baseline, of the same rooms and seeds.
    """
    partner = {(run.room, run.seed): run for run in others}
    pairs = [(run, partner[run.room, run.seed]) for run in best]
    seeds = len({run.seed for run in best})
    levels = [min(ours.coverage[-1], theirs.coverage[-1]) for ours, theirs in pairs]
    scans = np.array(
        [
            [run.scans_to(level - TOLERANCE) or 0 for run in pair]  # both reach it
            for pair, level in zip(pairs, levels, strict=True)
        ]
    )
    nbs_scans, baseline_scans = (scans.sum(axis=0) / seeds).tolist()
    return Comparison(
        scene=best[0].scene,
        baseline=others[0].planner,
        coverage=float(np.mean(levels)),
        nbs_scans=nbs_scans,
        baseline_scans=baseline_scans,
    )


def mean_coverage(runs: Sequence[Exploration], areas: Areas) -> list[float]:
    """Share of a scene's structure after 1, 2, 3... scans a room; a run that has ended keeps what it had."""
    longest = max(len(run.coverage) for run in runs)
    padded = [run.coverage + run.coverage[-1:] * (longest - len(run.coverage)) for run in runs]
    means = np.average(padded, axis=0, weights=[areas[run.scene, run.room] for run in runs])
    return [float(mean) for mean in means]
