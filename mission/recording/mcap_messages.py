"""Foxglove messages from the mission's arrays."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from foxglove.messages import (
    CameraCalibration,
    Color,
    CompressedImage,
    FrameTransform,
    Grid,
    LaserScan,
    LinePrimitive,
    LinePrimitiveLineType,
    PackedElementField,
    PackedElementFieldNumericType,
    Point3,
    PointCloud,
    Pose,
    Quaternion,
    SceneEntity,
    TextPrimitive,
    Timestamp,
    TriangleListPrimitive,
    Vector2,
    Vector3,
)
from numpy.typing import NDArray

from mission.recording.drawing import ARCHIVE_QUALITY, CELL_COLOURS, UNCOLOURED, jpeg, on_grid

MAP = "map"
"""Frame of the scene's world, in which the mission's map is made."""


def room_frame(room: int) -> str:
    """Frame of a room, in which all that is measured in it is given; links between rooms move it in the map."""
    return f"room {room}"


SEEN, UNSEEN = 255, 254
"""Alpha of points: 254 marks a grey that stands in where no photograph saw the point. Viewers show both alike."""

RGBA = ("red", "green", "blue", "alpha")
"""Names that viewers look for."""

_BLOCK = 1 << 16
_FLOAT, _BYTE = PackedElementFieldNumericType.Float32, PackedElementFieldNumericType.Uint8


def timestamp(nanoseconds: int) -> Timestamp:
    """A time since the epoch."""
    return Timestamp(*divmod(nanoseconds, 1_000_000_000))


def vector(values: NDArray[np.floating]) -> Vector3:
    """(3,) as a message."""
    x, y, z = (float(value) for value in values)
    return Vector3(x=x, y=y, z=z)


def points(values: NDArray[np.floating]) -> list[Point3]:
    """(N, 3) as messages."""
    return [Point3(x=x, y=y, z=z) for x, y, z in np.asarray(values, float).tolist()]


def xyzw(rotation: NDArray[np.float64]) -> NDArray[np.float64]:
    """A rotation matrix (3, 3) as unit quaternion (x, y, z, w) with w >= 0.

    4 q q' is made of sums and differences of the matrix; its longest row is q up to scale, free of small divisors.
    """
    m = rotation
    k = np.array(
        [
            [1 + m[0, 0] - m[1, 1] - m[2, 2], m[0, 1] + m[1, 0], m[0, 2] + m[2, 0], m[2, 1] - m[1, 2]],
            [m[0, 1] + m[1, 0], 1 - m[0, 0] + m[1, 1] - m[2, 2], m[1, 2] + m[2, 1], m[0, 2] - m[2, 0]],
            [m[0, 2] + m[2, 0], m[1, 2] + m[2, 1], 1 - m[0, 0] - m[1, 1] + m[2, 2], m[1, 0] - m[0, 1]],
            [m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1], 1 + m[0, 0] + m[1, 1] + m[2, 2]],
        ]
    )
    row = k[np.argmax(np.diag(k))]
    return row / np.sqrt(np.sum(row**2)) * (1.0 if row[3] >= 0 else -1.0)


def quaternion(rotation: NDArray[np.float64]) -> Quaternion:
    """A rotation matrix (3, 3) as a message."""
    x, y, z, w = xyzw(rotation).tolist()
    return Quaternion(x=x, y=y, z=z, w=w)


def transform(time: int, parent: str, name: str, parent_from_child: NDArray[np.float64]) -> FrameTransform:
    """Where a frame is in its parent."""
    return FrameTransform(
        timestamp=timestamp(time),
        parent_frame_id=parent,
        child_frame_id=name,
        translation=vector(parent_from_child[:3, 3]),
        rotation=quaternion(parent_from_child[:3, :3]),
    )


def pose(world_from_x: NDArray[np.float64]) -> Pose:
    """A pose as a message."""
    return Pose(position=vector(world_from_x[:3, 3]), orientation=quaternion(world_from_x[:3, :3]))


def cloud(
    time: int,
    points: NDArray[np.float32],
    colours: NDArray[np.uint8],
    coloured: NDArray[np.bool_],
    *,
    frame: str,
) -> PointCloud:
    """Points in a room's frame, rounded to the recording's grid."""
    return PointCloud(
        timestamp=timestamp(time),
        frame_id=frame,
        pose=_here(),
        point_stride=16,
        fields=[PackedElementField(name=name, offset=4 * place, type=_FLOAT) for place, name in enumerate("xyz")]
        + [PackedElementField(name=name, offset=12 + place, type=_BYTE) for place, name in enumerate(RGBA)],
        data=_packed(points, colours, coloured),
    )


def _packed(points: NDArray[np.float32], colours: NDArray[np.uint8], coloured: NDArray[np.bool_]) -> bytes:
    """Four words a point, x y z rgba; block by block, for a block stays in the processor's cache."""
    packed = np.empty((len(points), 4), "<f4")
    tints = packed.view("<u4")[:, 3]
    grey = np.array([*UNCOLOURED, UNSEEN], np.uint8).view("<u4")[0]
    for start in range(0, len(packed), _BLOCK):
        block = slice(start, start + _BLOCK)
        packed[block, :3] = on_grid(points[block])
        rgba = np.full((len(packed[block]), 4), SEEN, np.uint8)
        rgba[:, :3] = colours[block]
        tints[block] = np.where(coloured[block], rgba.view("<u4")[:, 0], grey)
    return packed.tobytes()


