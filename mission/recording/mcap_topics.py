"""The topics of the MCAP file, in one table: what README and readers go by."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import foxglove
from foxglove import channels

from mission.recording.mcap_schemas import PACKAGE, OwnChannel

FOXGLOVE = "foxglove"


@dataclass(frozen=True)
class Topic:
    """One topic."""

    schema: str
    """Full protobuf name of its messages."""
    content: str
    """What is in them, with units and frames."""


TOPICS = {
    "/mission/step": Topic("mission.Step", "one message an event, after all its others: step, room, name"),
    "/mission/outcome": Topic("mission.Outcome", "how the mission ended"),
    "/log": Topic("foxglove.Log", "each event in a line for people"),
    "/tf": Topic(
        "foxglove.FrameTransforms",
        "map -> room N (moves as links tie rooms), room N -> scan M, scan M -> photo K, "
        "map -> base (odometry and registration), map -> true base, base -> scanner",
    ),
    "/robot": Topic("foxglove.SceneUpdate", "body of the robot in the frame base [m]"),
    "/scan/points": Topic(
        "foxglove.PointCloud",
        "all points of a scan in its room's frame, to 1/512 m; sRGB, alpha 254 where no photograph saw the point",
    ),
    "/scan/registration": Topic("mission.Registration", "pose of a scan: guess, registered, true"),
    "/camera/image": Topic("foxglove.CompressedImage", "photographs, JPEG, one after the other"),
    "/camera/calibration": Topic("foxglove.CameraCalibration", "of each photograph, before it [px]"),
    "/laser": Topic("foxglove.LaserScan", "Hokuyo scans in the frame base [m, rad], NaN for no return"),
    "/room/structure": Topic("mission.Structure", "floor, ceiling, walls, outline of the floor [m]"),
    "/room/walls": Topic("foxglove.SceneUpdate", "outlines of the walls"),
    "/room/voxels": Topic("mission.Voxels", "labels of the room's voxels, coverage"),
    "/room/voxel_centres": Topic("foxglove.PointCloud", "the same for the eye, coloured by label [m]"),
    "/plan/candidates": Topic("mission.Plan", "all candidates for the next scan with their scores, and the choice"),
    "/plan/grid": Topic("foxglove.Grid", "occupancy [m], state 0 unknown, 1 free, 2 occupied"),
    "/drive/planned_path": Topic("foxglove.PosesInFrame", "way points of a leg [m]"),
    "/drive/leg": Topic("mission.Drive", "how a leg went"),
    "/building/rooms": Topic("mission.Rooms", "rooms, where they lie, and the doors that link them"),
    "/doors/detected": Topic(
        "mission.DetectedDoors", "walls and doors as the detector has them, in the frame of the room [m, rad]"
    ),
    "/doors/estimates": Topic("mission.DoorEstimates", "doors beside the true ones, in the map [m, rad]"),
    "/doors/scene": Topic("foxglove.SceneUpdate", "doors at their estimated angles, and the true leaves"),
    "/truth/joints": Topic("foxglove.JointStates", "true doors, from closed [rad; sliding doors m]"),
}
"""Everything that is recorded; fields of our own schemas are described in `mcap_schemas.PROTO`."""


def open_channels(context: foxglove.Context) -> dict[str, Any]:
    """A channel a topic, each with a method `log(message, log_time=...)`."""
    return {name: _channel(name, topic.schema, context) for name, topic in TOPICS.items()}


def _channel(name: str, schema: str, context: foxglove.Context) -> Any:
    package, _, kind = schema.partition(".")
    if package == PACKAGE:
        return OwnChannel(name, kind, context=context)
    assert package == FOXGLOVE
    return getattr(channels, f"{kind}Channel")(name, context=context)
