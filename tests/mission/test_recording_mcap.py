"""The MCAP recording: complete, readable by the official reader, exact, and the same every time."""

from __future__ import annotations

import resource
import subprocess
import sys
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory

from mission.errors import RecordingError
from mission.events import Coloured, Cost, Drove, Event, MissionFinished, MissionStarted
from mission.recording.drawing import thin
from mission.recording.mcap_messages import xyzw
from mission.recording.mcap_reader import DamagedError, read_events
from mission.recording.mcap_sink import CLOUD_SPACING, EPOCH, McapSink
from mission.recording.mcap_topics import EVENT, TOPICS, topic_of
from tests.mission.recording_room import JOINT
from tests.mission.recording_story import SECOND, bare_story, story

RERUN = Path(sys.executable).with_name("rerun")


def record(path: Path, events: Iterable[Event]) -> Path:
    with McapSink(path) as sink:
        for event in events:
            sink.handle(event)
    return path


def read(path: Path) -> list[tuple[str, str, int, Any]]:
    """(topic, schema, log time, decoded message) of every message, checksums checked."""
    with path.open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()], validate_crcs=True)
        return [
            (channel.topic, schema.name, message.log_time, decoded)
            for schema, channel, message, decoded in reader.iter_decoded_messages(log_time_order=False)
        ]


def on_topic(path: Path, topic: str) -> list[Any]:
    return [message for name, _, _, message in read(path) if name == topic]


def event_of(kind: type[Any]) -> Any:
    return next(event for event in story() if isinstance(event, kind))


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return record(tmp_path_factory.mktemp("mcap") / "mission.mcap", story())


def test_the_same_mission_gives_the_same_bytes(recording: Path, tmp_path: Path) -> None:
    again = record(tmp_path / "another name.mcap", story())
    assert again.read_bytes() == recording.read_bytes()


def test_what_the_mission_took_of_the_machine_changes_no_byte(recording: Path, tmp_path: Path) -> None:
    told = [replace(event, cost=Cost((("scan", 1.5),), 10**9)) for event in story()]
    assert record(tmp_path / "slow.mcap", told).read_bytes() == recording.read_bytes()


def test_rerun_finds_nothing_wrong_with_the_file(recording: Path) -> None:
    assert subprocess.run([RERUN, "mcap", "check", recording], capture_output=True).returncode == 0


def test_every_topic_of_the_table_is_recorded_with_its_schema(recording: Path) -> None:
    assert {topic: schema for topic, schema, _, _ in read(recording)} == {
        name: topic.schema for name, topic in TOPICS.items()
    }


def test_log_times_increase_strictly_from_the_epoch(recording: Path) -> None:
    times = [time for _, _, time, _ in read(recording)]
    assert times[0] == EPOCH
    assert np.diff(times).min() > 0


def events_of(path: Path) -> list[tuple[str, int]]:
    """Topic and step of the message of each event."""
    return [(topic, message.step) for topic, _, _, message in read(path) if topic.count("/") == 2 and EVENT in topic]


def test_each_event_closes_with_itself(recording: Path) -> None:
    assert events_of(recording) == [(topic_of(type(event)), event.step) for event in story()]
    assert read(recording)[-1][0] == topic_of(MissionFinished)


def test_a_mission_that_breaks_leaves_everything_so_far(tmp_path: Path) -> None:
    path = tmp_path / "broken.mcap"
    with pytest.raises(KeyboardInterrupt), McapSink(path) as sink:
        for event in story()[:7]:
            sink.handle(event)
        raise KeyboardInterrupt
    assert [step for _, step in events_of(path)] == list(range(7))


def test_a_file_that_cannot_grow_is_said_once_and_holds_what_was_written_before(tmp_path: Path) -> None:
    path, events = tmp_path / "full.mcap", story()
    with McapSink(path) as sink:
        sink.handle(events[0])
        limits = resource.getrlimit(resource.RLIMIT_FSIZE)
        resource.setrlimit(resource.RLIMIT_FSIZE, (path.stat().st_size + 1000, limits[1]))
        try:
            with pytest.raises(RecordingError, match=r"cannot write .*full\.mcap: "):
                for event in events[1:]:
                    sink.handle(event)
            sink.handle(events[-1])  # lost, without a word
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    got = []
    with pytest.raises(DamagedError):
        for event in read_events(path):
            got.append(event.step)
    assert got[0] == 0


def test_on_a_full_disk_the_reason_is_the_disk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert str(RecordingError(tmp_path / "a.mcap", "strange")).endswith("a.mcap: strange")
    monkeypatch.setattr("mission.errors._FULL", float("inf"))
    assert str(RecordingError(tmp_path / "a.mcap", "strange")).endswith("a.mcap: no space left on the disk")


