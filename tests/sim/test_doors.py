"""Doors by geometry alone: what is one, where it is closed, how far it stands open."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

from sim.doors import DoorTruth, find_doors, measure_opening, put_doors, true_doors
from sim.errors import SimError


def world(
    leaf: str, *, gap: tuple[float, float] = (-0.453, 0.453), wall: str = "", place: str = ""
) -> tuple[mujoco.MjModel, mujoco.MjData]:
    """A wall along x, 12 cm thick (y 0..0.12) and 2.7 m high, with a gap 2.1 m high; `place` moves all of it."""
    left, right = gap
    model = mujoco.MjModel.from_xml_string(f"""
    <mujoco>
      <worldbody>
        <body name="house" {place}>
          <geom type="box" pos="0 0 -0.05" size="4 4 0.05"/>
          <geom type="box" pos="{(left - 3) / 2} 0.06 1.35" size="{(left + 3) / 2} 0.06 1.35"/>
          <geom type="box" pos="{(right + 3) / 2} 0.06 1.35" size="{(3 - right) / 2} 0.06 1.35"/>
          <geom type="box" pos="0 0.06 2.405" size="{(right - left) / 2} 0.06 0.295"/>
          {wall}
          {leaf}
        </body>
      </worldbody>
    </mujoco>""")
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return model, data


LEAF = """
<body name="leaf" pos="0.45 0 0" {body}>
  <joint name="hinge" axis="0 0 1" {joint}/>
  <geom type="box" pos="-0.45 0.03 1.05" size="0.45 0.02 1.045"/>
  <geom type="capsule" fromto="-0.84 -0.05 1.05 -0.72 -0.05 1.05" size="0.01"/>
</body>"""
"""0.90 x 2.09 m, hinged at its right edge (seen from -y), flush with the wall's near face, with a handle."""
ZERO_CLOSED = LEAF.format(body="", joint='range="0 110"')


def only(doors: tuple[DoorTruth, ...]) -> DoorTruth:
    assert len(doors) == 1
    return doors[0]


def test_a_leaf_in_its_frame_is_one_door_with_the_rectangle_of_the_leaf_without_its_handle() -> None:
    door = only(true_doors(*world(ZERO_CLOSED)))

    assert (door.name, door.kind, door.leaf_names) == ("leaf", "hinged", ("leaf",))
    # It opens anticlockwise from direction -x, so towards -y. Seen from there +x is on the right.
    np.testing.assert_allclose(door.normal, [0, -1, 0], atol=1e-9)
    expected = [[-0.45, 0.03, 0.005], [0.45, 0.03, 0.005], [0.45, 0.03, 2.095], [-0.45, 0.03, 2.095]]
    np.testing.assert_allclose(door.corners_in_world, expected, atol=1e-5)


@pytest.mark.parametrize("degrees", [0, 20, 40, 60, 80, 100])
def test_the_opening_angle_is_the_joint_s_and_the_closed_rectangle_does_not_move(degrees: float) -> None:
    model, data = world(ZERO_CLOSED)
    closed = only(true_doors(model, data)).corners_in_world
    data.qpos[0] = np.radians(degrees)
    mujoco.mj_forward(model, data)

    door = only(true_doors(model, data))

    assert np.degrees(door.leaves[0].opening_angle) == pytest.approx(degrees, abs=1e-3)
    np.testing.assert_allclose(door.corners_in_world, closed, atol=1e-4)
    # The free edge swings about the hinge at (0.45, 0); its mid-plane is 3 cm behind the axis.
    angle = np.radians(degrees)
    free = [0.45 - 0.9 * np.cos(angle) - 0.03 * np.sin(angle), -0.9 * np.sin(angle) + 0.03 * np.cos(angle), 0.005]
    np.testing.assert_allclose(door.leaves[0].corners_in_world[1], free, atol=1e-5)


@pytest.mark.parametrize("drawn", [-50.0, 35.0, 90.0])
def test_joint_zero_need_not_be_closed(drawn: float) -> None:
    leaf = LEAF.format(body=f'euler="0 0 {drawn}"', joint="")
    door = only(true_doors(*world(leaf)))
    assert np.degrees(door.leaves[0].opening_angle) == pytest.approx(abs(drawn), abs=0.05)
    np.testing.assert_allclose(door.leaves[0].swing_normal, [0, -np.sign(drawn), 0], atol=1e-3)


