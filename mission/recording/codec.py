"""Events as protobuf messages, and back: exact, and without executing anything that is in a file."""

from __future__ import annotations

import json
from typing import Any

from mission.errors import UsageError
from mission.recording.arrays import PackedArray, pack, unpack
from mission.recording.kinds import (
    Array,
    Group,
    Json,
    Kind,
    Many,
    Maybe,
    Record,
    RecordType,
    Scalar,
    Table,
    defaults_of,
    fields_of,
)
from mission.recording.mcap_schemas import group_fields, message_of


def encode(record: Any) -> bytes:
    """A dataclass as the bytes of its message."""
    kind: RecordType = type(record)
    fields = _encoded_fields(record, fields_of(kind))
    return message_of(kind)(**fields).SerializeToString(deterministic=True)


def decode(record: RecordType, message: Any, **others: Any) -> Any:
    """The dataclass that a message was made from.

    Args:
        record: What it was.
        message: Of the type that the file describes.
        others: Fields that are recorded apart.

    Raises:
        UsageError: The message lacks something, or has something else in its place.
    """
    return record(**_decoded_fields(record, message), **others)


def _encoded_fields(record: Any, fields: dict[str, Kind]) -> dict[str, Any]:
    return {name: _encoded(getattr(record, name), kind) for name, kind in fields.items()}


def _encoded(value: Any, kind: Kind) -> Any:
    """What a protobuf constructor takes; None is left out."""
    match kind:
        case Scalar(type=plain):
            return plain(value)
        case Array(steps=steps):
            packed = pack(value, steps=steps)
            return {name: getattr(packed, name) for name in ("dtype", "shape", "steps", "whole", "planes", "data")}
        case Record(type=record):
            return _encoded_fields(value, fields_of(record))
        case Many(item=item):
            wrapped = isinstance(item, Many | Maybe)
            return [{"item_0": _encoded(one, item)} if wrapped else _encoded(one, item) for one in value]
        case Group(items=items):
            parts = zip(group_fields(items).items(), value, strict=True)
            return {name: _encoded(one, item) for (name, item), one in parts}
        case Table(entry=entry):
            return [_encoded(pair, entry) for pair in value.items()]
        case Json():
            return json.dumps(value)
        case Maybe(item=item):
            if value is None:
                return None
            return _encoded((value,), Group((item,))) if isinstance(item, Many | Table) else _encoded(value, item)
    raise AssertionError("unreachable")


def _decoded_fields(record: RecordType, message: Any) -> dict[str, Any]:
    known = {field.name for field in message.DESCRIPTOR.fields}
    values = {}
    for name, kind in fields_of(record).items():
        if name in known:
            values[name] = _decoded(message, name, kind)
        elif name not in defaults_of(record):
            raise UsageError(f"{record.__name__} has no {name}: it was recorded by another version")
    return values


def _decoded(message: Any, name: str, kind: Kind) -> Any:
    """A field's value."""
    if isinstance(kind, Maybe):
        if not message.HasField(name):
            return None
        if isinstance(kind.item, Many | Table):
            return _decoded(getattr(message, name), "item_0", kind.item)
        return _decoded(message, name, kind.item)
    value = getattr(message, name)
    match kind:
        case Many(item=item, length=length):
            if length not in (None, len(value)):
                raise UsageError(f"{name} has {len(value)} items instead of {length}")
            if isinstance(item, Many | Maybe):
                return tuple(_decoded(one, "item_0", item) for one in value)
            return tuple(_single(one, item, name) for one in value)
        case Table(entry=entry):
            return dict(_single(one, entry, name) for one in value)
    return _single(value, kind, name)


def _single(value: Any, kind: Kind, name: str) -> Any:
    match kind:
        case Scalar(type=plain, values=allowed):
            if not isinstance(value, plain) or (allowed and value not in allowed):
                raise UsageError(f"{name} is {value!r}, which it cannot be")
            return value
        case Array():
            return unpack(
                PackedArray(value.dtype, tuple(value.shape), value.steps, value.whole, value.planes, value.data)
            )
        case Record(type=record):
            return record(**_decoded_fields(record, value))
        case Group(items=items):
            return tuple(_decoded(value, part, item) for part, item in group_fields(items).items())
        case Json():
            return json.loads(value)
    raise AssertionError("unreachable")