def test_every_handled_event_is_in_the_file_before_it_is_closed(tmp_path: Path) -> None:
    path = tmp_path / "open.mcap"
    with McapSink(path) as sink:
        for event in story()[:7]:
            sink.handle(event)
        killed = path.read_bytes()  # what a kill -9 would leave
    (tmp_path / "killed.mcap").write_bytes(killed)
    got = []
    with pytest.raises(DamagedError, match=r"ends early; read up to step 6 \(Structured: "):
        for event in read_events(tmp_path / "killed.mcap"):
            got.append(event.step)
    assert got == list(range(7))


def test_clouds_for_viewers_are_at_most_a_millimetre_off(recording: Path) -> None:
    view = event_of(Coloured).view
    cloud = on_topic(recording, "/scan/points")[0]
    names = [field.name for field in cloud.fields]
    packed = np.frombuffer(cloud.data, np.dtype([(n, "<f4") for n in names[:3]] + [(n, "u1") for n in names[3:]]))
    points = np.stack([packed[axis] for axis in "xyz"], axis=1)
    shown = thin(view.points_in_world, cell=CLOUD_SPACING)  # one point a cell
    assert np.abs(points - view.points_in_world[shown]).max() <= 0.5 / 512 + 1e-6  # half a step of the grid
    seen = packed["alpha"] == 255
    np.testing.assert_array_equal(seen, view.coloured[shown])
    colours = np.stack([packed[channel] for channel in ("red", "green", "blue")], axis=1)
    np.testing.assert_array_equal(colours[seen], view.colours[shown][seen])


def test_the_joints_are_recorded_all_along_the_way(recording: Path) -> None:
    states = on_topic(recording, "/truth/joints")
    assert len(states) == 1 + len(event_of(Drove).times)  # the start, then each pose
    assert [(j.name, j.position) for j in states[0].joints] == [("hall/door 1", JOINT), ("store", 0.0), ("lift", 0.5)]
    assert states[-1].timestamp.seconds == EPOCH // SECOND + 100  # the drive ends after 100 s


def test_frames_lead_from_the_map_to_each_photograph(recording: Path) -> None:
    parents = {t.child_frame_id: t.parent_frame_id for m in on_topic(recording, "/tf") for t in m.transforms}
    assert parents["base"] == parents["true base"] == parents["room 1"] == "map"
    for image in on_topic(recording, "/camera/image"):
        assert parents[parents[image.frame_id]] == "room 1"


def test_rooms_lie_in_the_map_where_their_links_put_them(recording: Path) -> None:
    last = {t.child_frame_id: t.translation.x for m in on_topic(recording, "/tf") for t in m.transforms}
    assert (last["room 1"], last["room 2"]) == (0.0, 0.1)


def test_configuration_and_scene_are_attached(recording: Path) -> None:
    start: MissionStarted = event_of(MissionStarted)
    with recording.open("rb") as file:
        reader = make_reader(file, validate_crcs=True)
        attached = {attachment.name: attachment.data for attachment in reader.iter_attachments()}
        metadata = {record.name: record.metadata for record in reader.iter_metadata()}
    assert attached["made_up.xml"].decode() == start.scene_xml
    assert attached["config.json"].decode() == '{\n  "scanner": {\n    "noise": true\n  }\n}'
    assert metadata["mission"] == {"scene": "made_up.xml", "seed": "3"}
    assert metadata["versions"] == start.versions


def test_a_mission_without_points_walls_doors_or_ways_is_recorded(tmp_path: Path) -> None:
    path = record(tmp_path / "bare.mcap", bare_story())
    assert on_topic(path, "/scan/points")[0].data == b""
    assert len(events_of(path)) == len(bare_story())


@pytest.mark.parametrize(
    ("axis", "expected"), [(0, (1, 0, 0, 0)), (1, (0, 1, 0, 0)), (2, (0, 0, 1, 0)), (None, (0, 0, 0, 1))]
)
def test_half_turns_have_unit_quaternions(axis: int | None, expected: tuple[float, ...]) -> None:
    rotation = np.eye(3) if axis is None else np.diag([1.0 if axis == i else -1.0 for i in range(3)])
    assert xyzw(rotation) == pytest.approx(expected)


def test_a_quarter_turn_to_the_left_has_the_sign_of_the_right_hand() -> None:
    turn = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1.0]])  # x goes to y
    assert xyzw(turn) == pytest.approx((0, 0, np.sqrt(0.5), np.sqrt(0.5)))
