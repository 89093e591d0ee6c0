"""doors.json and summary.json: what a mission found, for machines."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np

from mission.angles import rounded_degrees, rounded_share
from mission.evaluation import DoorEvaluation
from mission.events import (
    Coloured,
    DoorsDetected,
    DoorsEvaluated,
    Drove,
    Event,
    Labelled,
    MissionFinished,
    MissionStarted,
    Planned,
    Registered,
    RoomEntered,
    RoomsTied,
    Structured,
)
from mission.memory import peak_memory
from mission.pose_errors import PoseError, pose_errors
from mission.pose_graph import Link
from mission.rigid import Pose

SCHEMA = 1
"""Version of the layout of doors.json."""


@dataclass
class RoomReport:
    """What is known about a room."""

    id: int
    walls: int = 0
    scans: int = 0
    coverage: float = 0.0
    """Share of the walls' area that was seen."""
    stop_reason: str | None = None
    doors: tuple[DoorEvaluation, ...] = ()
    missed: tuple[str, ...] = ()
    how: str = "start"
    """How the robot came in."""
    door: str | None = None
    """Through which door."""
    exits: tuple[str, ...] = ()
    """Doors that it could drive through."""
    wall_clock: float = 0.0
    """From its entry until its doors were judged for the first time [s]."""
    done: bool = False
    """Whether its doors were judged; what lies behind a door may turn out to be no room."""


@dataclass
class Report:
    """A sink that gathers the results of a mission."""

    started: MissionStarted | None = None
    finished: MissionFinished | None = None
    rooms: dict[int, RoomReport] = field(default_factory=dict)
    metres: float = 0.0
    """Way driven, as odometry has it [m]."""
    registrations: list[Registered] = field(default_factory=list)
    links: tuple[Link, ...] = ()
    """Between rooms."""
    world_from_room: dict[int, Pose] = field(default_factory=dict)
    """(4, 4) of each room, as far as is known."""
    contacts: int = 0
    """Legs that ended at a touch."""
    _entered: float = 0.0

    def handle(self, event: Event) -> None:
        """Take one event."""
        room = self.rooms.get(event.room) or RoomReport(event.room)  # of a room that is never entered nothing is kept
        match event:
            case RoomEntered():
                self.rooms[event.room] = room
                self._entered = perf_counter()
                room.how, room.door = event.how, event.door
                self.world_from_room[event.room] = event.world_from_room
            case RoomsTied():
                self.links = event.links
                self.world_from_room |= event.world_from_room
                room.exits = event.exits
            case MissionStarted():
                self.started = event
            case Registered():
                self.registrations.append(event)
            case Coloured():
                room.scans += 1
            case Structured():
                room.walls = len(event.structure.walls)
            case Labelled():
                room.coverage = event.voxels.coverage
            case Planned():
                room.stop_reason = event.plan.stop_reason
            case Drove():
                steps = np.diff(event.world_from_base[:, :2, 3], axis=0)
                self.metres += float(np.linalg.norm(steps, axis=1).sum())
                self.contacts += event.outcome == "contact"
            case DoorsDetected():
                room.walls = len(event.results)
            case DoorsEvaluated():
                if not room.done:
                    room.wall_clock = perf_counter() - self._entered
                room.doors, room.missed, room.done = event.doors, event.missed, True
            case MissionFinished():
                self.finished = event

    def doors(self) -> dict[str, Any]:
        """The content of doors.json."""
        return {
            "schema": SCHEMA,
            "scene": self.started.scene if self.started else None,
            "seed": self.started.seed if self.started else None,
            "rooms": [
                {
                    "id": room.id,
                    "walls": room.walls,
                    "scans": room.scans,
                    "doors": [_door(door) for door in room.doors],
                }
                for room in self.rooms.values()
            ],
            "links": [_link(link) for link in self.links if link.doors],
        }

    def pose_metrics(self) -> dict[str, float | None]:
        """Errors of the registered scans: within their rooms, and over the building."""
        errors = pose_errors(self.registrations, self.world_from_room)
        if not errors:
            return dict.fromkeys(("within_room_median_m", "within_room_max_m", "max_m", "max_deg"))
        within = [error.within_room for error in errors]
        return {
            "within_room_median_m": round(float(np.median(within)), 5),
            "within_room_max_m": round(max(within), 5),
            "max_m": round(max(error.translation for error in errors), 5),
            "max_deg": round(float(np.degrees(max(error.rotation for error in errors))), 4),
        }

    def metrics(self) -> dict[str, float | int | None]:
        """Counts, and means and maxima over the found doors; None where there is nothing to average."""
        doors = [door for room in self.rooms.values() for door in room.doors]
        found = [door.overlap for door in doors if door.overlap is not None]
        missed = sum(len(room.missed) for room in self.rooms.values())
        errors = [abs(np.degrees(door.angle_error)) for door in doors if door.angle_error is not None]
        return {
            "doors": len(found) + missed,
            "found": len(found),
            "false_positives": len(doors) - len(found),
            "precision": _mean([o.precision for o in found]),
            "recall": _mean([o.recall for o in found]),
            "e_abs": _mean([o.absolute_error for o in found]),
            "e_rel": _mean([o.relative_error for o in found]),
            "angle_mae_deg": _mean(errors),
            "angle_max_deg": _rounded(max(errors)) if errors else None,
            "coverage": _mean([room.coverage for room in self.rooms.values() if room.done]),
        }

    def summary(self, stage_seconds: Mapping[str, float], wall_clock: float) -> dict[str, Any]:
        """The content of summary.json.

        Args:
            stage_seconds: Wall clock time of each stage [s].
            wall_clock: Of the whole program so far [s].
        """
        errors = {error.scan: error for error in pose_errors(self.registrations, self.world_from_room)}
        return {
            "schema": SCHEMA,
            "scene": self.started.scene if self.started else None,
            "seed": self.started.seed if self.started else None,
            "outcome": self.finished.outcome if self.finished else None,
            "reason": self.finished.reason if self.finished else None,
            "metrics": self.metrics(),
            "rooms": [
                {
                    "id": room.id,
                    "entered": room.how,
                    "through": room.door,
                    "done": room.done,
                    "exits": list(room.exits),
                    "scans": room.scans,
                    "wall_clock_seconds": round(room.wall_clock, 3),
                    "coverage": _rounded(room.coverage),
                    "stop_reason": room.stop_reason,
                    "missed": list(room.missed),
                }
                for room in self.rooms.values()
            ],
            "metres_driven": _rounded(self.metres),
            "contacts": self.contacts,
            "mission_seconds": _rounded(self.finished.time / 1e9) if self.finished else None,
            "poses": self.pose_metrics(),
            "registration": [_registration(event, errors.get(event.scan_number)) for event in self.registrations],
            "wall_clock_seconds": round(wall_clock, 3),
            "stage_seconds": {stage: round(seconds, 3) for stage, seconds in stage_seconds.items()},
            "peak_memory_bytes": peak_memory(),
            "versions": self.started.versions if self.started else {},
            "config": self.started.config if self.started else {},
        }


