"""Our own protobuf schemas, for what Foxglove has none; built at run time, so that nothing has to be generated."""

from __future__ import annotations

from typing import Any

import foxglove
from google.protobuf import descriptor_pb2, descriptor_pool, message_factory

PACKAGE = "mission"

PROTO = """
message Step                              # one an event, after all its other messages
  uint32 step                             # counts events from 0
  uint32 room                             # from 1
  string event                            # name of the event

message Registration                      # where a scan is in its room's frame
  uint32 scan                             # from 1
  repeated double guess_world_from_scanner  # from odometry, 4 x 4 row by row [m]
  repeated double world_from_scanner      # 4 x 4 row by row [m]
  double fitness                          # share of the sampled points with a partner in the map
  double rmse                             # of the partners, point to plane [m]
  bool accepted
  string reason
  repeated double true_world_from_scanner  # truth, 4 x 4 row by row [m]

message Wall                              # a rectangle as seen from inside the room
  repeated double origin                  # bottom left corner (x, y, z) in the room's frame [m]
  repeated double u                       # unit vector to the right
  repeated double v                       # unit vector up
  double width                            # [m]
  double height                           # [m]

message Structure                         # floor, ceiling and walls
  uint32 scan                             # last scan it rests on
  double floor_height                     # [m]
  double ceiling_height                   # [m], NaN where there is none
  repeated Wall walls                     # counter-clockwise seen from above
  repeated double polygon                 # x, y of each corner of the floor [m]

message LabelGrid                         # labels of a surface's voxels
  string surface                          # "wall 1", "floor", "ceiling"
  uint32 rows                             # of a wall from its top, of floor and ceiling from their origin
  uint32 columns
  bytes labels                            # row by row, 0 outside the room, 1 occupied, 2 occluded, 3 opening
  repeated double origin                  # corner of the first cell [m]; empty for a wall, which has its own
  repeated double u                       # unit vector along a row
  repeated double v                       # unit vector along a column

message Voxels                            # labels of all structure
  uint32 scan                             # last scan they rest on
  double coverage                         # share of the structure's area that is not occluded
  double size                             # side of a voxel [m]
  repeated LabelGrid grids
  repeated double clutter                 # x, y, z of the centre of each voxel that holds something else [m]

message Candidate                         # a place to scan from
  double x                                # [m]
  double y                                # [m]
  double heading                          # [rad]
  double gain                             # occluded structure that would come into view [m2]
  double quality                          # wall that would be seen less obliquely than ever [m2]
  double doorway                          # openings that would be seen from a new side [m2]
  double overlap                          # share of the structure in view that is known
  double travel                           # way there [m]
  double score                            # the choice goes by it
  string reason                           # why it is out of the question, else empty

message Plan                              # where to scan next
  uint32 scan                             # last scan it rests on
  repeated Candidate candidates
  int32 chosen                            # index of the chosen candidate, -1 for none
  string stop_reason                      # empty if there is to be another scan
  double coverage                         # share of the structure's area that is not occluded

message Drive                             # a leg of the way
  repeated double planned_path            # x, y of each way point [m]
  string outcome                          # arrived, blocked, stuck or contact
  string reason                           # the outcome in words
  uint32 poses                            # recorded poses, in /tf

message DoorEstimate                      # a door as the detector has it, beside the truth
  string id                               # room, wall and a letter
  uint32 wall                             # from 1
  string kind                             # single, double or sliding
  string state                            # closed, semi-open or open
  double width                            # [m]
  double height                           # [m]
  repeated double corners                 # x, y, z of bottom left, bottom right, top right, top left [m]
  double opening_angle                    # of the wider open leaf [rad], NaN if not seen
  double opening_angle_std                # standard deviation [rad]
  repeated double leaf_angles             # [rad]
  string hinge                            # left, right, both or none
  string opens                            # inward or outward, else empty
  string true_name                        # truth: the door's name, empty for a false positive
  double true_angle                       # truth [rad], NaN for a false positive
  double angle_error                      # estimate less truth [rad], NaN without either
  double precision                        # shares of area, NaN for a false positive
  double recall
  double opened_fraction                  # share of the doorway that a sliding door leaves open, NaN if hinged
  double true_opened_fraction             # truth, NaN for a false positive, too
  double confidence                       # 0 to 1

message DoorEstimates                     # all doors of a room
  repeated DoorEstimate doors
  repeated string missed                  # names of true doors that were not found

message DetectedDoors                     # what the detector found, before any comparison
  double floor_height                     # [m]
  double ceiling_height                   # [m], NaN where there is none
  repeated DetectedWall walls

message DetectedWall
  Wall wall
  repeated DetectedDoor doors             # from left to right

message DetectedDoor
  repeated double rectangle               # left, bottom, right, top on the wall [m]
  string kind
  string state
  repeated DetectedLeaf leaves            # from left to right
  double confidence                       # 0 to 1

message DetectedLeaf
  string hinge                            # left, right or none
  double opening_angle                    # [rad]
  double opening_angle_std                # [rad]
  string opens                            # inward or outward, else empty
  double slid                             # way of a sliding leaf along the wall, to the right [m]

message Rooms                             # the graph of rooms and doors
  repeated RoomNode rooms
  repeated RoomLink links
  repeated string exits                   # doors of the last room that the robot can drive through
  repeated string refused                 # the others, each with the reason

message RoomNode
  uint32 room                             # from 1
  repeated double world_from_room         # where its frame lies in the map, 4 x 4 row by row [m]

message RoomLink                          # what ties two rooms together
  uint32 first                            # room
  uint32 second                           # room
  repeated string doors                   # the two faces of the door that links them; none for a link by scans
  repeated double in_first                # x, y, z of a place in the first room's frame [m]
  repeated double in_second               # and in the second's [m]
  double turn                             # of the second frame in the first, about z [rad]
  repeated double deviations              # 1 sigma of the place [m], then of the turn [rad]
  repeated string states                  # of the door, as each room saw it: closed, semi-open or open
  repeated double opening_angles          # likewise [rad], NaN if not seen

message Outcome                           # how the mission ended
  string outcome                          # completed, interrupted or failed
  string reason
"""
"""Message types, a field a line, numbered in their order: new fields go to the end."""