def test_a_joint_s_ref_shifts_nothing_but_its_numbers() -> None:
    model, data = world(LEAF.format(body="", joint='ref="30" range="30 130"'))
    assert data.qpos[0] == pytest.approx(np.radians(30))  # drawn closed, called 30 deg

    put_doors(model, data, find_doors(model, data), {"hinge": np.radians(45)})

    assert data.qpos[0] == pytest.approx(np.radians(75))
    assert np.degrees(only(true_doors(model, data)).leaves[0].opening_angle) == pytest.approx(45, abs=1e-3)


def test_a_turned_and_shifted_house_has_the_same_door() -> None:
    turn = np.radians(30)
    rotation = np.array([[np.cos(turn), -np.sin(turn), 0], [np.sin(turn), np.cos(turn), 0], [0, 0, 1]])
    model, data = world(ZERO_CLOSED, place='pos="10 -7 0.4" euler="0 0 30"')
    data.qpos[0] = np.radians(35)
    mujoco.mj_forward(model, data)

    door = only(true_doors(model, data))

    straight = only(true_doors(*world(ZERO_CLOSED)))
    moved = straight.corners_in_world @ rotation.T + [10, -7, 0.4]
    np.testing.assert_allclose(door.corners_in_world, moved, atol=1e-5)
    assert np.degrees(door.leaves[0].opening_angle) == pytest.approx(35, abs=1e-3)


def test_a_door_that_opens_the_negative_way_still_opens_by_positive_angles() -> None:
    model, data = world(LEAF.format(body="", joint='range="-100 0"'))
    doors = find_doors(model, data)
    put_doors(model, data, doors, {"leaf": np.radians(70)})

    assert data.qpos[0] == pytest.approx(np.radians(-70))
    leaf = only(true_doors(model, data)).leaves[0]
    np.testing.assert_allclose(np.degrees(doors[0].leaves[0].reach), [0, 100], atol=1e-6)
    np.testing.assert_allclose(leaf.swing_normal, [0, 1, 0], atol=1e-9)


def test_an_angle_beyond_the_range_names_door_angle_and_range() -> None:
    model, data = world(ZERO_CLOSED)
    with pytest.raises(SimError, match=r"'leaf': 120 deg is outside its range of 0 to 110 deg"):
        put_doors(model, data, find_doors(model, data), {"leaf": np.radians(120)})


def test_an_unknown_door_lists_those_there_are() -> None:
    model, data = world(ZERO_CLOSED)
    with pytest.raises(SimError, match="no door 'gate' in the scene; it has: leaf"):
        put_doors(model, data, find_doors(model, data), {"gate": 0.1})


PAIR = """
    <body name="west" pos="-0.75 0 0"><joint name="w" axis="0 0 1" range="-100 0"/>
      <geom type="box" pos="0.374 0.03 1.05" size="0.374 0.02 1.045"/></body>
    <body name="east" pos="0.75 0 0"><joint name="e" axis="0 0 1" range="0 100"/>
      <geom type="box" pos="-0.374 0.03 1.05" size="0.374 0.02 1.045"/></body>"""


def test_two_leaves_that_fill_one_opening_are_one_double_door() -> None:
    model, data = world(PAIR, gap=(-0.753, 0.753))
    put_doors(model, data, find_doors(model, data), {"east": np.radians(80), "w": np.radians(10)})

    door = only(true_doors(model, data))

    assert door.name == "west+east"
    np.testing.assert_allclose([np.degrees(leaf.opening_angle) for leaf in door.leaves], [10, 80], atol=1e-3)
    np.testing.assert_allclose(np.ptp(door.corners_in_world[:, 0]), 1.5, atol=1e-4)
    np.testing.assert_allclose([leaf.swing_normal[1] for leaf in door.leaves], [-1, -1], atol=1e-6)


def test_a_door_stands_as_far_open_as_its_wider_leaf_whichever_way_the_joint_turns() -> None:
    model, data = world(PAIR, gap=(-0.753, 0.753))
    doors = find_doors(model, data)
    put_doors(model, data, doors, {"east": np.radians(20), "w": np.radians(70)})  # the west leaf's joint goes to -70
    assert np.degrees(measure_opening(model, data, only(doors))) == pytest.approx(70, abs=1e-3)


