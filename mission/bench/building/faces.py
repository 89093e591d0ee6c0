"""Door faces: each true door as each room that was scanned has found it, or missed it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mission.bench.building.paper import TABLE_3, PaperFace
from mission.evaluation import DoorEvaluation
from mission.report import Report

_SAME_ANGLE = 0.5
"""A door whose joint stands this near to that of a row of the paper is set beside it [deg]."""


@dataclass(frozen=True, eq=False)
class Face:
    """One side of a true door."""

    room: int
    """From which it is seen."""
    door: str
    """Name of the leaf."""
    true_angle_deg: float
    found: DoorEvaluation | None
    """None if it was missed."""


def door_faces(report: Report) -> list[Face]:
    """The true doors of each room in the order of rooms, those that were missed last."""
    doors = report.started.true_doors if report.started else ()
    angles = {door.name: float(np.nanmax([0.0, *(leaf.opening_angle for leaf in door.leaves)])) for door in doors}
    faces = []
    for room in report.rooms.values():
        seen = [(door.true_name, door) for door in room.doors if door.true_name]
        for name, found in [*seen, *((name, None) for name in room.missed)]:
            faces.append(Face(room.id, name, float(np.degrees(angles[name])), found))
    return faces


def beside_paper(faces: Sequence[Face]) -> list[tuple[PaperFace | None, Face | None]]:
    """Each row of the paper with a face of ours whose door stands like it, if one is left; then the rest of ours."""
    left = list(faces)
    pairs: list[tuple[PaperFace | None, Face | None]] = []
    for row in TABLE_3:
        alike = [face for face in left if abs(face.true_angle_deg - row.true_angle_deg) < _SAME_ANGLE]
        pairs.append((row, alike[0] if alike else None))
        if alike:
            left.remove(alike[0])
    return [*pairs, *((None, face) for face in left)]
