"""Photographs for display, and what of the world is to be seen in them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import cv2
import numpy as np
from numpy.typing import NDArray

from mission.recording.drawing import closed, jpeg, shrink
from mission.rigid import Pose, inverted, transformed

if TYPE_CHECKING:
    from detector.room import Wall
    from sim.photo import Photo

WIDTH = 600
"""Photographs are recorded at most this wide [px]; the MCAP has them in full."""
NEAR = 0.1
"""What is nearer to the camera's plane than this is not drawn [m]."""

ENOUGH = 0.05
"""Share of the picture that a door takes up, from which on larger is hardly better."""

Line = NDArray[np.float64]
"""(2, 2) both ends, as x and y in a picture [px]."""


@dataclass
class Shot:
    """A photograph for display, and where it was taken."""

    jpeg: bytes
    intrinsics: NDArray[np.float64]
    width: int
    height: int
    room: int
    room_from_camera: Pose
    """In the room's frame."""
    world_from_room: Pose

    @property
    def world_from_camera(self) -> Pose:
        """(4, 4) as far as is known."""
        return self.world_from_room @ self.room_from_camera

    def shows(self, corners: Sequence[NDArray[np.float64]]) -> float:
        """How well quadrilaterals (4, 3) in the world are to be seen: whole, large, but not filling the picture."""
        return sum(self._shows(quad) for quad in corners)

    def _shows(self, quad: NDArray[np.float64]) -> float:
        in_camera = self._in_camera(quad)
        if in_camera[:, 2].min() < NEAR:
            return 0.0
        drawn = self._projected(in_camera).astype(np.float32)
        frame = np.array([[0, 0], [self.width, 0], [self.width, self.height], [0, self.height]], np.float32)
        shown = cv2.intersectConvexConvex(cv2.convexHull(drawn), frame)[0]
        share = shown / (ENOUGH * self.width * self.height)
        return share / (1.0 + share) * (shown / max(cv2.contourArea(drawn), 1.0)) ** 4

    def outline(self, quad: NDArray[np.float64]) -> list[Line]:
        """The sides of a quadrilateral (4, 3) in the world, as far as the picture has them."""
        in_camera = closed(self._in_camera(quad))
        sides = (_in_front(side) for side in np.stack([in_camera[:-1], in_camera[1:]], axis=1))
        clipped = (self._clipped(self._projected(side)) for side in sides if side is not None)
        return [line for line in clipped if line is not None]

    def _in_camera(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.asarray(transformed(points, inverted(self.world_from_camera)), float)

    def _projected(self, in_camera: NDArray[np.float64]) -> NDArray[np.float64]:
        projected = in_camera @ self.intrinsics.T
        return projected[:, :2] / projected[:, 2:]

    def _clipped(self, line: Line) -> Line | None:
        """The part of a line that lies in the picture (Liang and Barsky)."""
        start, step = line[0], line[1] - line[0]
        first, last = 0.0, 1.0
        for axis, size in enumerate((self.width, self.height)):
            if step[axis] == 0.0:
                if not 0 <= start[axis] <= size:
                    return None
                continue
            ends = sorted((-start[axis] / step[axis], (size - start[axis]) / step[axis]))
            first, last = max(first, ends[0]), min(last, ends[1])
        return np.array([start + first * step, start + last * step]) if first < last else None

    def sees(self, quad: NDArray[np.float64], walls: Sequence[Wall]) -> bool:
        """Whether no wall, in the room's frame, stands before the middle of a quadrilateral (4, 3) in the world."""
        eye = self.room_from_camera[:3, 3]
        middle = transformed(quad.mean(axis=0)[None], inverted(self.world_from_room))[0]
        return not any(_stands_between(wall, eye, middle) for wall in walls)


def shot(photo: Photo, room: int, room_from_scanner: Pose, world_from_room: Pose) -> Shot:
    """A photograph made ready for display."""
    image, factor = shrink(photo.image, width=WIDTH)
    height, width = image.shape[:2]
    intrinsics = np.diag([factor, factor, 1.0]) @ photo.intrinsics
    room_from_camera = room_from_scanner @ photo.scanner_from_camera
    return Shot(jpeg(image), intrinsics, width, height, room, room_from_camera, world_from_room)


def _in_front(side: NDArray[np.float64]) -> NDArray[np.float64] | None:
    """The part of a line (2, 3) that lies before the camera."""
    depths = side[:, 2] - NEAR
    if depths.max() <= 0:
        return None
    if depths.min() >= 0:
        return side
    behind = int(np.argmin(depths))
    cut = side.copy()
    cut[behind] += (side[1 - behind] - side[behind]) * depths[behind] / (depths[behind] - depths[1 - behind])
    return cut


def _stands_between(wall: Wall, eye: NDArray[np.float64], place: NDArray[np.float64]) -> bool:
    """Whether the line from the eye to a place goes through a wall, more than 30 cm before the place."""
    ends = wall.wall_from_world(np.array([eye, place]))
    before, behind = ends[:, 2]
    if before * behind >= 0 or abs(behind) < 0.3:
        return False
    along, up = (ends[0] + before / (before - behind) * (ends[1] - ends[0]))[:2]
    return bool(0 <= along <= wall.width and 0 <= up <= wall.height)
