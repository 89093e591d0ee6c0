"""The files of a benchmark run: numbers, pictures, a recording."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any

from mission.bench.tables import BenchTable
from mission.bench.walls import figures, tables
from mission.bench.walls.judging import WallJudgement
from mission.bench.walls.rows import DoorRow
from mission.bench.walls.statistics import Metrics, failures, highlights, metrics, reliability, rows_of, stage_times
from mission.bench.walls.variants import Variant, configured
from mission.config import MissionConfig
from mission.recording.rerun_bench import write_bench
from mission.report import peak_memory, write_json
from mission.versions import versions

DECIMALS = 5


@dataclass(frozen=True, eq=False)
class BenchReport:
    """What came out of a run."""

    judged: dict[Variant, list[WallJudgement]]
    """Of all walls, by variant."""
    ablate: str | None
    sweep: str | None
    config: MissionConfig

    @property
    def plain(self) -> list[WallJudgement]:
        """Of the detector as it is configured; of a sweep that leaves that value out, at the first one."""
        first = next(iter(self.judged.values()))
        return self.judged.get(configured(self.config, self.sweep), first) if self.sweep else first

    def tables(self) -> list[BenchTable]:
        """What a person reads."""
        if self.sweep:
            return [tables.table_6(self.sweep, {float(value): walls for value, walls in self.judged.items()})]
        judged = list(self.judged.values())
        shown = [tables.table_4(self.plain)]
        if self.ablate:
            shown.append(tables.table_5(judged[0], judged[1]))
        if any(not row.found or row.is_false_positive for row in rows_of(self.plain)):
            shown.append(tables.wall_table(self.plain))
        shown += [tables.highlight_table(self.plain), tables.time_table(stage_times(self.plain))]
        if bins := reliability(rows_of(self.plain)):
            shown.append(tables.reliability_table(bins))
        return [table for table in shown if table.rows]

    def result(self) -> dict[str, Any]:
        """The content of result.json: flat, for other tools."""
        walls = self.plain
        count = highlights(walls)
        times = stage_times(walls)
        by_category = {c: metrics(_of_category(walls, c)) for c in dict.fromkeys(w.category for w in walls)}
        seeds = dict.fromkeys(wall.seed for wall in walls)
        return {
            **metrics(rows_of(walls)),
            "walls": len(walls),
            "walls_found": sum(bool(wall.pictures) for wall in walls),
            "highlights": count.true,
            "highlights_found": count.found,
            "highlights_marked": count.marked,
            "highlights_false": count.false,
            "ms_per_wall": round(sum(wall for wall, _ in times.values()), 1),
            "ms_per_m2": round(sum(area for _, area in times.values()), 2),
            "peak_bytes": max([peak_memory(), *(wall.peak_bytes for wall in walls)]),
            "categories": by_category,
            "seeds": {str(seed): metrics([r for r in rows_of(walls) if r.seed == seed]) for seed in seeds},
            **({"variants": self._variants()} if len(self.judged) > 1 else {}),
            "config": self.config.model_dump(mode="json"),
            "versions": versions(),
        }

    def _variants(self) -> dict[str, Metrics]:
        return {str(variant): metrics(rows_of(walls)) for variant, walls in self.judged.items()}


def _of_category(walls: Sequence[WallJudgement], category: str) -> list[DoorRow]:
    return [row for row in rows_of(walls) if row.category == category]


def write_report(folder: Path, report: BenchReport) -> None:
    """Write all files into a folder."""
    rows = [(str(variant), row) for variant, walls in report.judged.items() for row in rows_of(walls)]
    write_json(folder / "result.json", report.result())
    write_json(folder / "doors.json", {"doors": [{"variant": variant, **_plain(row)} for variant, row in rows]})
    with (folder / "doors.csv").open("w", newline="") as file:
        writer = csv.DictWriter(file, ["variant", *(field.name for field in fields(DoorRow))])
        writer.writeheader()
        writer.writerows({"variant": variant, **_plain(row)} for variant, row in rows)
    markdown = "\n".join(table.markdown() for table in report.tables())
    (folder / "tables.md").write_text(markdown)
    pictures = _draw(folder, report)
    seeds = " ".join(str(seed) for seed in dict.fromkeys(wall.seed for wall in report.plain))
    write_bench(
        folder / "walls.rrd", report.plain, tables=markdown, figures=pictures, name=f"bench walls, seed {seeds}"
    )


def _draw(folder: Path, report: BenchReport) -> list[Path]:
    """Draw all pictures; those that are figures are returned."""
    rows = rows_of(report.plain)
    pictures = [folder / "precision_recall.png"]
    figures.precision_recall(pictures[0], rows)
    if bins := reliability(rows):
        pictures.append(folder / "reliability.png")
        figures.reliability_curve(pictures[-1], bins)
    if report.sweep:
        pictures.append(folder / f"failures_{report.sweep}.png")
        missed = [(float(value), failures(rows_of(walls)) or 0.0) for value, walls in report.judged.items()]
        figures.failures_over_value(pictures[-1], report.sweep, missed)
    for seed in dict.fromkeys(wall.seed for wall in report.plain):
        walls = [wall for wall in report.plain if wall.seed == seed]
        figures.contact_sheet(folder / f"walls_{seed}.png", walls)
    return pictures


def _plain(row: DoorRow) -> dict[str, Any]:
    return {name: round(v, DECIMALS) + 0.0 if isinstance(v, float) else v for name, v in asdict(row).items()}
