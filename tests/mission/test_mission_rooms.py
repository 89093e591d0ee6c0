"""A mission through three rooms: one door to drive through, one that is shut, and an operator for what lies behind."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from mission.__main__ import main
from mission.explored_room import ExploredRoom
from mission.surveyor import Surveyor

pytestmark = pytest.mark.slow

DRAFT = ("--set", "scanner.pattern=draft", "--max-scans", "2")


def box(x: tuple[float, float], y: tuple[float, float], z: tuple[float, float] = (0, 2.6), rgba: str = "") -> str:
    spans = (x, y, z)
    middle = " ".join(f"{sum(span) / 2:.4f}" for span in spans)
    half = " ".join(f"{(span[1] - span[0]) / 2:.4f}" for span in spans)
    return f'<geom type="box" pos="{middle}" size="{half}" rgba="{rgba or "0.8 0.78 0.72 1"}"/>'


def cross_wall(x: float, door: float, width: float, name: str) -> str:
    """A wall of 0.2 m across the house; its door is hinged at the far side, the leaf 5 cm behind the east face."""
    leaf = (
        f'<body name="{name}" pos="{x + 0.15} {door + width} 0"><joint axis="0 0 1" range="-10 120"/>'
        f'<geom type="box" pos="-0.02 {-width / 2} 1.025" size="0.02 {width / 2 - 0.004} 1.02" rgba="0.5 0.35 0.2 1"/>'
        "</body>"
    )
    wall = box((x, x + 0.2), (0, door)) + box((x, x + 0.2), (door + width, 4.4))
    return wall + box((x, x + 0.2), (door, door + width), (2.05, 2.6)) + leaf


HOUSE = f"""
<mujoco>
  <worldbody>
    {box((-0.2, 15.6), (-0.2, 4.6), (-0.1, 0), "0.5 0.45 0.4 1")} {box((-0.2, 15.6), (-0.2, 4.6), (2.6, 2.7))}
    {box((-0.2, 15.6), (-0.2, 0))} {box((-0.2, 15.6), (4.4, 4.6))}
    {box((-0.2, 0), (0, 4.4))} {box((15.4, 15.6), (0, 4.4))}
    {cross_wall(5.0, 1.6, 0.95, "open_door")} {cross_wall(10.2, 2.2, 0.9, "shut_door")}
    {box((0.3, 1.2), (3.6, 4.35), (0, 0.75), "0.4 0.3 0.2 1")}
    {box((13, 14.5), (3.3, 4.35), (0, 0.5), "0.3 0.5 0.3 1")}
    <site name="start" pos="2 2 0"/> <site name="start_2" pos="7 2 0"/> <site name="start_3" pos="13 2 0"/>
  </worldbody>
</mujoco>
"""


@pytest.fixture(scope="module")
def house(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The output folder of a draft mission."""
    folder = tmp_path_factory.mktemp("house")
    (folder / "house.xml").write_text(HOUSE)
    options = ["--door", "open_door=95", "--quiet", "--out", str(folder)]
    assert main(["run", str(folder / "house.xml"), *DRAFT, *options]) == 0
    return folder


def read(folder: Path, name: str) -> Any:
    return json.loads((folder / name).read_text())


def test_the_robot_drives_through_the_open_door_and_is_carried_past_the_shut_one(house: Path) -> None:
    rooms = read(house, "summary.json")["rooms"]
    assert [room["entered"] for room in rooms] == ["start", "door", "set down"]  # start_2 lies in a room that is done
    assert rooms[1]["through"] in rooms[0]["exits"]


def test_it_touches_nothing_on_its_way(house: Path) -> None:
    assert read(house, "summary.json")["contacts"] == 0


def test_a_door_is_the_same_from_both_sides(house: Path) -> None:
    links = read(house, "doors.json")["links"]
    doors = {door["id"]: door for room in read(house, "doors.json")["rooms"] for door in room["doors"]}
    assert [link["rooms"] for link in links] == [[1, 2], [2, 3]]
    for link in links:
        one, other = (doors[name] for name in link["doors"])
        assert one["truth"]["door"] == other["truth"]["door"]
        assert abs(one["width"] - other["width"]) < 0.04  # two coarse scans a room
        assert abs(one["opening_angle_deg"] - other["opening_angle_deg"]) < 1.0


def test_rooms_lie_where_they_are(house: Path) -> None:
    # The wall with the shut door is as thick as its leaf is taken to be, to 5 mm; the operator was 5 cm and 2 deg off.
    for scan in read(house, "summary.json")["registration"]:
        assert scan["translation_error_m"] < (0.012 if scan["room"] == 3 else 0.005)
        assert scan["rotation_error_deg"] < 0.03


def test_no_door_is_missed_and_none_is_invented(house: Path) -> None:
    metrics = read(house, "summary.json")["metrics"]
    assert (metrics["doors"], metrics["found"], metrics["false_positives"]) == (4, 4, 0)


def test_judged_again_from_its_recording_the_house_is_the_same_to_the_last_byte(house: Path, tmp_path: Path) -> None:
    assert main(["replay", str(house / "mission.mcap"), "--redetect", "--quiet", "--out", str(tmp_path)]) == 0
    assert (tmp_path / "doors.json").read_bytes() == (house / "doors.json").read_bytes()


def test_judged_by_parameters_that_leave_no_room_there_are_no_doors_and_nothing_breaks(
    house: Path, tmp_path: Path
) -> None:
    options = ["--redetect", "--set", "structure.min_level_area=99", "--quiet", "--out", str(tmp_path)]
    assert main(["replay", str(house / "mission.mcap"), *options]) == 0
    assert [room["doors"] for room in read(tmp_path, "doors.json")["rooms"]] == [[], [], []]


def test_a_mission_ends_after_as_many_rooms_as_are_asked_for_and_keeps_none_of_their_scans(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    rooms: list[ExploredRoom] = []
    survey = Surveyor.survey
    monkeypatch.setattr(Surveyor, "survey", lambda self, room: rooms.append(room) or survey(self, room))
    (tmp_path / "house.xml").write_text(HOUSE)
    options = ["--door", "open_door=95", "--max-rooms", "1", "--quiet", "--out", str(tmp_path)]
    assert main(["run", str(tmp_path / "house.xml"), *DRAFT, *options]) == 0
    assert len(read(tmp_path, "summary.json")["rooms"]) == 1
    assert [(room.samples, room.coloured) for room in rooms] == [([], [])]
