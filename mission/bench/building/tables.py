"""The table of the building benchmark, the paper's numbers beside ours."""

from __future__ import annotations

from mission.angles import rounded_degrees
from mission.bench.building import paper
from mission.bench.building.faces import Face, beside_paper, door_faces
from mission.bench.tables import BenchTable
from mission.bench.walls.tables import number
from mission.report import Report

_MEASURES = ("precision", "recall", "e_abs", "e_rel")
_COLUMNS = ("angle [deg]", "P", "R", "e_abs [m2]", "e_rel")


def table_3(report: Report) -> BenchTable:
    """Door faces, and what was found where there is none."""
    rows = [(*_ours(face), *_theirs(row)) for row, face in beside_paper(door_faces(report))]
    metrics = report.metrics()
    means = [number(metrics[name]) for name in _MEASURES]
    theirs = [number(paper.MEAN[name]) for name in _MEASURES]
    rows.append(("mean", "", "", "", *means, "mean", "", *theirs))
    found = f"{metrics['found']} of {len(paper.TABLE_3)}"
    rows.append(("found", "", "", "", found, "", "", "", "found", "", f"{len(paper.TABLE_3)} of 9", "", "", ""))
    false, theirs_false = str(metrics["false_positives"]), str(paper.FALSE_POSITIVES)
    rows.append(("false positives", "", "", "", false, "", "", "", "false positives", "", theirs_false, "", "", ""))
    header = ("door", "room", "joint [deg]", *_COLUMNS, "paper", *_COLUMNS)
    return BenchTable("Door faces of the building (the paper's Table 3)", header, tuple(rows))


def _ours(face: Face | None) -> tuple[str, ...]:
    if face is None:
        return ("not visited", *["-"] * 7)
    told = (face.door, str(face.room), number(face.true_angle_deg, 2))
    if face.found is None or face.found.overlap is None:
        return (*told, "missed", *["-"] * 4)
    areas = face.found.overlap
    measures = (areas.precision, areas.recall, areas.absolute_error, areas.relative_error)
    return (*told, number(rounded_degrees(face.found.door.opening_angle, 2), 2), *map(number, measures))


def _theirs(row: paper.PaperFace | None) -> tuple[str, ...]:
    if row is None:
        return ("-",) * 6
    return (row.name, number(row.angle_deg, 2), *(number(getattr(row, name)) for name in _MEASURES))
