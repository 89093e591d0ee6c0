"""What the MCAP file keeps of each event: fields of our own messages, and things to draw."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from foxglove.messages import SceneEntity, SceneEntityDeletion, SceneEntityDeletionType
from numpy.typing import NDArray

from detector.result import Door, WallResult
from mission.events import DoorsDetected, DoorsEvaluated, Drove, Labelled, Planned, Registered, RoomsTied, Structured
from mission.recording import mcap_messages as messages
from mission.recording.drawing import TRUTH_COLOUR, WALL_COLOUR, Outlined, angle_label, closed, outline, palette, quads

if TYPE_CHECKING:
    from mission.candidates import ScanCandidate
    from mission.evaluation import DoorEvaluation
    from mission.pose_graph import Link
    from sim.guardian import RobotShape

NAN = float("nan")


def registration(event: Registered) -> dict[str, Any]:
    """mission.Registration."""
    return {
        "scan": event.scan_number,
        "guess_world_from_scanner": _flat(event.guess_world_from_scanner),
        "world_from_scanner": _flat(event.world_from_scanner),
        "fitness": event.fitness,
        "rmse": event.rmse,
        "accepted": event.accepted,
        "reason": event.reason,
        "true_world_from_scanner": _flat(event.true_world_from_scanner),
    }


def structure(event: Structured) -> dict[str, Any]:
    """mission.Structure."""
    found = event.structure
    return {
        "scan": event.scan_number,
        "floor_height": found.floor_height,
        "ceiling_height": NAN if found.ceiling_height is None else found.ceiling_height,
        "walls": [_wall(wall) for wall in found.walls],
        "polygon": _flat(found.polygon),
    }


def voxels(event: Labelled) -> dict[str, Any]:
    """mission.Voxels."""
    model = event.voxels
    levels = [("floor", model.floor)] + ([("ceiling", model.ceiling)] if model.ceiling else [])
    return {
        "scan": event.scan_number,
        "coverage": model.coverage,
        "size": model.size,
        "grids": [_labels(f"wall {number}", labels) for number, labels in enumerate(model.walls, start=1)]
        + [
            _labels(name, grid.labels) | {"origin": _flat(grid.origin), "u": _flat(grid.u), "v": _flat(grid.v)}
            for name, grid in levels
        ],
        "clutter": _flat(model.clutter),
    }


def plan(event: Planned) -> dict[str, Any]:
    """mission.Plan."""
    made = event.plan
    return {
        "scan": event.scan_number,
        "candidates": [_candidate(candidate) for candidate in made.candidates],
        "chosen": -1 if made.chosen is None else made.chosen,
        "stop_reason": made.stop_reason or "",
        "coverage": made.coverage,
    }


def drive(event: Drove) -> dict[str, Any]:
    """mission.Drive."""
    return {
        "planned_path": _flat(event.planned_path),
        "outcome": event.outcome,
        "reason": event.reason,
        "poses": len(event.times),
    }


def detected(event: DoorsDetected) -> dict[str, Any]:
    """mission.DetectedDoors."""
    return {
        "floor_height": event.floor_height,
        "ceiling_height": NAN if event.ceiling_height is None else event.ceiling_height,
        "walls": [_detected_wall(result) for result in event.results],
    }


def estimates(event: DoorsEvaluated) -> dict[str, Any]:
    """mission.DoorEstimates."""
    return {"doors": [_estimate(evaluation) for evaluation in event.doors], "missed": list(event.missed)}


def robot(time: int, shape: RobotShape) -> SceneEntity:
    """The robot's body, which moves with its base."""
    colours = [messages.colour(rgb) for rgb in shape.colours.tolist()]
    body = messages.surface(shape.vertices, shape.triangles, colours=colours)
    return messages.scene_entity(time, "robot", frame="base", triangles=[body])


def wall(time: int, room: int, number: int, rectangle: Outlined) -> SceneEntity:
    """A wall's outline and name."""
    name, line = f"wall {room}.{number}", outline(rectangle)
    words = messages.text(line[2:4].mean(axis=0), name, WALL_COLOUR)
    frame = messages.room_frame(room)
    return messages.scene_entity(time, name, frame=frame, lines=messages.lines([line], WALL_COLOUR), texts=[words])


def door(time: int, evaluation: DoorEvaluation, number: int) -> list[SceneEntity]:
    """A door as estimated with its label, and its true leaves."""
    rgb, leaves = palette(number), evaluation.leaf_corners_in_world
    corners = evaluation.corners_in_world
    label = messages.text(corners[2:].mean(axis=0), f"{evaluation.door_id}: {angle_label(evaluation)}", rgb)
    face = messages.surface(*quads(leaves), tint=messages.colour(rgb, 0.4))
    edges = messages.lines([closed(corners), *(closed(leaf) for leaf in leaves)], rgb)
    truth = messages.lines([closed(leaf) for leaf in evaluation.true_leaf_corners_in_world], TRUTH_COLOUR, width=0.01)
    name = f"door {evaluation.door_id}"
    return [
        messages.scene_entity(time, name, lines=edges, triangles=[face], texts=[label]),
        messages.scene_entity(time, f"truth of {name}", lines=truth),
    ]