_TYPES = {
    "double": descriptor_pb2.FieldDescriptorProto.TYPE_DOUBLE,
    "uint32": descriptor_pb2.FieldDescriptorProto.TYPE_UINT32,
    "int32": descriptor_pb2.FieldDescriptorProto.TYPE_INT32,
    "bool": descriptor_pb2.FieldDescriptorProto.TYPE_BOOL,
    "string": descriptor_pb2.FieldDescriptorProto.TYPE_STRING,
    "bytes": descriptor_pb2.FieldDescriptorProto.TYPE_BYTES,
}


def file_descriptor(text: str = PROTO) -> descriptor_pb2.FileDescriptorProto:
    """The schemas as protobuf wants them."""
    file = descriptor_pb2.FileDescriptorProto(name="mission.proto", package=PACKAGE, syntax="proto3")
    for line in text.splitlines():
        words = line.partition("#")[0].split()
        if words[:1] == ["message"]:
            file.message_type.add(name=words[1])
        elif words:
            _add_field(file.message_type[-1], *words)
    return file


def _add_field(message: descriptor_pb2.DescriptorProto, *words: str) -> None:
    *repeated, kind, name = words
    field = message.field.add(name=name, number=len(message.field) + 1)
    proto = descriptor_pb2.FieldDescriptorProto
    field.label = proto.LABEL_REPEATED if repeated else proto.LABEL_OPTIONAL
    if kind in _TYPES:
        field.type = _TYPES[kind]
    else:
        field.type, field.type_name = proto.TYPE_MESSAGE, f".{PACKAGE}.{kind}"


_FILE = file_descriptor()
_POOL = descriptor_pool.DescriptorPool()
_POOL.Add(_FILE)
_SET = descriptor_pb2.FileDescriptorSet(file=[_FILE]).SerializeToString(deterministic=True)


class OwnChannel:
    """A channel of one of our own message types; `log` takes the fields by name."""

    def __init__(self, topic: str, kind: str, *, context: foxglove.Context) -> None:
        """Open the channel of a message type, "Plan" say, on a topic."""
        self._type = message_factory.GetMessageClass(_POOL.FindMessageTypeByName(f"{PACKAGE}.{kind}"))
        schema = foxglove.Schema(name=f"{PACKAGE}.{kind}", encoding="protobuf", data=_SET)
        self._channel = foxglove.Channel(topic, schema=schema, message_encoding="protobuf", context=context)

    def log(self, fields: dict[str, Any], *, log_time: int) -> None:
        """Write one message; nested messages are dicts, too."""
        self._channel.log(self._type(**fields).SerializeToString(deterministic=True), log_time=log_time)