def photograph(time: int, frame: str, image: NDArray[np.uint8]) -> CompressedImage:
    """A photograph as JPEG."""
    return CompressedImage(
        timestamp=timestamp(time), frame_id=frame, data=jpeg(image, quality=ARCHIVE_QUALITY), format="jpeg"
    )


def calibration(time: int, frame: str, image: NDArray[np.uint8], intrinsics: NDArray[np.float64]) -> CameraCalibration:
    """The pinhole camera of a photograph, free of distortion; the first pixel's centre is at (0.5, 0.5)."""
    height, width = image.shape[:2]
    projection = np.hstack([intrinsics, np.zeros((3, 1))])
    return CameraCalibration(
        timestamp=timestamp(time),
        frame_id=frame,
        width=width,
        height=height,
        K=intrinsics.ravel().tolist(),
        R=np.eye(3).ravel().tolist(),
        P=projection.ravel().tolist(),
    )


def laser_scan(
    time: int, frame: str, base_from_laser: NDArray[np.float64], angles: NDArray[np.floating], ranges: NDArray
) -> LaserScan:
    """A fan of ranges; NaN where nothing came back."""
    return LaserScan(
        timestamp=timestamp(time),
        frame_id=frame,
        pose=pose(base_from_laser),
        start_angle=float(angles[0]),
        end_angle=float(angles[-1]),
        ranges=np.asarray(ranges, float).tolist(),
    )


def occupancy(
    time: int, origin: NDArray[np.float64], resolution: float, cells: NDArray[np.uint8], *, frame: str
) -> Grid:
    """An occupancy grid: colours for viewers, and the state of the cell (0 unknown, 1 free, 2 occupied)."""
    packed = np.concatenate([CELL_COLOURS[np.minimum(cells, 2)], cells[:, :, None]], axis=2)
    names = (*RGBA, "state")
    corner = np.eye(4)
    corner[:2, 3] = origin
    return Grid(
        timestamp=timestamp(time),
        frame_id=frame,
        pose=pose(corner),
        column_count=cells.shape[1],
        cell_size=Vector2(x=resolution, y=resolution),
        row_stride=packed.shape[1] * packed.shape[2],
        cell_stride=packed.shape[2],
        fields=[PackedElementField(name=name, offset=place, type=_BYTE) for place, name in enumerate(names)],
        data=packed.tobytes(),
    )


def colour(rgb: Sequence[int], opacity: float = 1.0) -> Color:
    """8-bit sRGB as a message."""
    return Color(r=rgb[0] / 255, g=rgb[1] / 255, b=rgb[2] / 255, a=opacity)


def lines(strips: Iterable[NDArray[np.floating]], rgb: Sequence[int], *, width: float = 0.02) -> list[LinePrimitive]:
    """Open lines (N, 3) of one colour, `width` metres thick."""
    kind, tint = LinePrimitiveLineType.LineStrip, colour(rgb)
    return [LinePrimitive(type=kind, pose=_here(), thickness=width, points=points(s), color=tint) for s in strips]


def text(place: NDArray[np.floating], words: str, rgb: Sequence[int], *, size: float = 0.15) -> TextPrimitive:
    """Words that face the viewer; `size` in metres."""
    where = Pose(position=vector(place), orientation=Quaternion(x=0, y=0, z=0, w=1))
    return TextPrimitive(pose=where, billboard=True, font_size=size, color=colour(rgb), text=words)


def surface(
    vertices: NDArray[np.floating], triangles: NDArray[np.integer], *, colours: Sequence[Color] = (),
    tint: Color | None = None,
) -> TriangleListPrimitive:  # fmt: skip
    """A mesh: (V, 3) vertices [m], (T, 3) triangles, a colour a vertex or one tint."""
    indices = triangles.ravel().tolist()
    return TriangleListPrimitive(
        pose=_here(), points=points(vertices), color=tint, colors=list(colours), indices=indices
    )


def scene_entity(
    time: int,
    name: str,
    *,
    frame: str = MAP,
    lines: Sequence[LinePrimitive] = (),
    triangles: Sequence[TriangleListPrimitive] = (),
    texts: Sequence[TextPrimitive] = (),
) -> SceneEntity:
    """A thing to draw, which replaces the one of the same name and stays until it is replaced."""
    return SceneEntity(
        timestamp=timestamp(time),
        frame_id=frame,
        id=name,
        frame_locked=frame != MAP,
        lines=list(lines),
        triangles=list(triangles),
        texts=list(texts),
    )


def _here() -> Pose:
    return Pose(position=Vector3(x=0, y=0, z=0), orientation=Quaternion(x=0, y=0, z=0, w=1))
