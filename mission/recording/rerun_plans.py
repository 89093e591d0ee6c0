"""What the planner thought, in the Rerun recording: voxel labels, scan candidates with their scores, the grid."""

from __future__ import annotations

from functools import singledispatchmethod
from typing import TYPE_CHECKING

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from mission.events import Event, Labelled, Planned, RoomEntered, RoomsTied, Structured
from mission.recording import entities
from mission.recording.drawing import CELL_COLOURS, score_colours
from mission.recording.rerun_places import log_pose
from mission.recording.rerun_world import LIFT, PLAN_COLOUR, hover
from mission.rigid import Pose

if TYPE_CHECKING:
    from mission.voxels import VoxelModel

CLUTTER_COLOUR = (190, 110, 60)


class Plans:
    """Draws voxels, candidates and the occupancy grid."""

    def __init__(self, rec: rr.RecordingStream) -> None:
        """Draw into a recording."""
        self._rec = rec
        self._floor = 0.0

    @singledispatchmethod
    def draw(self, event: Event) -> None:
        """Draw one event; most are no matter of planning."""

    @draw.register
    def _(self, event: RoomEntered) -> None:
        self._place(event.world_from_room)

    @draw.register
    def _(self, event: RoomsTied) -> None:
        self._place(event.world_from_room[event.room])

    def _place(self, world_from_room: Pose) -> None:
        """Put what is drawn of the present room where the room lies."""
        for entity in (entities.MAP, entities.PLANS):
            log_pose(self._rec, entity, world_from_room)

    @draw.register
    def _(self, event: Structured) -> None:
        self._floor = event.structure.floor_height

    @draw.register
    def _(self, event: Labelled) -> None:
        """Voxels as tiles on their surfaces; those of the ceiling apart, for they hide all others from above."""
        model = event.voxels
        overhead = model.normals[:, 2] < -0.5
        self._draw_tiles(entities.VOXELS, model, ~overhead)
        self._draw_tiles(entities.CEILING_VOXELS, model, overhead)
        half = np.full(3, 0.45 * model.size)
        self._rec.log(entities.CLUTTER, rr.Boxes3D(centers=model.clutter, half_sizes=half, colors=CLUTTER_COLOUR))

    def _draw_tiles(self, entity: str, model: VoxelModel, which: NDArray[np.bool_]) -> None:
        normals, labels = model.normals[which], model.labels[which]
        level = np.abs(normals[:, 2]) > 0.5
        row = model.floor.u
        yaw = np.where(level, np.arctan2(row[1], row[0]), np.arctan2(normals[:, 1], normals[:, 0]))
        side, thickness = 0.45 * model.size, 0.01
        zeros = np.zeros_like(yaw)
        self._rec.log(
            entity,
            rr.Boxes3D(
                centers=model.cells_in_world[which],
                half_sizes=np.where(level[:, None], (side, side, thickness), (thickness, side, side)),
                quaternions=np.stack([zeros, zeros, np.sin(yaw / 2), np.cos(yaw / 2)], axis=1),
                class_ids=entities.VOXELS_FROM + labels.astype(np.uint16),
                fill_mode="solid",
            ),
        )

    @draw.register
    def _(self, event: Planned) -> None:
        self._draw_candidates(event)
        self._draw_chosen(event)
        self._draw_grid(event)

    def _draw_candidates(self, event: Planned) -> None:
        candidates = event.plan.candidates
        scores = np.array([candidate.score for candidate in candidates], float)
        possible = np.array([candidate.reason is None for candidate in candidates], bool)
        self._rec.log(
            entities.CANDIDATES,
            rr.Points3D(
                [self._on_floor(candidate.position) for candidate in candidates],
                colors=np.where(possible[:, None], score_colours(scores), np.uint8(90)),
                radii=rr.Radius.ui_points(np.where(possible, 4.5, 2.0)),
            ),
            *hover(
                score=scores,
                gain_m2=np.array([candidate.gain for candidate in candidates], float),
                quality_m2=np.array([candidate.quality for candidate in candidates], float),
                doorway_m2=np.array([candidate.doorway for candidate in candidates], float),
                overlap=np.array([candidate.overlap for candidate in candidates], float),
                travel_m=np.array([candidate.travel for candidate in candidates], float),
                rejected=[candidate.reason or "" for candidate in candidates],
            ),
        )

    def _draw_chosen(self, event: Planned) -> None:
        """The next scan, or nothing when the room is complete."""
        plan = event.plan
        chosen = [] if plan.chosen is None else [plan.candidates[plan.chosen]]
        self._rec.log(
            entities.CHOSEN,
            rr.Arrows3D(
                vectors=[(0.6 * np.cos(c.heading), 0.6 * np.sin(c.heading), 0.0) for c in chosen],
                origins=[self._on_floor(c.position) for c in chosen],
                colors=PLAN_COLOUR,
                radii=0.03,
                labels=[f"next scan: gains {c.gain:.1f} m2, {c.travel:.1f} m away" for c in chosen],
                show_labels=True,
            ),
        )

    def _draw_grid(self, event: Planned) -> None:
        """The occupancy grid, lying on the floor."""
        grid = event.grid
        image = np.ascontiguousarray(CELL_COLOURS[np.minimum(grid.cells, 2)][::-1])  # Rerun wants the top row first
        height, width = grid.cells.shape
        shape = rr.components.ImageFormat(width=width, height=height, color_model="RGBA", channel_datatype="U8")
        corner = (grid.origin[0], grid.origin[1], self._floor + LIFT / 2)
        self._rec.log(
            entities.GRID,
            rr.GridMap(data=image.tobytes(), format=shape, cell_size=grid.resolution, translation=corner),
        )

    def _on_floor(self, position: np.ndarray) -> tuple[float, float, float]:
        return float(position[0]), float(position[1]), self._floor + LIFT