UNEQUAL = """
    <body name="wide" pos="-0.65 0 0"><joint axis="0 0 1" range="-100 0"/>
      <geom type="box" pos="0.45 0.03 1.05" size="0.447 0.02 1.045"/></body>
    <body name="narrow" pos="0.65 0 0"><joint axis="0 0 1" range="0 100"/>
      <geom type="box" pos="-0.2 0.03 1.05" size="0.197 0.02 1.045"/></body>"""


def test_the_second_leaf_of_a_double_door_may_be_narrower_than_a_door() -> None:
    door = only(true_doors(*world(UNEQUAL, gap=(-0.653, 0.653))))
    assert door.name == "wide+narrow"
    np.testing.assert_allclose(np.ptp(door.corners_in_world[:, 0]), 1.3, atol=0.01)


def test_a_narrow_leaf_alone_is_a_flap_and_no_door() -> None:
    narrow = UNEQUAL[UNEQUAL.index('<body name="narrow"') :]
    assert true_doors(*world(narrow, gap=(0.247, 0.653))) == ()


def test_a_sliding_leaf_on_the_wall_s_face_covers_its_opening_when_closed() -> None:
    leaf = """
    <body name="slider" pos="0 -0.04 0"><joint name="rail" type="slide" axis="1 0 0" range="0 1"/>
      <geom type="box" pos="0 0 1.06" size="0.5 0.02 1.05"/></body>"""
    model, data = world(leaf)
    data.qpos[0] = 0.4
    mujoco.mj_forward(model, data)

    door = only(true_doors(model, data))

    assert door.kind == "sliding"
    assert np.isnan(door.leaves[0].opening_angle)
    assert measure_opening(model, data, only(find_doors(model, data))) == door.leaves[0].opening
    assert door.leaves[0].opening == pytest.approx(0.4, abs=1e-9)
    np.testing.assert_allclose(sorted(door.corners_in_world[:2, 0]), [-0.5, 0.5], atol=1e-6)
    with pytest.raises(SimError, match="slides"):
        put_doors(model, data, find_doors(model, data), {"rail": 0.3})


def test_of_a_leaf_that_overlaps_its_opening_the_side_with_the_wall_before_it_shows_the_opening() -> None:
    leaf = """
    <body name="slider" pos="0 0.15 0"><joint name="rail" type="slide" axis="1 0 0" range="0 1"/>
      <geom type="box" pos="0 0 1.06" size="0.47 0.02 1.055"/></body>"""
    door = only(true_doors(*world(leaf)))

    behind, before = door.outlines_in_world if door.normal[1] > 0 else door.outlines_in_world[::-1]
    # 0.94 m of leaf, up to 2.115 m, stand behind (y > 0.12) an opening 0.906 m wide and 2.11 m high
    np.testing.assert_allclose(np.abs(behind[:, 0]), 0.47, atol=1e-6)
    np.testing.assert_allclose(np.abs(before[:, 0]), 0.453, atol=0.001)
    np.testing.assert_allclose(before[2:, 2], 2.11, atol=0.001)
    np.testing.assert_allclose(before[:2, 2], 0.005, atol=1e-6)  # the floor covers nothing


FRIDGE = """
<geom type="box" pos="2 -0.65 0.95" size="0.3 0.02 0.95"/>
<geom type="box" pos="1.7 -0.35 0.95" size="0.02 0.3 0.95"/>
<geom type="box" pos="2.3 -0.35 0.95" size="0.02 0.3 0.95"/>
<geom type="box" pos="2 -0.05 0.95" size="0.3 0.04 0.95"/>
<body name="wardrobe" pos="1.7 -0.67 0.05"><joint axis="0 0 -1" range="0 120"/>
  <geom type="box" pos="0.3 -0.02 0.92" size="0.3 0.01 0.92"/></body>"""


def test_a_wardrobe_s_door_of_a_door_s_size_is_none_because_nothing_lies_behind_it() -> None:
    assert [door.name for door in true_doors(*world(ZERO_CLOSED, wall=FRIDGE))] == ["leaf"]


def test_a_tall_window_s_casement_is_no_door_because_its_sill_is_high() -> None:
    casement = """
    <geom type="box" pos="0 0.06 0.25" size="0.453 0.06 0.25"/>
    <body name="casement" pos="0.45 0 0.5"><joint axis="0 0 1"/>
      <geom type="box" pos="-0.45 0.03 0.8" size="0.45 0.02 0.8"/></body>"""
    assert true_doors(*world(casement)) == ()


