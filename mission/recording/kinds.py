"""What a field of an event may be, read from its annotation: the one source of schemas, encoding and decoding."""

from __future__ import annotations

import dataclasses
import types
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from typing import Any, Literal, Union, get_args, get_origin, get_type_hints

import numpy as np

from detector.result import WallResult
from detector.room import View
from mission import events
from mission.door_faces import DoorFace
from mission.evaluation import DoorEvaluation
from mission.occupancy import Footprint, OccupancyGrid
from mission.planning import Plan
from mission.pose_graph import Link
from mission.structure import Structure
from mission.voxels import VoxelModel
from sim.door_truth import DoorTruth
from sim.echo import RANGE_STEPS, REFLECTANCE_STEPS
from sim.guardian import RobotShape
from sim.laser_scan import LaserScan
from sim.photo import Photo
from sim.scan import Scan

_NAMES: dict[str, Any] = {
    named.__name__: named
    for named in (
        DoorEvaluation, DoorFace, DoorTruth, Footprint, LaserScan, Link, OccupancyGrid, Photo, Plan, RobotShape, Scan,
        Structure, View, VoxelModel, WallResult,
    )
}  # fmt: skip
"""What annotations of events mean that are for type checkers only."""

EVENTS: dict[str, type[events.Event]] = {kind.__name__: kind for kind in events.Event.__subclasses__()}
"""Every kind of event by its name."""

PARTS = {events.Photographed: "photos", events.DoorsDetected: "results"}
"""Fields that are large: each of their items is recorded on its own, before the event."""

DERIVED = {events.Coloured: "view"}
"""Fields that are not recorded, for they follow from earlier events."""

WALL_CLOCK = {"cost", "stage_seconds"}
"""Fields that are not recorded, for no two runs have the same: one mission gives the same bytes."""

STEPS = {(Scan, "ranges"): RANGE_STEPS, (Scan, "reflectance"): REFLECTANCE_STEPS}
"""Arrays whose values are whole multiples of 1 / steps, if the instrument rounds them."""


RecordType = Any
"""A dataclass or a named tuple: the class itself. (To mypy no `type` can be hashed, which a cache needs.)"""


@dataclass(frozen=True)
class Scalar:
    """float, int, bool, str or bytes."""

    type: type[Any]
    values: tuple[str, ...] = ()
    """All that a string may be; empty for any."""


@dataclass(frozen=True)
class Array:
    """A numpy array."""

    steps: float = 0.0


@dataclass(frozen=True)
class Record:
    """A dataclass or a named tuple."""

    type: RecordType


@dataclass(frozen=True)
class Many:
    """A tuple of things of one kind."""

    item: Kind
    length: int | None = None
    """How many; None for any number."""


@dataclass(frozen=True)
class Group:
    """A tuple of things of several kinds."""

    items: tuple[Kind, ...]


@dataclass(frozen=True)
class Table:
    """A dict."""

    entry: Group
    """Key and value."""


@dataclass(frozen=True)
class Json:
    """A dict of anything that JSON can say."""


@dataclass(frozen=True)
class Maybe:
    """Something or None."""

    item: Kind


Kind = Scalar | Array | Record | Many | Group | Table | Json | Maybe


@cache
def fields_of(record: RecordType) -> dict[str, Kind]:
    """The kind of each field that is recorded, in their order."""
    hints = get_type_hints(record, localns=_NAMES)
    if dataclasses.is_dataclass(record):
        names: Iterator[str] = (field.name for field in dataclasses.fields(record))
    else:
        names = iter(record._fields)
    apart = {PARTS.get(record), DERIVED.get(record), *WALL_CLOCK}
    return {name: _kind(hints[name], STEPS.get((record, name), 0.0)) for name in names if name not in apart}


def defaults_of(record: RecordType) -> set[str]:
    """Names of the fields that may be left out."""
    if dataclasses.is_dataclass(record):
        return {field.name for field in dataclasses.fields(record) if field.default is not dataclasses.MISSING}
    return set(record._field_defaults)


def part_of(event: type[events.Event]) -> Record:
    """The kind of the items of an event's large field."""
    many = _kind(get_type_hints(event, localns=_NAMES)[PARTS[event]], 0.0)
    assert isinstance(many, Many)
    assert isinstance(many.item, Record)
    return many.item


def _kind(hint: Any, steps: float) -> Kind:
    origin, arguments = get_origin(hint), get_args(hint)
    if hint in (float, int, bool, str, bytes):
        return Scalar(hint)
    if hint is np.ndarray or origin is np.ndarray:
        return Array(steps)
    if origin is Literal:
        return Scalar(str, arguments)
    if origin in (Union, types.UnionType) and arguments[-1] is type(None) and len(arguments) == 2:
        return Maybe(_kind(arguments[0], 0.0))
    if origin is tuple:
        return _tuple(arguments)
    if origin is dict:
        if arguments[1] is object:
            return Json()
        return Table(Group((_kind(arguments[0], 0.0), _kind(arguments[1], 0.0))))
    if dataclasses.is_dataclass(hint) or (isinstance(hint, type) and issubclass(hint, tuple)):
        assert isinstance(hint, type)
        return Record(hint)
    raise TypeError(f"cannot be recorded: {hint}")


def _tuple(arguments: tuple[Any, ...]) -> Kind:
    if arguments[-1] is Ellipsis:
        return Many(_kind(arguments[0], 0.0))
    kinds = tuple(_kind(argument, 0.0) for argument in arguments)
    return Many(kinds[0], len(kinds)) if len(set(kinds)) == 1 else Group(kinds)
