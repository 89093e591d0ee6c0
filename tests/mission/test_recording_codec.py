"""What is recorded of an event is all of it: arrays as bytes, dataclasses as messages, and back."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pytest

from mission import events
from mission.errors import UsageError
from mission.recording.arrays import PackedArray, pack, unpack
from mission.recording.codec import decode, encode
from mission.recording.kinds import DERIVED, EVENTS, PARTS
from mission.recording.mcap_schemas import message_of, schema_of
from mission.recording.mcap_topics import TOPICS, table, topic_of
from tests.mission.events_alike import differences
from tests.mission.recording_story import bare_story, story

RNG = np.random.default_rng(7)
QUARTERS = np.where(RNG.random((50, 60)) < 0.1, np.nan, RNG.integers(-300, 9000, (50, 60)) / 4).astype(np.float32)


@pytest.mark.parametrize(
    "array",
    [
        RNG.integers(-(2**31), 2**31, (70, 50), dtype=np.int32),  # differences wrap round
        RNG.integers(-(2**63), 2**63, 3000, dtype=np.int64),
        RNG.integers(0, 256, (40, 50, 3), dtype=np.uint8),
        RNG.random((51, 53)) < 0.5,  # no whole number of bytes
        RNG.normal(size=(50, 60)).astype(np.float32),
        RNG.normal(size=3000),
        QUARTERS,
        np.where(QUARTERS == 0, np.float32(-0.0), QUARTERS),
        QUARTERS + np.float32(0.1),  # no whole quarters
        QUARTERS * 10,
        np.abs(QUARTERS) * 5,
        QUARTERS + 2**23,  # beyond what float32 holds of them
        np.full((40, 50), np.nan, np.float32),
        np.zeros((40, 50), np.int32),
        np.zeros((0, 3)),
        np.array(3.0),
    ],
    ids=lambda array: f"{array.dtype}{list(array.shape)}",
)
def test_arrays_come_back_to_the_last_bit(array: np.ndarray) -> None:
    back = unpack(pack(array, steps=4.0))
    assert (back.dtype, back.shape, back.tobytes()) == (array.dtype, array.shape, array.tobytes())


def test_whole_multiples_take_few_bytes() -> None:
    assert len(pack(QUARTERS, steps=4.0).data) == 2 * QUARTERS.size  # up to 9000 quarters
    assert len(pack(np.abs(QUARTERS) * 5, steps=4.0).data) == 2 * QUARTERS.size  # up to 45,000, none negative
    assert len(pack(QUARTERS * 10, steps=4.0).data) == 4 * QUARTERS.size  # up to 90,000


def test_a_byte_that_one_block_alone_needs_is_kept() -> None:
    for place in range(0, 2000, 100):  # blocks are worked on side by side
        array = np.zeros((2000, 1000), np.int32)
        array[place, 500] = 1 << 30
        np.testing.assert_array_equal(unpack(pack(array)), array)


@pytest.mark.parametrize(
    "change",
    [
        {"shape": (50, 61)},
        {"shape": (-50, -60)},
        {"shape": (2**40, 2**40)},
        {"planes": 9},
        {"planes": 1},
        {"whole": "<f2"},
        {"whole": ""},
        {"planes": -1},
        {"dtype": "|O"},
        {"dtype": "<M8[s]"},
        {"dtype": "what"},
        {"dtype": "<f8"},
        {"data": b""},
    ],
)
def test_bytes_that_make_no_array_are_refused_before_memory_is_taken(change: dict[str, Any]) -> None:
    with pytest.raises(UsageError):
        unpack(replace(pack(QUARTERS, steps=4.0), **change))


def test_an_object_cannot_hide_in_an_array() -> None:
    with pytest.raises(UsageError, match="unknown type"):
        unpack(PackedArray("|O", (1,), 0.0, "", 0, b"12345678"))


@pytest.mark.parametrize("told", [story(), bare_story()], ids=["story", "bare"])
def test_every_field_of_every_event_comes_back_to_the_last_bit(told: list[events.Event]) -> None:
    assert {type(event) for event in told} == set(EVENTS.values())
    for event in told:
        kind = type(event)
        apart = {name: getattr(event, name) for name in (PARTS.get(kind), DERIVED.get(kind)) if name}
        assert differences(event, decode(kind, message_of(kind).FromString(encode(event)), **apart)) == []


def test_the_parts_of_events_come_back_to_the_last_bit() -> None:
    parts = [part for event in story() if type(event) in PARTS for part in getattr(event, PARTS[type(event)])]
    assert len(parts) == 8  # four photographs, four walls
    for part in parts:
        assert differences(part, decode(type(part), message_of(type(part)).FromString(encode(part)))) == []


@dataclass(frozen=True)
class Coin:
    """Something to record."""

    side: Literal["heads", "tails"]
    owner: str | None
    numbers: tuple[int, ...] | None
    pair: tuple[str, float]
    named: dict[str, float]


@pytest.mark.parametrize(
    "coin",
    [
        Coin("heads", None, None, ("a", 1.0), {}),
        Coin("tails", "", (), ("", np.inf), {"x": -0.0, "": 2.0}),
        Coin("heads", "me", (1, -2), ("b", 0.5), {"x": 1.0}),
    ],
)
def test_nothing_and_an_empty_thing_are_not_the_same(coin: Coin) -> None:
    assert decode(Coin, message_of(Coin).FromString(encode(coin))) == coin


def test_what_a_field_cannot_be_is_refused() -> None:
    message = message_of(Coin).FromString(encode(Coin("heads", None, None, ("a", 1.0), {})))
    message.side = "edge"
    with pytest.raises(UsageError, match="side is 'edge'"):
        decode(Coin, message)


def test_a_message_of_another_version_says_what_it_lacks() -> None:
    message = message_of(events.Remarked)()
    with pytest.raises(UsageError, match="MissionFinished has no outcome"):
        decode(events.MissionFinished, message)


def test_a_schema_holds_all_that_its_messages_are_made_of() -> None:
    for kind in EVENTS.values():
        assert message_of(kind).DESCRIPTOR.full_name == TOPICS[topic_of(kind)].schema
        assert schema_of(kind) == schema_of(kind)


def test_the_table_of_topics_has_a_row_each_with_units() -> None:
    rows = table().splitlines()[2:]
    assert len(rows) == len(TOPICS)
    assert all("[m" in row or "[rad" in row for row in rows if "/tf" in row or "/laser" in row or "Drove" in row)


def test_the_table_in_the_readme_is_that_of_the_code() -> None:
    assert table() in (Path(__file__).parents[2] / "README.md").read_text()
