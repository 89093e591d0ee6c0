"""Doors in the 3D world of the Rerun recording: leaves at their measured angle, the joint's beside them as a ghost."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from mission.angles import opening_text
from mission.evaluation import DoorEvaluation
from mission.events import DoorsEvaluated, Event, MissionStarted, RoomsTied
from mission.recording import entities
from mission.recording.drawing import TRUTH_COLOUR, angle_label, closed, palette, quads, true_label
from mission.recording.entities import child
from mission.recording.rerun_plots import row


class Doors:
    """Draws doors and true doors."""

    def __init__(self, rec: rr.RecordingStream) -> None:
        """Draw into a recording."""
        self._rec = rec
        self._doors: dict[str, tuple[int, DoorEvaluation]] = {}
        self._same: Mapping[str, str] = {}

    def draw(self, event: Event) -> None:
        """Draw one event; most show no door."""
        match event:
            case MissionStarted():
                for door in event.true_doors:
                    self._draw_truth(door.name, [leaf.corners_in_world for leaf in door.leaves])
            case RoomsTied():
                self._same = dict(link.doors for link in event.links if link.doors)
                self._label()
            case DoorsEvaluated():
                for evaluation in event.doors:
                    self._doors[evaluation.door_id] = event.room, evaluation
                    self._draw_door(evaluation.door_id)
                    if evaluation.true_name is not None:
                        self._draw_truth(evaluation.true_name, evaluation.true_leaf_corners_in_world)
                self._label()

    def _colour(self, door: str) -> tuple[int, int, int]:
        return palette(list(self._doors).index(door))

    def _entity(self, door: str) -> str:
        room, evaluation = self._doors[door]
        return child(entities.DOORS, entities.wall_name(room, evaluation.wall), door)

    def _draw_door(self, door: str) -> None:
        entity, colour, (_, evaluation) = self._entity(door), self._colour(door), self._doors[door]
        leaves = evaluation.leaf_corners_in_world
        self._rec.log(
            f"{entity}/doorway",
            rr.LineStrips3D([closed(evaluation.corners_in_world)], colors=colour, radii=0.015),
            row(evaluation),
        )
        self._rec.log(f"{entity}/leaf", rr.LineStrips3D([closed(leaf) for leaf in leaves], colors=colour, radii=0.02))
        self._rec.log(f"{entity}/face", _faces(leaves, (*colour, 110)))

    def _label(self) -> None:
        """Label the doors; two faces of one door share a label, for they are in one place."""
        for door, (_, evaluation) in self._doors.items():
            other = self._same.get(door)
            seconds = [self._doors[other][1]] if other in self._doors else []
            if any(self._same.get(first) == door and first in self._doors for first in self._same):
                label = []  # the first face's says it all
            else:
                label = [label_of(evaluation, *seconds)]
            top = evaluation.corners_in_world[2:].mean(axis=0)
            self._rec.log(
                f"{self._entity(door)}/label",
                rr.Points3D([top] * len(label), colors=self._colour(door), radii=0.02, labels=label, show_labels=True),
            )

    def _draw_truth(self, name: str, leaves: Sequence[NDArray[np.float64]]) -> None:
        entity = child(entities.TRUTH, name)
        strips = [closed(leaf) for leaf in leaves]
        self._rec.log(entity, rr.LineStrips3D(strips, colors=TRUTH_COLOUR, radii=0.008))
        self._rec.log(f"{entity}/ghost", _faces(leaves, (*TRUTH_COLOUR, 45)))


def label_of(door: DoorEvaluation, *others: DoorEvaluation) -> str:
    """ "1.2-a: 34.8 deg (joint 35.0)"; of a door seen from two sides "1.2-a = 2.5-a: 94.9, 95.0 deg (joint 95.0)"."""
    if not others:
        return f"{door.door_id}: {angle_label(door)}"
    sides = (door, *others)
    names = " = ".join(side.door_id for side in sides)
    said = ", ".join(opening_text(side.door.opening_angle, side.door.opened_fraction) for side in sides)
    return f"{names}: {said} {true_label(door)}"


def _faces(leaves: Sequence[NDArray[np.float64]], colour: tuple[int, int, int, int]) -> rr.Mesh3D:
    vertices, triangles = quads(leaves)
    return rr.Mesh3D(vertex_positions=vertices, triangle_indices=triangles, albedo_factor=colour)