def write_json(path: Path, content: Mapping[str, Any]) -> None:
    """Write a file in one step: a reader sees the old content or the new, never a part."""
    part = path.with_suffix(".part")
    part.write_text(json.dumps(content, indent=2, allow_nan=False) + "\n")
    part.replace(path)


def _door(evaluation: DoorEvaluation) -> dict[str, Any]:
    door = evaluation.door
    return {
        "id": evaluation.door_id,
        "wall": evaluation.wall,
        "kind": door.kind,
        "state": door.state,
        "corners": [[_rounded(x) for x in corner] for corner in evaluation.corners_in_world],
        "width": _rounded(door.rectangle.width),
        "height": _rounded(door.rectangle.height),
        "opening_angle_deg": rounded_degrees(door.opening_angle, 2),
        "leaf_angles_deg": [rounded_degrees(leaf.opening_angle, 2) for leaf in door.leaves],
        "opened_fraction": rounded_share(door.opened_fraction, 4),
        "hinge": evaluation.hinge,
        "opens": evaluation.opens,
        "confidence": rounded_share(door.confidence, 3),
        "truth": _truth(evaluation),
    }


def _truth(evaluation: DoorEvaluation) -> dict[str, Any] | None:
    if evaluation.overlap is None:
        return None
    return {
        "door": evaluation.true_name,
        "angle_deg": rounded_degrees(evaluation.true_angle, 2),
        "angle_error_deg": rounded_degrees(evaluation.angle_error, 2),
        "opened_fraction": rounded_share(evaluation.true_opened_fraction, 4),
        "precision": _rounded(evaluation.overlap.precision),
        "recall": _rounded(evaluation.overlap.recall),
        "e_abs": _rounded(evaluation.overlap.absolute_error),
        "e_rel": _rounded(evaluation.overlap.relative_error),
    }


def _link(link: Link) -> dict[str, Any]:
    return {"rooms": [link.first, link.second], "doors": list(link.doors or ())}


def _registration(event: Registered, error: PoseError | None) -> dict[str, Any]:
    return {
        "scan": event.scan_number,
        "room": event.room,
        "accepted": event.accepted,
        "reason": event.reason,
        "fitness": _rounded(event.fitness),
        "within_room_error_m": round(error.within_room, 5) if error else None,
        "translation_error_m": round(error.translation, 5) if error else None,
        "rotation_error_deg": round(float(np.degrees(error.rotation)), 4) if error else None,
    }


def _mean(values: list[float]) -> float | None:
    return _rounded(float(np.mean(values))) if values else None


def _rounded(value: float) -> float:
    return round(float(value), 4) + 0.0
