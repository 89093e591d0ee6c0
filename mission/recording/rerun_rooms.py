"""The building as a graph in the Rerun recording: rooms, and the doors that link them, as each side saw them."""

from __future__ import annotations

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from mission.angles import opening_text
from mission.door_faces import DoorFace
from mission.events import Event, RoomsTied, Structured
from mission.recording import entities
from mission.rigid import transformed

SCALE = 50.0
"""Of the graph's plane: a metre of the building is so many units, so that labels have room."""
ROOM, LINK, END = (90, 140, 220), (90, 200, 110), (150, 150, 150)


class Rooms:
    """Draws the graph of rooms and doors, laid out like the building."""

    def __init__(self, rec: rr.RecordingStream) -> None:
        """Draw into a recording."""
        self._rec = rec
        self._middles: dict[int, NDArray[np.float64]] = {}

    def draw(self, event: Event) -> None:
        """Draw one event."""
        match event:
            case Structured():
                polygon = event.structure.polygon
                self._middles[event.room] = np.array([*polygon.mean(axis=0), 0.0])
            case RoomsTied():
                self._draw(event)

    def _draw(self, event: RoomsTied) -> None:
        rooms = {room: pose for room, pose in event.world_from_room.items() if room in self._middles}
        nodes = [(f"room {room}", self._place(self._middles[room], pose), ROOM) for room, pose in rooms.items()]
        edges: list[tuple[str, str]] = []
        node_of: dict[str, str] = {}
        links = {face: link.doors for link in event.links if link.doors for face in link.doors}
        for face in event.faces:
            sides = links.get(face.door_id, (face.door_id,))
            name = " = ".join(sides)
            if face.door_id == sides[0]:
                said = [_seen(other) for other in event.faces if other.door_id in sides]
                place = self._place(face.head, event.world_from_room[face.room])
                node_of[name] = "\n".join(said)
                nodes.append((node_of[name], place, LINK if len(sides) > 1 else END))
            edges.append((f"room {face.room}", node_of[name]))
        self._rec.log(
            entities.GRAPH,
            rr.GraphNodes(
                [name for name, _, _ in nodes],
                labels=[name for name, _, _ in nodes],
                positions=[place for _, place, _ in nodes],
                colors=[colour for _, _, colour in nodes],
                radii=[8.0 if colour == ROOM else 4.0 for _, _, colour in nodes],
            ),
            rr.GraphEdges(edges, graph_type="undirected"),
        )

    def _place(self, place: NDArray[np.float64], world_from_room: NDArray[np.float64]) -> tuple[float, float]:
        x, y, _ = transformed(place[None], world_from_room)[0]
        return SCALE * float(x), -SCALE * float(y)


def _seen(face: DoorFace) -> str:
    opening = opening_text(face.door.opening_angle, face.door.opened_fraction, unit=" deg")
    return f"{face.door_id}: {'closed' if face.door.state == 'closed' else opening}"
