"""Each event as one line of a log."""

from __future__ import annotations

import numpy as np

from mission.events import (
    Coloured,
    DoorsDetected,
    DoorsEvaluated,
    Drove,
    Event,
    Labelled,
    MissionFinished,
    MissionStarted,
    Photographed,
    Planned,
    Registered,
    Remarked,
    RoomEntered,
    RoomsTied,
    Scanned,
    Structured,
)
from mission.recording.drawing import angle_label


def sentence(event: Event) -> str:
    """What happened, in one line for people; free of wall clock times."""
    match event:
        case MissionStarted():
            x, y = event.world_from_base[:2, 3]
            return f"mission in {event.scene} with seed {event.seed}, start at ({x:.2f}, {y:.2f})"
        case RoomEntered():
            return _entered(event)
        case RoomsTied():
            return _tied(event)
        case Scanned():
            ranges = event.scan.ranges
            returns = np.count_nonzero(np.isfinite(ranges)) / max(ranges.size, 1)
            return f"scan {event.scan_number}: {ranges.size:,} beams, {returns:.0%} with a return"
        case Photographed():
            return f"scan {event.scan_number}: {len(event.photos)} photographs"
        case Registered():
            return _registered(event)
        case Coloured():
            share = event.view.coloured.mean() if len(event.view.coloured) else 0.0
            return f"scan {event.scan_number}: {len(event.view.coloured):,} points, {share:.0%} coloured"
        case Structured():
            return f"scan {event.scan_number}: {len(event.structure.walls)} walls"
        case Labelled():
            return f"scan {event.scan_number}: {event.voxels.coverage:.1%} of the walls seen"
        case Planned():
            return _planned(event)
        case Drove():
            steps = np.diff(event.world_from_base[:, :2, 3], axis=0)
            metres = np.linalg.norm(steps, axis=1).sum()
            return f"drove {metres:.2f} m" + ("" if event.arrived else f", {event.outcome}: {event.reason}")
        case DoorsDetected():
            count = sum(len(result.doors) for result in event.results)
            return f"{count} door{'s' * (count != 1)} in {len(event.results)} walls"
        case DoorsEvaluated():
            return _evaluated(event)
        case Remarked():
            return event.text
        case MissionFinished():
            return f"{event.outcome}: {event.reason}"
    return type(event).__name__


def level(event: Event) -> str:
    """INFO, or WARN for what a person should look at."""
    match event:
        case Remarked(level="warning") | Registered(accepted=False) | Drove(arrived=False):
            return "WARN"
        case MissionFinished() if event.outcome != "completed":
            return "WARN"
    return "INFO"


def _entered(event: RoomEntered) -> str:
    ways = {"start": "at the start", "set down": "set down by an operator", "door": f"through door {event.door}"}
    x, y = event.world_from_base[:2, 3]
    return f"room {event.room}, {ways[event.how]}, at ({x:.2f}, {y:.2f})"


def _tied(event: RoomsTied) -> str:
    doors = [f"{link.doors[0]} is {link.doors[1]}" for link in event.links if link.doors and link.second == event.room]
    exits = [f"exits: {', '.join(event.exits)}"] if event.exits else ["no exit"]
    refused = [f"{door}: {why}" for door, why in event.refused]
    return f"room {event.room}: " + "; ".join([*doors, *exits, *refused])


def _registered(event: Registered) -> str:
    x, y = event.world_from_scanner[:2, 3]
    verdict = "placed" if event.accepted else "placed by odometry"
    fit = f"fitness {event.fitness:.2f}, residual {event.rmse * 1e3:.1f} mm"
    return f"scan {event.scan_number}: {verdict} at ({x:.2f}, {y:.2f}), {fit}: {event.reason}"


def _planned(event: Planned) -> str:
    plan = event.plan
    if plan.chosen is None:
        return f"no further scan: {plan.stop_reason}; {plan.coverage:.1%} of the structure seen"
    chosen = plan.candidates[plan.chosen]
    x, y = chosen.position
    return (
        f"next scan at ({x:.2f}, {y:.2f}): {chosen.gain:.1f} m2 to gain, {chosen.travel:.1f} m away, "
        f"best of {len(plan.candidates)}; {plan.coverage:.1%} of the structure seen"
    )


def _evaluated(event: DoorsEvaluated) -> str:
    doors = [f"{door.door_id} {angle_label(door)}" for door in event.doors]
    missed = [f"missed {name}" for name in event.missed]
    return "; ".join([*doors, *missed]) or "no doors"
