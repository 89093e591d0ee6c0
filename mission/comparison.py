"""What two missions, or two judgements of one, have different."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from rich.box import SIMPLE_HEAD
from rich.markup import escape
from rich.table import Table

from mission.angles import degrees_text, opening_text, share_text
from mission.evaluation import DoorEvaluation
from mission.report import Report

SAME_DOOR = 0.5
"""Doors whose middles are closer are one [m]."""

Row = tuple[str, str, str]
"""What, and how the first and the second has it."""


def doors_compared(first: Report, second: Report, one: str, other: str) -> Table:
    """A table of all doors, as the first and the second have them; what differs is marked.

    Args:
        first, second: Of the same scene.
        one, other: What they are called.
    """
    table = Table(title=f"doors: {one}, {other}", title_justify="left", box=SIMPLE_HEAD, pad_edge=False)
    for column in ("door", "what", one, other, "change"):
        table.add_column(column, justify="left" if column in {"door", "what"} else "right", no_wrap=True)
    for name, a, b in _pairs(first, second):
        rows = _door_rows(a, b)
        for place, (what, left, right, change) in enumerate(rows):
            mark = "" if left == right and not change else "[yellow]"
            table.add_row(name if place == 0 else "", escape(what), left, f"{mark}{right}", f"{mark}{change}")
    return table


def doors_differ(first: Report, second: Report) -> bool:
    """Whether any door, or what links two of them, is not quite the same."""
    return _doors(first) != _doors(second)


def _doors(report: Report) -> tuple[list[dict[str, Any]], list[dict[str, Any]]]:
    """Rooms with their doors, and links; scans are left out, for a report that was told no clouds counts none."""
    told = report.doors()
    return [room | {"scans": None} for room in told["rooms"]], told["links"]


def differences(first: Report, second: Report) -> list[Row]:
    """What else than doors differs between two missions: outcome, rooms, coverage, times, parameters, versions."""
    a, b = first.summary({}, 0.0), second.summary({}, 0.0)
    rows = [(name, str(a[name]), str(b[name])) for name in ("scene", "seed", "outcome", "reason") if a[name] != b[name]]
    rows += _changed("", _figures(first, a), _figures(second, b))
    rows += _changed("", dict(_flat(a["config"])), dict(_flat(b["config"])))
    rows += _changed("version of ", a["versions"], b["versions"])
    return rows


def stage_times(first: Path, second: Path) -> list[Row]:
    """Wall clock time of each stage, where it differs, of two recordings with their summary.json beside them."""
    return _changed("", _stage_seconds(first), _stage_seconds(second))


def _stage_seconds(recording: Path) -> dict[str, str]:
    """By the summary beside a recording; empty if there is none that can be read."""
    try:
        stages = json.loads((recording.parent / "summary.json").read_text())["stage_seconds"]
        return {str(name): f"{float(seconds):.1f} s" for name, seconds in stages.items()}
    except (OSError, ValueError, TypeError, KeyError, AttributeError):
        return {}


def _figures(report: Report, summary: Mapping[str, Any]) -> dict[str, Any]:
    """Numbers of a mission by their names."""
    figures: dict[str, Any] = {
        "mission time [s]": summary["mission_seconds"],
        "driven [m]": summary["metres_driven"],
        "scans": len(report.registrations),
        "contacts": summary["contacts"],
    }
    figures |= {f"{name} (mean)": value for name, value in summary["metrics"].items()}
    for room in summary["rooms"]:
        scans = sum(event.room == room["id"] for event in report.registrations)
        here = {"scans": scans, "coverage": room["coverage"], "done": room["done"], "stop": room["stop_reason"]}
        figures |= {f"room {room['id']}: {name}": value for name, value in here.items()}
        figures[f"room {room['id']}: exits"] = ", ".join(room["exits"]) or "none"
    figures["doors from both sides"] = ", ".join(" = ".join(link.doors) for link in report.links if link.doors)
    for scan in summary["registration"]:
        figures[f"scan {scan['scan']}: error of its pose [m]"] = scan["translation_error_m"]
    return figures


def _changed(prefix: str, a: Mapping[str, Any], b: Mapping[str, Any]) -> list[Row]:
    names = [*a, *(name for name in b if name not in a)]
    return [(prefix + n, str(a.get(n, "-")), str(b.get(n, "-"))) for n in names if a.get(n) != b.get(n)]


def _flat(table: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    for key, value in table.items():
        if isinstance(value, dict):
            yield from _flat(value, f"{prefix}{key}.")
        else:
            yield prefix + key, value


def _pairs(first: Report, second: Report) -> list[tuple[str, DoorEvaluation | None, DoorEvaluation | None]]:
    """The doors of both, one of each side by side where they are one door."""
    rest = [(number, door) for number, room in second.rooms.items() for door in room.doors]
    pairs: list[tuple[str, DoorEvaluation | None, DoorEvaluation | None]] = []
    for number, room in first.rooms.items():
        for door in room.doors:
            near = [(_apart(door, one), k) for k, (where, one) in enumerate(rest) if where == number]
            apart, place = min(near, default=(np.inf, -1))
            match = rest.pop(place)[1] if apart < SAME_DOOR else None
            renamed = match is not None and match.door_id != door.door_id
            pairs.append((f"{door.door_id} ({match.door_id})" if renamed and match else door.door_id, door, match))
    return pairs + [(door.door_id, None, door) for _, door in rest]


def _apart(a: DoorEvaluation, b: DoorEvaluation) -> float:
    return float(np.linalg.norm(a.corners_in_world.mean(axis=0) - b.corners_in_world.mean(axis=0)))


def _door_rows(a: DoorEvaluation | None, b: DoorEvaluation | None) -> list[tuple[str, str, str, str]]:
    """(what, first, second, change) of a door."""
    one, other = (_door_texts(door) if door else {} for door in (a, b))
    rows = []
    for what in one or other:
        change = ""
        if a and b and what == "angle":
            change = _signed(degrees_text(b.door.opening_angle - a.door.opening_angle, unit="°"))
        elif a and b and what == "corners":
            moved = float(np.linalg.norm(b.corners_in_world - a.corners_in_world, axis=1).max())
            change = f"{moved * 1e3:.1f} mm" if moved > 0 else ""
        rows.append((what, one.get(what, "not found"), other.get(what, "not found"), change))
    return rows


def _signed(text: str) -> str:
    return "" if text.strip("+-0.°") in {"", "nan"} else text


def _door_texts(evaluation: DoorEvaluation) -> dict[str, str]:
    door, areas = evaluation.door, evaluation.overlap
    x, y, z = evaluation.corners_in_world.mean(axis=0)
    return {
        "state": door.state if door.kind == "single" else f"{door.state}, {door.kind}",
        "angle": opening_text(door.opening_angle, door.opened_fraction, unit="°"),
        "size [m]": f"{door.rectangle.width:.3f} x {door.rectangle.height:.3f}",
        "corners": f"({x:.3f}, {y:.3f}, {z:.3f})",
        "sure": share_text(door.confidence),
        "precision, recall": f"{areas.precision:.4f}, {areas.recall:.4f}" if areas else "false positive",
    }
