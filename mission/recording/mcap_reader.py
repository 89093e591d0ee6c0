"""The events of a mission, read back from its MCAP file: one at a time, every checksum checked, nothing executed."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Collection, Iterator
from pathlib import Path
from typing import IO, Any

import zstandard
from google.protobuf.message import DecodeError
from mcap.exceptions import EndOfFile, McapError, RecordLengthLimitExceeded
from mcap.records import Channel, Chunk, Footer, Header, McapRecord, Message, Schema
from mcap.stream_reader import CRCValidationError, StreamReader, breakup_chunk

from detector.room import View
from mission.colouring import colour_scan
from mission.errors import MissionError, UsageError
from mission.events import Event, Photographed, Registered, Scanned
from mission.recording.codec import decode
from mission.recording.kinds import DERIVED, PARTS, RecordType
from mission.recording.mcap_schemas import PACKAGE, message_class
from mission.recording.mcap_topics import EVENT, FORMAT, PROFILE, RECORDED, topic_of, topic_of_parts
from mission.recording.sentences import sentence

MAGIC = b"\x89MCAP0\r\n"
FOREIGN = {b"#ROSBAG": "a ROS bag", b"RRF": "a Rerun recording, whose MCAP is beside it", b"SQLite": "a database"}
"""What else people have, by its first bytes."""
LARGEST = 1 << 31
"""No part of an event is as large when unpacked [bytes]."""
DAMAGE = (
    McapError,
    CRCValidationError,
    zstandard.ZstdError,
    struct.error,
    UnicodeDecodeError,
    DecodeError,
    EOFError,
    MemoryError,
)
"""What reading a damaged file leads to."""


class DamagedError(UsageError):
    """A recording ends early or is damaged; the events before it are good."""


def read_events(path: Path, *, without: Collection[type[Event]] = ()) -> Iterator[Event]:
    """Read a recording event by event.

    Args:
        path: The MCAP file.
        without: Kinds of events to leave out; what they carry is not decoded.

    Raises:
        UsageError: There is no such file, or it is no recording of a mission.
        DamagedError: After the last event before the file ends early, or is damaged. One line says what was read.
    """
    last: Event | None = None
    try:
        with path.open("rb") as file:
            check_magic(file, path)
            for event in _Decoder(path, without).events(_records(file, path)):
                last = event
                yield event
    except OSError as error:
        raise UsageError(f"{error.strerror}: {path}") from error
    except DAMAGE as error:
        raise DamagedError(f"{path}: {_fault(error)}; {_read(last)}") from error


def check_magic(file: IO[bytes], path: Path) -> None:
    """See that a file is an MCAP file.

    Raises:
        UsageError: It is not, and what it may be.
    """
    first = file.read(len(MAGIC))
    file.seek(0)
    if not first:
        raise UsageError(f"the file is empty: {path}")
    if first != MAGIC[: len(first)]:
        what = next((name for start, name in FOREIGN.items() if first.startswith(start)), "something else")
        raise UsageError(f"not an MCAP file, but {what}: {path}")


def _records(file: IO[bytes], path: Path) -> Iterator[McapRecord]:
    """All records, chunks taken apart."""
    size = path.stat().st_size
    for record in StreamReader(file, emit_chunks=True, validate_crcs=True, record_size_limit=size).records:
        match record:
            case Header():
                _check_profile(record.profile, path)
            case Chunk():
                _check_size(record)
                yield from breakup_chunk(record, validate_crc=True)
            case Footer():
                _check_summary(path, record)
            case _:
                yield record


def _check_profile(profile: str, path: Path) -> None:
    version = profile.removeprefix(PROFILE)
    if not profile.startswith(PROFILE) or not version.isdecimal() or len(version) > 9:
        raise UsageError(f"an MCAP file, but no recording of a mission (its profile is {profile!r}): {path}")
    if int(version) > FORMAT:
        raise UsageError(f"written by a newer version (format {version}, this one reads up to {FORMAT}): {path}")


def _check_size(chunk: Chunk) -> None:
    """Before memory is taken for what a chunk says to hold."""
    says = chunk.uncompressed_size
    if says > LARGEST or (chunk.compression == "zstd" and zstandard.frame_content_size(chunk.data) not in (says, -1)):
        raise McapError("a chunk has a wrong size")


def _check_summary(path: Path, footer: Footer) -> None:
    """The index at the end, which is not read, has a checksum of its own."""
    if not footer.summary_start or not footer.summary_crc:
        return
    with path.open("rb") as file:
        file.seek(footer.summary_start)
        summary = file.read()[: -len(MAGIC) - 4]  # up to the checksum itself
    if zlib.crc32(summary) != footer.summary_crc:
        raise McapError("the checksum of the index is wrong")


class _Decoder:
    """Puts events together from the records of a file."""

    def __init__(self, path: Path, without: Collection[type[Event]]) -> None:
        self._path = path
        self._without = {topic_of(kind) for kind in without}
        self._schemas: dict[int, Schema] = {}
        self._channels: dict[int, Channel] = {}
        self._classes: dict[int, Any] = {}
        self._parts: dict[str, list[Any]] = {}
        self._measured: dict[type[Event], Any] = {}

    def events(self, records: Iterator[McapRecord]) -> Iterator[Event]:
        for record in records:
            match record:
                case Schema():
                    self._schemas[record.id] = record
                case Channel():
                    self._channels[record.id] = record
                case Message():
                    event = self._take(record)
                    if event is not None:
                        yield event

    def _take(self, message: Message) -> Event | None:
        """The event that a message completes."""
        if message.channel_id not in self._channels:
            raise McapError("a message has no channel")
        topic = self._channels[message.channel_id].topic
        kind = RECORDED.get(topic)
        if kind is None:
            if topic.startswith(EVENT):
                raise UsageError(f"{self._path} has the unknown topic {topic}: it was recorded by another version")
            return None
        if topic in self._without or topic.rpartition("/")[0] in self._without:
            return None
        content = self._parsed(kind, message)
        decoded = self._decoded(kind, content, **self._recorded_apart(kind, content))
        if not isinstance(decoded, Event):
            self._parts.setdefault(topic, []).append(decoded)
            return None
        if isinstance(decoded, Scanned | Photographed | Registered):
            self._measured[type(decoded)] = decoded
        return decoded

    def _parsed(self, kind: RecordType, message: Message) -> Any:
        """The message as the file itself describes it."""
        if message.channel_id not in self._classes:
            schema = self._schemas.get(self._channels[message.channel_id].schema_id)
            if schema is None or schema.name != f"{PACKAGE}.{kind.__name__}":
                raise McapError(f"{kind.__name__} has no schema")
            try:
                self._classes[message.channel_id] = message_class(schema.data, kind.__name__)
            except (TypeError, KeyError) as error:
                raise McapError(f"{kind.__name__} has a broken schema") from error
        return self._classes[message.channel_id].FromString(message.data)

    def _decoded(self, kind: RecordType, content: Any, **others: Any) -> Any:
        try:
            return decode(kind, content, **others)
        except (AttributeError, TypeError, ValueError, LookupError, ArithmeticError, RecursionError) as error:
            raise UsageError(f"{self._path}: {kind.__name__} was recorded by another version ({error})") from error
        except UsageError as error:
            raise UsageError(f"{self._path}: {error}") from error

    def _recorded_apart(self, kind: RecordType, content: Any) -> dict[str, Any]:
        """What of an event is not in its own message."""
        if kind in PARTS:
            return {PARTS[kind]: tuple(self._parts.pop(topic_of_parts(kind), ()))}
        if kind in DERIVED:
            return {DERIVED[kind]: self._view(content.scan_number)}
        return {}

    def _view(self, number: int) -> View:
        """The coloured points of a scan: they follow from scan, photographs and pose."""
        scan, photos, pose = (self._measured.get(kind) for kind in (Scanned, Photographed, Registered))
        if not (scan and photos and pose) or not scan.scan_number == photos.scan_number == pose.scan_number == number:
            raise UsageError(f"{self._path} lacks what scan {number} was coloured from")
        try:
            return colour_scan(scan.scan, photos.photos, pose.world_from_scanner)
        except (ValueError, LookupError, ArithmeticError, MissionError) as error:  # shapes that do not fit each other
            raise UsageError(f"{self._path}: scan {number} cannot be coloured ({error})") from error


def _fault(error: BaseException) -> str:
    """What is wrong with the file, in some words."""
    if isinstance(error, EndOfFile | RecordLengthLimitExceeded | EOFError | struct.error):
        return "the file ends early"
    if isinstance(error, CRCValidationError):
        return "the file is damaged: a checksum is wrong"
    return f"the file is damaged: {' '.join(str(error).split()) or type(error).__name__}"


def _read(last: Event | None) -> str:
    """What could be read, in some words."""
    if last is None:
        return "nothing could be read"
    return f"read up to step {last.step} ({type(last).__name__}: {sentence(last)})"
