"""Things to draw in the MCAP file: robot, walls and doors."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from foxglove.messages import SceneEntity, SceneEntityDeletion, SceneEntityDeletionType
from numpy.typing import NDArray

from mission.recording import mcap_messages as messages
from mission.recording.drawing import TRUTH_COLOUR, WALL_COLOUR, Outlined, angle_label, closed, outline, palette, quads

if TYPE_CHECKING:
    from mission.evaluation import DoorEvaluation
    from sim.guardian import RobotShape


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


def everything(time: int) -> SceneEntityDeletion:
    """Wipe what was drawn on a topic before."""
    return SceneEntityDeletion(timestamp=messages.timestamp(time), type=SceneEntityDeletionType.All, id="")


def on_floor(position: NDArray[np.float64]) -> NDArray[np.float64]:
    """The pose (4, 4) of a point (2,) of a path, at z = 0."""
    pose = np.eye(4)
    pose[:2, 3] = position
    return pose
