"""Protobuf schemas of the events, built at run time from their dataclasses, so that nothing has to be kept alike."""

from __future__ import annotations

from functools import cache
from typing import Any

from google.protobuf import descriptor_pb2, descriptor_pool, message_factory

from mission.recording.kinds import Array, Group, Json, Kind, Many, Maybe, Record, RecordType, Scalar, Table, fields_of

PACKAGE = "mission"

ARRAY = "Array"
"""The message that an array is: see `mission.recording.arrays.PackedArray`."""

_Proto = descriptor_pb2.FieldDescriptorProto
_TYPES = {
    float: _Proto.TYPE_DOUBLE,
    int: _Proto.TYPE_INT64,
    bool: _Proto.TYPE_BOOL,
    str: _Proto.TYPE_STRING,
    bytes: _Proto.TYPE_BYTES,
}


@cache
def schema_of(record: RecordType) -> bytes:
    """A FileDescriptorSet with the message type of a record, and those of its parts."""
    return descriptor_pb2.FileDescriptorSet(file=[_file(record)]).SerializeToString(deterministic=True)


@cache
def message_of(record: RecordType) -> type[Any]:
    """The protobuf class of a record's messages."""
    return message_class(schema_of(record), record.__name__)


def message_class(schema: bytes, name: str) -> type[Any]:
    """The protobuf class of a message type in a FileDescriptorSet.

    Raises:
        google.protobuf.message.DecodeError, TypeError, KeyError: There is no such type in it, or it is none.
    """
    pool = descriptor_pool.DescriptorPool()
    for file in descriptor_pb2.FileDescriptorSet.FromString(schema).file:
        pool.Add(file)
    return message_factory.GetMessageClass(pool.FindMessageTypeByName(f"{PACKAGE}.{name}"))


def _file(record: RecordType) -> descriptor_pb2.FileDescriptorProto:
    file = descriptor_pb2.FileDescriptorProto(name=f"{record.__name__}.proto", package=PACKAGE, syntax="proto3")
    _Builder(file).message(record.__name__, fields_of(record))
    return file


class _Builder:
    """Adds message types to a file, each once."""

    def __init__(self, file: descriptor_pb2.FileDescriptorProto) -> None:
        self._file = file
        self._known: dict[str, Any] = {}

    def message(self, name: str, fields: dict[str, Kind]) -> str:
        """Full name of the message type with these fields."""
        if name not in self._known:
            self._known[name] = fields
            message = descriptor_pb2.DescriptorProto(name=name)
            for field, kind in fields.items():
                self._add(message, field, kind)
            self._file.message_type.append(message)
        assert self._known[name] == fields, f"two things are called {name}"
        return f".{PACKAGE}.{name}"

    def _add(self, message: descriptor_pb2.DescriptorProto, name: str, kind: Kind) -> None:
        label = _Proto.LABEL_OPTIONAL
        optional = isinstance(kind, Maybe)
        if isinstance(kind, Maybe):
            kind = Group((kind.item,)) if isinstance(kind.item, Many | Table) else kind.item
        if isinstance(kind, Many):
            label, kind = _Proto.LABEL_REPEATED, kind.item
        if isinstance(kind, Table):
            label, kind = _Proto.LABEL_REPEATED, kind.entry
        field = message.field.add(name=name, number=len(message.field) + 1, label=label)
        match kind:
            case Scalar(type=plain):
                field.type = _TYPES[plain]
            case Json():
                field.type = _Proto.TYPE_STRING
            case _:
                field.type = _Proto.TYPE_MESSAGE
                field.type_name = self._type_name(kind, f"{message.name}_{name}")
        if optional and field.type != _Proto.TYPE_MESSAGE:
            field.proto3_optional, field.oneof_index = True, len(message.oneof_decl)
            message.oneof_decl.add(name=f"_{name}")

    def _type_name(self, kind: Kind, nameless: str) -> str:
        match kind:
            case Array():
                return self.message(ARRAY, _ARRAY_FIELDS)
            case Record(type=record):
                return self.message(record.__name__, fields_of(record))
            case Group(items=items):
                return self.message(nameless, group_fields(items))
            case Many() | Maybe():
                return self.message(nameless, group_fields((kind,)))
        raise TypeError(f"no message type for {kind}")


def group_fields(items: tuple[Kind, ...]) -> dict[str, Kind]:
    """The fields of a tuple of several kinds: item_0, item_1, ..."""
    return {f"item_{place}": item for place, item in enumerate(items)}


_ARRAY_FIELDS: dict[str, Kind] = {
    "dtype": Scalar(str),
    "shape": Many(Scalar(int)),
    "steps": Scalar(float),
    "whole": Scalar(str),
    "planes": Scalar(int),
    "data": Scalar(bytes),
}