def test_too_small_too_flat_lying_or_turning_bodies_are_no_doors() -> None:
    others = """
    <body pos="-2 -2 0"><joint axis="0 0 1"/><geom type="box" pos="0.3 0 0.6" size="0.3 0.02 0.6"/></body>
    <body pos="-2 -3 0.1"><joint axis="0 0 1"/><geom type="box" pos="1 0 0" size="1 0.45 0.02"/></body>
    <body pos="2 -3 0"><joint type="ball"/><geom type="box" pos="0 0 1" size="0.45 0.02 1"/></body>
    <body pos="0 -3 0"><joint axis="1 0 0"/><geom type="box" pos="0 0 1" size="0.45 0.02 1"/></body>"""
    assert true_doors(*world(others)) == ()


def test_a_leaf_of_several_geoms_and_a_nested_handle_body_is_measured_as_one_slab() -> None:
    leaf = """
    <body name="panelled" pos="0.45 0 0"><joint axis="0 0 1" range="0 100"/>
      <geom type="box" pos="-0.06 0.03 1.05" size="0.06 0.02 1.045"/>
      <geom type="box" pos="-0.84 0.03 1.05" size="0.06 0.02 1.045"/>
      <geom type="box" pos="-0.45 0.03 0.155" size="0.33 0.02 0.15"/>
      <geom type="box" pos="-0.45 0.03 1.2" size="0.33 0.006 0.895" rgba="0.8 0.9 0.9 0.2"/>
      <body pos="-0.84 0 1.05"><joint axis="0 1 0" range="-40 40"/>
        <geom type="box" pos="0.1 -0.07 0" size="0.3 0.01 0.01"/></body>
    </body>"""
    door = only(true_doors(*world(leaf)))
    size = np.ptp(door.corners_in_world, axis=0)
    np.testing.assert_allclose(size, [0.9, 0, 2.09], atol=1e-5)


def test_a_wedged_door_stays_in_spite_of_a_closer_and_a_leaning_hinge() -> None:
    leaf = LEAF.format(body='euler="-2 0 0"', joint='range="0 110" stiffness="5" damping="1"')
    model, data = world(leaf)
    put_doors(model, data, find_doors(model, data), {"leaf": np.radians(50)})
    mujoco.mj_step(model, data, 1000)
    assert np.degrees(data.qpos[0]) == pytest.approx(50, abs=0.01)


@pytest.mark.parametrize("degrees", [0, 35])
def test_a_mesh_leaf_in_a_thin_wall_of_radians_is_found(degrees: float) -> None:
    model = mujoco.MjModel.from_xml_string("""
    <mujoco><compiler angle="radian"/>
      <asset><mesh name="slab" vertex="0 -.02 0  .8 -.02 0  0 .02 0  .8 .02 0
        0 -.02 2  .8 -.02 2  0 .02 2  .8 .02 2"/></asset>
      <worldbody>
        <geom type="plane" size="0 0 1"/>
        <geom type="box" pos="-1.5 0 1.2" size="1.495 0.02 1.2"/>
        <geom type="box" pos="2.305 0 1.2" size="1.5 0.02 1.2"/>
        <body name="m" pos="0 0 0.01"><joint axis="0 0 -1" range="-1.6 0"/><geom type="mesh" mesh="slab"/></body>
      </worldbody></mujoco>""")
    data = mujoco.MjData(model)
    data.qpos[0] = -np.radians(degrees)
    mujoco.mj_forward(model, data)
    door = only(true_doors(model, data))
    assert np.degrees(door.leaves[0].opening_angle) == pytest.approx(degrees, abs=1e-3)
    np.testing.assert_allclose(np.ptp(door.corners_in_world, axis=0), [0.8, 0, 2.0], atol=1e-4)


def test_a_pyramid_on_a_hinge_is_no_door() -> None:
    corners = "-.5 -.5 0  .5 -.5 0  .5 .5 0  -.5 .5 0  0 0 2"
    model = mujoco.MjModel.from_xml_string(f"""
    <mujoco>
      <asset><mesh name="shade" vertex="{corners}"/></asset>
      <worldbody><body><joint axis="0 0 1"/><geom type="mesh" mesh="shade"/></body></worldbody>
    </mujoco>""")
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    assert find_doors(model, data) == ()
