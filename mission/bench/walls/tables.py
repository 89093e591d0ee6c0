"""The tables of the walls benchmark for the terminal and for the recording, the paper's numbers beside ours."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from mission.bench.tables import BenchTable
from mission.bench.walls import paper
from mission.bench.walls.glossy import NONE
from mission.bench.walls.judging import WallJudgement
from mission.bench.walls.rooms import CATEGORIES
from mission.bench.walls.rows import DoorRow
from mission.bench.walls.statistics import Metrics, ReliabilityBin, failures, highlights, least, metrics, rows_of

MEASURES = {"precision": "precision", "recall": "recall", "e_abs": "e_abs [m2]", "e_rel": "e_rel"}
F_MEASURES = {"f05": "F0.5", "f1": "F1", "f2": "F2"}
ALL = "all"


def table_4(judgements: Sequence[WallJudgement]) -> BenchTable:
    """Door positioning, category by category."""
    rows = []
    present = {judgement.category for judgement in judgements}
    for category in [*(c for c in CATEGORIES if c in present), ALL]:
        doors = [row for row in rows_of(judgements) if category in (row.category, ALL)]
        rows.append((category, *_ours(metrics(doors))))
        if category == ALL:
            found, false = str(paper.FOUND), str(paper.FALSE_POSITIVES)
            rows.append(("  paper", str(paper.DOORS), found, false, *["-"] * 9))
        elif category in paper.TABLE_4:
            rows.append(("  paper", *_theirs(paper.TABLE_4[category])))
    columns = [*MEASURES.values(), *F_MEASURES.values()]
    header = ("case", "doors", "found", "false", *columns, "angle [deg]", "worst")
    return BenchTable("Door positioning (the paper's Table 4)", header, tuple(rows))


def _ours(values: Metrics) -> list[str]:
    counts = [str(values[name]) for name in ("doors", "found", "false_positives")]
    means = [number(values[name]) for name in (*MEASURES, *F_MEASURES)]
    return [*counts, *means, number(values["angle_mae_deg"], 2), number(values["angle_max_deg"], 2)]


def _theirs(row: paper.CategoryRow) -> list[str]:
    means = [number(getattr(row, name)) for name in (*MEASURES, *F_MEASURES)]
    return [str(row.doors), "-", "-", *means, "-", "-"]


def table_5(corrected: Sequence[WallJudgement], uncorrected: Sequence[WallJudgement]) -> BenchTable:
    """Each door with and without highlight correction."""
    without = {(row.seed, row.wall, row.door): row for row in rows_of(uncorrected) if not row.is_false_positive}
    rows = [
        (
            row.wall if row.seed == corrected[0].seed else f"{row.wall}, seed {row.seed}",
            *_correction(row),
            *_correction(without[row.seed, row.wall, row.door]),
        )
        for row in rows_of(corrected)
        if not row.is_false_positive
    ]
    rows += [(f"  paper {row.name}", *_numbers(row.corrected), *_numbers(row.uncorrected)) for row in paper.TABLE_5]
    counts = [sum(row.is_false_positive for row in rows_of(variant)) for variant in (corrected, uncorrected)]
    rows.append(("false positives", *(text for count in counts for text in (str(count), "", "", "", ""))))
    columns = ("P", "R", "e_abs [m2]", "e_rel")
    header = ("wall", "with: found", *columns, "without: found", *columns)
    return BenchTable("With and without highlight correction (the paper's Table 5)", header, tuple(rows))


def _correction(row: DoorRow) -> tuple[str, ...]:
    return _numbers((row.precision, row.recall, row.e_abs, row.e_rel) if row.found else None)


def _numbers(values: Sequence[float | None] | None) -> tuple[str, ...]:
    return ("no", "-", "-", "-", "-") if values is None else ("yes", *map(number, values))


def table_6(name: str, variants: Mapping[float, Sequence[WallJudgement]]) -> BenchTable:
    """Failures, precision and recall over the values of a parameter."""
    doors = [rows_of(judgements) for judgements in variants.values()]
    summaries = [metrics(rows) for rows in doors]
    theirs = paper.TABLE_6.get(name)
    rows: list[tuple[str, ...]] = []
    for label, ours, attribute in (
        ("failures", [failures(row) for row in doors], "failures"),
        ("least precision", [least(row, "precision") for row in doors], "least_precision"),
        ("least recall", [least(row, "recall") for row in doors], "least_recall"),
        ("mean precision", [summary["precision"] for summary in summaries], "mean_precision"),
        ("mean recall", [summary["recall"] for summary in summaries], "mean_recall"),
    ):
        show = percent if attribute == "failures" else number
        rows.append((label, *map(show, ours)))
        if theirs:
            told = dict(zip(theirs.values, getattr(theirs, attribute), strict=True))
            rows.append(("  paper", *(show(told.get(value)) for value in variants)))
    rows.append(("false positives", *(str(summary["false_positives"]) for summary in summaries)))
    return BenchTable(f"Sweep of {name} (the paper's Table 6)", (name, *(f"{v:g}" for v in variants)), tuple(rows))


def wall_table(judgements: Sequence[WallJudgement]) -> BenchTable:
    """What went wrong where: doors that were missed, false positives, walls that were not found."""
    rows = []
    for judgement in judgements:
        missed = [row.door or "" for row in judgement.rows if not row.found]
        false = sum(row.is_false_positive for row in judgement.rows)
        if missed or false or judgement.remark:
            rows.append(
                (judgement.wall, str(judgement.seed), ", ".join(missed) or "-", str(false), judgement.remark or "")
            )
    return BenchTable("Walls with misses or false positives", ("wall", "seed", "missed", "false", "why"), tuple(rows))


def time_table(times: Mapping[str, tuple[float, float]]) -> BenchTable:
    """Time of the detector, stage by stage."""
    rows = [(stage, f"{wall:.0f}", f"{area:.1f}") for stage, (wall, area) in times.items()]
    wall, area = (sum(pair[k] for pair in times.values()) for k in (0, 1))
    rows.append((ALL, f"{wall:.0f}", f"{area:.1f}"))
    return BenchTable("Time of the detector", ("stage", "ms a wall", "ms/m2"), tuple(rows))


def highlight_table(judgements: Sequence[WallJudgement]) -> BenchTable:
    """Highlights found, against the true masks of the camera."""
    rows = []
    for category in [*CATEGORIES, ALL]:
        count = highlights([j for j in judgements if category in (j.category, ALL)])
        if count != NONE:
            rows.append(
                (
                    category,
                    str(count.true),
                    percent(count.found / count.true if count.true else None),
                    str(count.marked),
                    percent(count.false / count.marked if count.marked else None),
                )
            )
    header = ("case", "over 8 cm2", "found", "marked", "false")
    return BenchTable("Highlights, against the camera's true masks", header, tuple(rows))


def reliability_table(bins: Sequence[ReliabilityBin]) -> BenchTable:
    """Whether confidences can be believed."""
    rows = [(number(b.confidence), number(b.true), str(b.count)) for b in bins]
    return BenchTable("Reliability of the confidence", ("mean confidence", "are doors", "detections"), tuple(rows))


def number(value: float | None, digits: int = 3) -> str:
    """ "0.995", or "-" where there is none."""
    return "-" if value is None else f"{value:.{digits}f}"


def percent(value: float | None) -> str:
    """ "20 %", or "-" where there is none."""
    return "-" if value is None else f"{100 * value:.0f} %"