def rooms(event: RoomsTied) -> dict[str, Any]:
    """mission.Rooms."""
    doors = {face.door_id: face.door for face in event.faces}
    return {
        "rooms": [{"room": room, "world_from_room": _flat(pose)} for room, pose in event.world_from_room.items()],
        "links": [_link(link, doors) for link in event.links],
        "exits": list(event.exits),
        "refused": [f"{door}: {why}" for door, why in event.refused],
    }


def _link(link: Link, doors: Mapping[str, Door]) -> dict[str, Any]:
    sides = [doors[door] for door in link.doors or ()]
    return {
        "first": link.first,
        "second": link.second,
        "doors": list(link.doors or ()),
        "in_first": _flat(link.in_first),
        "in_second": _flat(link.in_second),
        "turn": link.turn,
        "deviations": [*_flat(link.deviations), link.turn_deviation],
        "states": [door.state for door in sides],
        "opening_angles": [door.opening_angle for door in sides],
    }


def everything(time: int) -> SceneEntityDeletion:
    """Wipe what was drawn on a topic before."""
    return SceneEntityDeletion(timestamp=messages.timestamp(time), type=SceneEntityDeletionType.All, id="")


def on_floor(position: NDArray[np.float64]) -> NDArray[np.float64]:
    """The pose (4, 4) of a point (2,) of a path, at z = 0."""
    pose = np.eye(4)
    pose[:2, 3] = position
    return pose


def _flat(array: NDArray[np.floating]) -> list[float]:
    return np.asarray(array, float).ravel().tolist()


def _labels(surface: str, labels: NDArray[np.uint8]) -> dict[str, Any]:
    rows, columns = labels.shape
    return {"surface": surface, "rows": rows, "columns": columns, "labels": labels.tobytes()}


def _wall(rectangle: Outlined) -> dict[str, Any]:
    return {
        "origin": _flat(rectangle.origin),
        "u": _flat(rectangle.u),
        "v": _flat(rectangle.v),
        "width": rectangle.width,
        "height": rectangle.height,
    }


def _candidate(candidate: ScanCandidate) -> dict[str, Any]:
    return {
        "x": float(candidate.position[0]),
        "y": float(candidate.position[1]),
        "heading": candidate.heading,
        "gain": candidate.gain,
        "quality": candidate.quality,
        "doorway": candidate.doorway,
        "overlap": candidate.overlap,
        "travel": candidate.travel,
        "score": candidate.score,
        "reason": candidate.reason or "",
    }


def _detected_wall(result: WallResult) -> dict[str, Any]:
    return {"wall": _wall(result.wall), "doors": [_detected_door(found) for found in result.doors]}


def _detected_door(found: Door) -> dict[str, Any]:
    r = found.rectangle
    return {
        "rectangle": [r.left, r.bottom, r.right, r.top],
        "kind": found.kind,
        "state": found.state,
        "leaves": [
            {
                "hinge": leaf.hinge,
                "opening_angle": leaf.opening_angle,
                "opening_angle_std": leaf.opening_angle_std,
                "opens": leaf.opens or "",
                "slid": leaf.slid,
            }
            for leaf in found.leaves
        ],
        "confidence": found.confidence,
    }


def _estimate(evaluation: DoorEvaluation) -> dict[str, Any]:
    found, areas = evaluation.door, evaluation.overlap
    return {
        "id": evaluation.door_id,
        "wall": evaluation.wall,
        "kind": found.kind,
        "state": found.state,
        "width": found.rectangle.width,
        "height": found.rectangle.height,
        "corners": _flat(evaluation.corners_in_world),
        "opening_angle": found.opening_angle,
        "opening_angle_std": evaluation.opening_angle_std,
        "leaf_angles": [leaf.opening_angle for leaf in found.leaves],
        "hinge": evaluation.hinge,
        "opens": evaluation.opens or "",
        "true_name": evaluation.true_name or "",
        "true_angle": NAN if evaluation.true_angle is None else evaluation.true_angle,
        "angle_error": NAN if evaluation.angle_error is None else evaluation.angle_error,
        "precision": NAN if areas is None else areas.precision,
        "recall": NAN if areas is None else areas.recall,
        "opened_fraction": found.opened_fraction,
        "true_opened_fraction": NAN if evaluation.true_opened_fraction is None else evaluation.true_opened_fraction,
        "confidence": found.confidence,
    }
