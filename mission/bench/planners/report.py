"""The tables and files of the planners benchmark."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from mission.bench.chart import COLOURS, Axis, Chart
from mission.bench.planners.exploring import Exploration
from mission.bench.planners.statistics import (
    LEVELS,
    NBS,
    TOLERANCE,
    Areas,
    Comparison,
    Summary,
    comparison,
    mean_coverage,
    summary,
)
from mission.bench.tables import BenchTable
from mission.config import MissionConfig
from mission.report import write_json
from mission.versions import versions


@dataclass(frozen=True, eq=False)
class PlannersReport:
    """What came out of a run."""

    runs: Sequence[Exploration]
    areas: Areas
    config: MissionConfig

    @property
    def scenes(self) -> list[str]:
        """In their order."""
        return list(dict.fromkeys(run.scene for run in self.runs))

    def of(self, scene: str, planner: str) -> list[Exploration]:
        """The explorations of a scene by a planner."""
        return [run for run in self.runs if (run.scene, run.planner) == (scene, planner)]

    def planners(self, scene: str) -> list[str]:
        """That explored a scene, in their order."""
        return list(dict.fromkeys(run.planner for run in self.runs if run.scene == scene))

    def summaries(self) -> list[Summary]:
        """One a scene and planner."""
        return [summary(self.of(s, planner), self.areas) for s in self.scenes for planner in self.planners(s)]

    def comparisons(self) -> list[Comparison]:
        """The next best scan with each baseline, scene by scene."""
        return [
            comparison(self.of(scene, NBS), self.of(scene, planner))
            for scene in self.scenes
            for planner in self.planners(scene)
            if NBS in self.planners(scene) and planner != NBS
        ]

    def tables(self) -> list[BenchTable]:
        """What a person reads."""
        tables = [_ends(self.summaries(), len({run.seed for run in self.runs}))]
        if comparisons := self.comparisons():
            tables.append(_same_coverage(comparisons))
        return tables

    def result(self) -> dict[str, Any]:
        """The content of result.json."""
        return {
            "planners": [_plain(one) for one in self.summaries()],
            "same_coverage": [_plain(one) for one in self.comparisons()],
            "seeds": sorted({run.seed for run in self.runs}),
            "config": self.config.model_dump(mode="json"),
            "versions": versions(),
        }


def write_report(folder: Path, report: PlannersReport) -> None:
    """Write result.json, runs.json, tables.md and a picture of the coverage a scene."""
    write_json(folder / "result.json", report.result())
    areas = [{"scene": scene, "room": room, "m2": round(m2, 2)} for (scene, room), m2 in report.areas.items()]
    write_json(folder / "runs.json", {"visible_structure": areas, "runs": [_plain(run) for run in report.runs]})
    (folder / "tables.md").write_text("\n".join(table.markdown() for table in report.tables()))
    for scene in report.scenes:
        _draw_coverage(folder / f"coverage_{Path(scene).stem}.png", scene, report)


def _ends(summaries: Sequence[Summary], seeds: int) -> BenchTable:
    levels = [f"to {level:.0%}" for level in LEVELS]
    rows = tuple(
        (
            one.scene,
            one.planner,
            str(one.rooms),
            f"{one.scans:.1f}",
            f"{one.metres:.1f}",
            f"{one.coverage:.2%}",
            *map(str, one.scans_to),
        )
        for one in summaries
    )
    title = f"At the end, and scans to a coverage; sums over rooms, mean of {seeds} seed{'s' * (seeds > 1)}"
    return BenchTable(title, ("scene", "planner", "rooms", "scans", "metres", "coverage", *levels), rows)


def _same_coverage(comparisons: Sequence[Comparison]) -> BenchTable:
    rows = tuple(
        (one.scene, one.baseline, f"{one.coverage:.2%}", f"{one.nbs_scans:.2f}", f"{one.baseline_scans:.2f}")
        for one in comparisons
    )
    title = f"Scans to the same coverage: what both reach, less {TOLERANCE:.1%}"
    return BenchTable(title, ("scene", "baseline", "coverage", "nbs", "baseline"), rows)


def _draw_coverage(path: Path, scene: str, report: PlannersReport) -> None:
    curves = {planner: mean_coverage(report.of(scene, planner), report.areas) for planner in report.planners(scene)}
    most = max(len(curve) for curve in curves.values())
    low = math.floor(10 * min(curve[0] for curve in curves.values())) / 10
    step = 0.02 if low >= 0.8 else 0.05 if low >= 0.5 else 0.1
    ticks = [low + step * k for k in range(round((1 - low) / step) + 1)]
    chart = Chart(
        f"{scene}: coverage over scans a room",
        Axis("scans of each room", 0.8, most + 0.2, range(1, most + 1)),
        Axis("share of the visible structure", low - step / 4, 1 + step / 4, ticks),
    )
    for colour, (planner, curve) in zip(COLOURS, curves.items(), strict=False):
        chart.line([(k + 1, share) for k, share in enumerate(curve)], colour=colour, label=planner)
    chart.save(path)


def _plain(one: Exploration | Summary | Comparison) -> dict[str, Any]:
    return {name: _rounded(value) for name, value in asdict(one).items()}


def _rounded(value: Any) -> Any:
    if isinstance(value, float):
        return round(value, 5)
    if isinstance(value, tuple):
        return [_rounded(entry) for entry in value]
    return {name: _rounded(entry) for name, entry in value.items()} if isinstance(value, dict) else value
