"""The robot and the room as they ship."""

from __future__ import annotations

from itertools import product
from pathlib import Path

import mujoco
import numpy as np
import pytest

import assets
from sim.doors import true_doors
from sim.robot import Robot, RobotParameters
from sim.scene import load_scene

ROOM = assets.FOLDER / "rooms" / "room.xml"


@pytest.fixture(scope="module")
def mopad() -> mujoco.MjModel:
    return mujoco.MjModel.from_xml_path(str(assets.FOLDER / "mopad" / "mopad.xml"))


@pytest.fixture(scope="module")
def room() -> mujoco.MjModel:
    return mujoco.MjModel.from_xml_path(str(ROOM))


def test_masses_and_inertia_are_the_guardian_s_and_the_sensors(mopad: mujoco.MjModel) -> None:
    assert mopad.body("base").mass[0] == pytest.approx(95)
    for corner in ("left_front", "left_rear", "right_front", "right_rear"):
        assert mopad.body(corner).mass[0] == pytest.approx(4.5)
    assert mopad.body("left_middle").mass[0] == pytest.approx(1.25), "a track's"
    assert mopad.body("vz400").mass[0] == pytest.approx(9.6)
    # principal moments of [[3.737, 0, -0.144], [0, 8.311, 0], [-0.144, 0, 8.893]]: the product of inertia adds 0.004
    np.testing.assert_allclose(sorted(mopad.body("base").inertia), [3.733, 8.311, 8.897], atol=0.001)


def test_axles_wheels_and_chassis_have_the_guardian_s_sizes(mopad: mujoco.MjModel) -> None:
    data = mujoco.MjData(mopad)
    mujoco.mj_forward(mopad, data)
    np.testing.assert_allclose(data.body("left_front").xpos, [0.300, 0.224, 0.18], atol=1e-9)  # tracks: 0.448 wide
    np.testing.assert_allclose(data.body("right_rear").xpos, [-0.300, -0.224, 0.18], atol=1e-9)
    solid = np.flatnonzero(mopad.geom_contype)
    reach = np.abs(data.geom_xpos[solid]) + mopad.geom_aabb[solid, 3:]  # none of the solid geoms is turned
    assert reach[:, 0].max() * 2 == pytest.approx(0.971, abs=0.001)
    assert reach[:, 1].max() * 2 == pytest.approx(0.562, abs=0.001)


def test_the_beam_origin_is_20_cm_above_the_scanner_s_foot_and_the_camera_20_cm_above_it(mopad: mujoco.MjModel) -> None:
    data = mujoco.MjData(mopad)
    mujoco.mj_forward(mopad, data)
    beam = data.site("beam_origin").xpos
    assert beam[2] - data.body("vz400").xpos[2] == pytest.approx(0.2)
    assert 1.05 <= beam[2] <= 1.25
    np.testing.assert_allclose(data.site("camera_centre").xpos - beam, [0, 0, 0.2], atol=1e-9)


def test_the_room_has_three_doors_of_the_stated_sizes_open_as_stated(room: mujoco.MjModel) -> None:
    data = mujoco.MjData(room)
    mujoco.mj_resetDataKeyframe(room, data, 0)
    mujoco.mj_forward(room, data)
    found = {}
    for door in true_doors(room, data):
        bottom_left, bottom_right, top_right, _ = door.corners_in_world
        width, height = np.linalg.norm(bottom_right - bottom_left), np.linalg.norm(top_right - bottom_right)
        found[door.name] = [width, height, np.degrees(door.leaves[0].opening_angle)]
    expected = {"study_door": [0.82, 2.05, 0], "hall_door": [0.92, 2.10, 35], "store_door": [0.72, 2.00, 70]}
    assert found.keys() == expected.keys()
    for name, values in expected.items():
        assert found[name] == pytest.approx(values, abs=1e-3), name


def test_two_of_the_room_s_doors_open_into_it_and_one_outward(room: mujoco.MjModel) -> None:
    data = mujoco.MjData(room)
    mujoco.mj_forward(room, data)
    inward = {
        door.name: bool(door.leaves[0].swing_normal @ (np.array([0, 0, 1]) - door.corners_in_world[0]) > 0)
        for door in true_doors(room, data)
    }
    assert inward == {"study_door": True, "hall_door": True, "store_door": False}


def test_no_door_of_the_room_touches_anything_at_any_opening_of_any_door(room: mujoco.MjModel) -> None:
    data = mujoco.MjData(room)
    for degrees in product(range(0, 101, 20), repeat=3):
        data.qpos[:] = np.radians(degrees)
        mujoco.mj_forward(room, data)
        assert data.ncon == 0, degrees


def test_mopad_stands_free_in_the_room_with_all_doors_wide_open() -> None:
    angles = dict.fromkeys(("study_door", "hall_door", "store_door"), np.radians(100))
    robot = Robot(load_scene(ROOM, door_angles=angles), RobotParameters(), np.random.default_rng(0))
    assert robot.contacts() == ()


def test_the_room_knows_nothing_of_the_robot(room: mujoco.MjModel) -> None:
    assert (room.nsite, room.nu, room.nsensor) == (0, 0, 0)
    assert "mopad" not in ROOM.read_text().lower()


def test_the_room_is_turned_and_moved_by_its_one_body(tmp_path: Path) -> None:
    text = ROOM.read_text().replace(
        'name="building" pos="0 0 0" euler="0 0 0"', 'name="building" pos="10 -7 0" euler="0 0 30"'
    )
    (tmp_path / "turned.xml").write_text(text)
    straight, turned = load_scene(ROOM), load_scene(tmp_path / "turned.xml")

    turn = np.radians(30)
    rotation = np.array([[np.cos(turn), -np.sin(turn), 0], [np.sin(turn), np.cos(turn), 0], [0, 0, 1]])
    for one, other in zip(straight.true_doors(), turned.true_doors(), strict=True):
        assert one.name == other.name
        np.testing.assert_allclose(other.corners_in_world, one.corners_in_world @ rotation.T + [10, -7, 0], atol=1e-4)
        assert other.leaves[0].opening_angle == pytest.approx(one.leaves[0].opening_angle, abs=1e-4)
    offset = (turned.world_from_base[:3, 3] - [10, -7, 0]) @ rotation
    assert np.all(np.abs(offset[:2]) < [2.6, 1.9]), "it starts inside the room"
