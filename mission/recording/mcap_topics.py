"""The topics of the MCAP file, in one table: what README and readers go by."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import foxglove
from foxglove import channels

from mission import events
from mission.recording.codec import encode
from mission.recording.kinds import EVENTS, PARTS, RecordType, part_of
from mission.recording.mcap_schemas import PACKAGE, schema_of

PROFILE = "x-door-mission-"
"""Begins the file's profile; the version of the format follows."""
FORMAT = 1
"""Version of how events are recorded."""
FOXGLOVE = "foxglove"
EVENT = "/event/"
"""Topics of the events begin with this; their names follow."""


@dataclass(frozen=True)
class Topic:
    """One topic."""

    schema: str
    """Full protobuf name of its messages."""
    content: str
    """What is in them, with units and frames."""


_EVENTS: dict[type[events.Event], str] = {
    events.MissionStarted: "scene, seed, configuration, versions, start, the robot's shape [m], true doors [m, rad]",
    events.RoomEntered: "how and where the robot came in; where the room's frame lies in the map [m]",
    events.RoomsTied: "graph of rooms and doors, where every room lies in the map [m, rad], exits",
    events.Scanned: "elevations and azimuths [rad], ranges [m] and reflectance [dB] of all beams, NaN for no return; "
    "true pose [m]",
    events.Photographed: "number of the scan that the photographs before belong to",
    events.Registered: "pose of a scan in its room: guess, registered, true [m]; fitness, residual [m]",
    events.Coloured: "number of a scan whose points have their colours: these follow from scan, photographs and pose",
    events.Structured: "floor, ceiling, walls, outline of the floor, in the room's frame [m]",
    events.Labelled: "labels of the room's voxels, their places [m] and areas [m2]",
    events.Planned: "all candidates for the next scan with their scores [m, m2], the choice, the way, the grid [m]",
    events.Drove: "a leg: way points, poses by odometry, true ones [m], joints [rad, m], Hokuyo scans [m, rad]",
    events.DoorsDetected: "heights of floor and ceiling [m]; the walls come before",
    events.DoorsEvaluated: "doors in the map [m, rad] beside the true ones; names of those that were missed",
    events.Remarked: "something worth telling a person",
    events.MissionFinished: "how the mission ended",
}
_PARTS: dict[type[events.Event], str] = {
    events.Photographed: "a photograph: sRGB, intrinsics [px], pose on the scanner [m]; truth: levels by which the "
    "mirror image of the flash brightens it",
    events.DoorsDetected: "a wall with its doors [m, rad], and every stage of the detector: orthoimages, highlights, "
    "openings, wall area, candidates",
}


def topic_of(event: type[events.Event]) -> str:
    """Of an event."""
    return f"{EVENT}{event.__name__}"


def topic_of_parts(event: type[events.Event]) -> str:
    """Of the items of an event's large field, which come before it."""
    return f"{topic_of(event)}/{PARTS[event]}"


RECORDED: dict[str, RecordType] = {topic_of(kind): kind for kind in EVENTS.values()} | {
    topic_of_parts(kind): part_of(kind).type for kind in PARTS
}
"""The dataclass of each message on the topics that hold the events."""

TOPICS = {
    **{topic_of(kind): Topic(f"{PACKAGE}.{kind.__name__}", content) for kind, content in _EVENTS.items()},
    **{topic_of_parts(kind): Topic(f"{PACKAGE}.{part_of(kind).type.__name__}", _PARTS[kind]) for kind in PARTS},
    "/log": Topic("foxglove.Log", "each event in a line for people"),
    "/tf": Topic(
        "foxglove.FrameTransforms",
        "map -> room N (moves as links tie rooms), room N -> scan M, scan M -> photo K, "
        "map -> base (odometry and registration), map -> true base, base -> scanner [m]",
    ),
    "/robot": Topic("foxglove.SceneUpdate", "body of the robot in the frame base [m]"),
    "/scan/points": Topic(
        "foxglove.PointCloud",
        "some points of a scan in its room's frame, one in 2 cm, to 1/512 m; sRGB, alpha 254 where no photo saw it",
    ),
    "/camera/image": Topic("foxglove.CompressedImage", "photographs as JPEG, one after the other"),
    "/camera/calibration": Topic("foxglove.CameraCalibration", "of each photograph, before it [px]"),
    "/laser": Topic("foxglove.LaserScan", "Hokuyo scans in the frame base [m, rad], NaN for no return"),
    "/room/walls": Topic("foxglove.SceneUpdate", "outlines of the walls [m]"),
    "/room/voxel_centres": Topic("foxglove.PointCloud", "the room's voxels, coloured by label [m]"),
    "/plan/grid": Topic("foxglove.Grid", "occupancy [m], state 0 unknown, 1 free, 2 occupied"),
    "/drive/planned_path": Topic("foxglove.PosesInFrame", "way points of a leg [m]"),
    "/doors/scene": Topic("foxglove.SceneUpdate", "doors at their estimated angles, and the true leaves [m]"),
    "/truth/joints": Topic("foxglove.JointStates", "true doors, from closed [rad; sliding doors m]"),
}
"""Everything that is recorded. The events are complete: all else is for viewers, and follows from them."""


def table() -> str:
    """All topics as Markdown."""
    rows = [f"| `{name}` | `{topic.schema}` | {topic.content} |" for name, topic in TOPICS.items()]
    return "\n".join(["| topic | schema | content |", "|---|---|---|", *rows]) + "\n"


class RecordChannel:
    """A channel of dataclasses; `log` takes one."""

    def __init__(self, topic: str, record: RecordType, *, context: foxglove.Context) -> None:
        """Open the channel of a dataclass on a topic."""
        schema = foxglove.Schema(name=f"{PACKAGE}.{record.__name__}", encoding="protobuf", data=schema_of(record))
        self._channel = foxglove.Channel(topic, schema=schema, message_encoding="protobuf", context=context)

    def log(self, record: Any, *, log_time: int) -> None:
        """Write one message."""
        self._channel.log(encode(record), log_time=log_time)


def open_channels(context: foxglove.Context) -> dict[str, Any]:
    """A channel a topic, each with a method `log(message, log_time=...)`."""
    return {name: _channel(name, topic.schema, context) for name, topic in TOPICS.items()}


def _channel(name: str, schema: str, context: foxglove.Context) -> Any:
    package, _, kind = schema.partition(".")
    if package == PACKAGE:
        return RecordChannel(name, RECORDED[name], context=context)
    assert package == FOXGLOVE
    return getattr(channels, f"{kind}Channel")(name, context=context)


if __name__ == "__main__":
    import sys

    sys.stdout.write(table())
