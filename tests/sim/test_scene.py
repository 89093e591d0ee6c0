"""Any MJCF in: where MoPAD starts, what the state is, and what is said when it cannot be."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest

from sim.errors import SimError
from sim.robot import Robot, RobotParameters
from sim.scene import Scene, load_scene

WALLS = """
<geom name="south" type="box" pos="0 -2.05 1.25" size="3.1 0.05 1.25"/>
<geom name="north" type="box" pos="0 2.05 1.25" size="3.1 0.05 1.25"/>
<geom name="west" type="box" pos="-3.05 0 1.25" size="0.05 2 1.25"/>
<geom name="east" type="box" pos="3.05 0 1.25" size="0.05 2 1.25"/>"""
FLOOR = '<geom name="floor" type="plane" size="0 0 1"/>'
ROOM = WALLS + FLOOR + '<site name="start"/>'
CEILING = '<geom name="ceiling" type="box" pos="0 0 2.55" size="3.1 2.1 0.05"/>'


def load(tmp_path: Path, body: str, *, extra: str = "", text: str | None = None, **how: object) -> Scene:
    path = tmp_path / "scene.xml"
    path.write_text(text if text is not None else f"<mujoco>{extra}<worldbody>{body}</worldbody></mujoco>")
    return load_scene(path, **how)  # type: ignore[arg-type]


def heading(pose: np.ndarray) -> float:
    return float(np.arctan2(pose[1, 0], pose[0, 0]))


def test_mopad_starts_at_the_site_on_the_floor_below_it_and_faces_along_its_x_axis(tmp_path: Path) -> None:
    site = '<site name="start" pos="1 0.5 0.8" euler="0 0 90"/>'
    scene = load(tmp_path, WALLS + FLOOR + site)
    np.testing.assert_allclose(scene.world_from_base[:3, 3], [1, 0.5, 0], atol=1e-9)
    assert heading(scene.world_from_base) == pytest.approx(np.pi / 2)


def test_without_a_site_it_starts_at_the_freest_spot_which_an_empty_room_has_in_its_middle(tmp_path: Path) -> None:
    scene = load(tmp_path, WALLS + FLOOR)
    # 6 x 4 m: every point at least 2 m from all walls has y = 0 and |x| <= 1.
    x, y, z = scene.world_from_base[:3, 3]
    assert abs(y) < 0.1 and abs(x) < 1.1 and abs(z) < 1e-6


@pytest.mark.parametrize("height", [-1.2, 0.0, 3.5])
def test_the_freest_spot_is_on_the_floor_of_the_room_not_outside_not_on_the_table_not_on_the_roof(
    tmp_path: Path, height: float
) -> None:
    table = '<geom type="box" pos="0 0 0.72" size="1.2 1.2 0.02"/><geom type="box" pos="0 0 0.35" size="0.1 0.1 0.35"/>'
    slab = '<geom type="box" pos="0 0 -0.05" size="3.1 2.1 0.05"/>'
    house = f'<body pos="4 -9 {height}" euler="0 0 25">{WALLS}{slab}{CEILING}{table}</body>'
    ground = f'<geom type="plane" size="0 0 1" pos="0 0 {height - 0.3}"/>'

    scene = load(tmp_path, house + ground)

    turn = np.radians(25)
    offset = scene.world_from_base[:3, 3] - [4, -9, height]
    x, y = np.cos(turn) * offset[0] + np.sin(turn) * offset[1], -np.sin(turn) * offset[0] + np.cos(turn) * offset[1]
    assert abs(offset[2]) < 1e-6, "on the room's floor"
    assert 1.2 + 0.5 < abs(x) < 3 - 0.5, "between the table and the short walls, where alone there is room"
    assert abs(y) < 2 - 0.5


def test_a_room_without_ceiling_and_fourth_wall_in_an_open_field_is_still_where_it_starts(tmp_path: Path) -> None:
    three = "".join(line for line in WALLS.splitlines() if "east" not in line)
    x, y, _ = load(tmp_path, three + FLOOR).world_from_base[:3, 3]
    assert -3 < x < 3 and -2 < y < 2


def test_doors_are_opened_as_asked_and_found_by_scene(tmp_path: Path) -> None:
    room = Path(__file__).parents[2] / "assets" / "rooms" / "room.xml"
    scene = load_scene(room, door_angles={"study_door": np.radians(60), "hall_door_hinge": 0.0})
    angles = {door.name: np.degrees(door.leaves[0].opening_angle) for door in scene.true_doors()}
    # the store door stays as the first keyframe has it
    assert angles == pytest.approx({"study_door": 60, "hall_door": 0, "store_door": 70}, abs=0.01)


TWO_KEYS = """<keyframe><key name="shut" qpos="0.1"/><key name="ajar" qpos="0.7"/></keyframe>"""
VANE = '<body name="vane" pos="2 1 1"><joint name="vane" axis="0 0 1"/><geom size="0.1"/></body>'


@pytest.mark.parametrize(("keyframe", "angle"), [(None, 0.1), ("ajar", 0.7)])
def test_the_first_keyframe_sets_the_state_unless_another_is_named(
    tmp_path: Path, keyframe: str | None, angle: float
) -> None:
    scene = load(tmp_path, ROOM + VANE, extra=TWO_KEYS, keyframe=keyframe)
    assert scene.data.joint("vane").qpos[0] == pytest.approx(angle)


def test_without_keyframes_qpos0_is_the_state(tmp_path: Path) -> None:
    scene = load(tmp_path, ROOM + VANE.replace('axis="0 0 1"', 'axis="0 0 1" ref="20"'))
    assert scene.data.joint("vane").qpos[0] == pytest.approx(np.radians(20))


@pytest.mark.parametrize(
    "compiler",
    [
        '<compiler angle="radian"/>',
        '<compiler angle="radian" eulerseq="ZYX" autolimits="false" coordinate="local"/>',
        '<compiler inertiafromgeom="true" boundmass="5" balanceinertia="true"/>',
        '<default><geom rgba="1 0 0 1" contype="4" conaffinity="4" density="10"/><joint damping="99"/></default>',
        '<default><default class="roller"><geom size="9" type="sphere"/></default></default>',
        '<asset><material name="rubber"/></asset><option timestep="0.01" integrator="RK4" cone="elliptic"/>',
        '<option gravity="0 0 0"><flag contact="disable" actuation="disable"/></option>',
        '<option gravity="0 0 -1.6" solver="PGS" iterations="1" tolerance="0.1"/>',
        '<option density="1000" viscosity="0.001" o_margin="0.05"><flag override="enable"/></option>',
        '<compiler settotalmass="20"/><default><geom margin="0.02"/></default>',
    ],
)
def test_mopad_is_the_same_whatever_the_scene_s_own_settings(tmp_path: Path, compiler: str) -> None:
    reference = load(tmp_path, ROOM)
    scene = load(tmp_path, ROOM, extra=compiler)

    for one in (reference, scene):
        base, site = one.model.body("mopad/base"), one.data.site("mopad/beam_origin")
        assert base.subtreemass[0] == pytest.approx(131.34, abs=0.01)
        np.testing.assert_allclose(site.xpos - one.data.body("mopad/base").xpos, [0, 0, 1.15], atol=1e-6)
        assert one.model.joint("mopad/left_front").damping[0] == pytest.approx(0.2)
        mujoco.mj_step(one.model, one.data, 200)
        height = one.data.body("mopad/base").xpos[2]
        assert abs(height - one.world_from_base[2, 3]) < 0.003, "it stands on the floor"


def test_a_scene_of_radians_keeps_its_radians(tmp_path: Path) -> None:
    vane = VANE.replace('axis="0 0 1"', 'axis="0 0 1" range="-0.5 1.5"')
    scene = load(tmp_path, ROOM + vane, extra='<compiler angle="radian"/>')
    np.testing.assert_allclose(scene.model.joint("vane").range, [-0.5, 1.5])


def test_mopad_stands_on_a_floor_that_is_only_a_picture(tmp_path: Path) -> None:
    picture = '<geom name="floor" type="box" pos="0 0 -0.05" size="4 4 0.05" contype="0" conaffinity="0"/>'
    scene = load(tmp_path, WALLS + picture)
    mujoco.mj_step(scene.model, scene.data, 500)
    assert abs(scene.data.body("mopad/base").xpos[2]) < 0.003


SHELL = """
<asset><mesh name="shell" inertia="shell"
  vertex="-3 -2 0  3 -2 0  3 2 0  -3 2 0  -3 -2 2.5  3 -2 2.5  3 2 2.5  -3 2 2.5"
  face="0 1 2  0 2 3  0 4 5  0 5 1  1 5 6  1 6 2  2 6 7  2 7 3  3 7 4  3 4 0"/></asset>"""


def test_mopad_is_not_crushed_by_the_convex_hull_of_a_room_that_is_one_mesh(tmp_path: Path) -> None:
    scene = load(tmp_path, '<geom name="shell" type="mesh" mesh="shell"/><site name="start" pos="1 0 0"/>', extra=SHELL)
    mujoco.mj_step(scene.model, scene.data, 500)
    np.testing.assert_allclose(scene.data.body("mopad/base").xpos, [1, 0, 0], atol=0.003)


def test_mopad_drives_as_commanded_where_the_scene_s_own_solver_would_let_it_slip(tmp_path: Path) -> None:
    scene = load(
        tmp_path, ROOM, extra='<option solver="PGS" iterations="1" timestep="0.01" density="1000" wind="3 3 0"/>'
    )
    robot = Robot(scene, RobotParameters(), np.random.default_rng(0))
    robot.settle()
    start = robot.true_world_from_base
    robot.step(0.3, 0.0, 2.0)
    way = (np.linalg.inv(start) @ robot.true_world_from_base)[:3, 3]
    # 0.3 m/s for 2 s less the time to get there; the odometry's drift is a few percent
    assert 0.45 < way[0] < 0.6 and abs(way[1]) < 0.02 and abs(way[2]) < 0.003


def test_floating_things_of_a_scene_without_gravity_go_on_floating(tmp_path: Path) -> None:
    ball = '<body name="ball" pos="2.5 1.5 2"><freejoint/><geom size="0.1"/></body>'
    scene = load(tmp_path, ROOM + ball, extra='<option gravity="0 0 0"/>')
    mujoco.mj_step(scene.model, scene.data, 250)
    assert scene.data.body("ball").xpos[2] == pytest.approx(2, abs=1e-6)


DOOR_WALL = """
<geom type="box" pos="-1.75 -2.05 1.25" size="1.25 0.05 1.25"/>
<geom type="box" pos="1.75 -2.05 1.25" size="1.25 0.05 1.25"/>
<geom type="box" pos="0 -2.05 2.3" size="0.5 0.05 0.2"/>"""
"""Instead of the south wall: an opening 1.0 m wide and 2.1 m high."""
LEAF = """<body name="leaf" pos="-0.5 -2 0"><joint axis="0 0 1" range="0 175" damping="1"/>
  <geom name="leaf" type="box" pos="0.5 -0.02 1.05" size="0.515 0.02 1.06" density="300"/></body>"""
"""1.5 cm wider than its opening on both sides: into its jambs, its lintel and the floor."""


@pytest.mark.parametrize("degrees", [0, 30, 170])
def test_a_leaf_drawn_into_its_frame_stays_where_it_is_put(tmp_path: Path, degrees: float) -> None:
    house = WALLS.replace('name="south" type="box" pos="0 -2.05 1.25"', 'name="s" type="box" pos="0 -9 1.25"') + FLOOR
    scene = load(tmp_path, house + DOOR_WALL + LEAF, door_angles={"leaf": np.radians(degrees)})
    mujoco.mj_step(scene.model, scene.data, 1000)
    (door,) = scene.true_doors()
    assert np.degrees(door.leaves[0].opening_angle) == pytest.approx(degrees, abs=0.05)


def test_the_robot_still_bumps_into_a_leaf(tmp_path: Path) -> None:
    house = WALLS.replace('name="south" type="box" pos="0 -2.05 1.25"', 'name="s" type="box" pos="0 -9 1.25"') + FLOOR
    site = '<site name="start" pos="0 -1.3 0" euler="0 0 -90"/>'
    robot = Robot(load(tmp_path, house + DOOR_WALL + LEAF + site), RobotParameters(), np.random.default_rng(0))
    robot.step(0.3, 0.0, 2.0)
    assert "leaf" in robot.contacts()


def test_a_scene_that_already_holds_a_mopad_keeps_it_where_it_is(tmp_path: Path) -> None:
    first = load(tmp_path, ROOM)
    spec = mujoco.MjSpec.from_string(first.xml)
    spec.body("mopad/base").pos = [1.5, -0.5, 0]

    scene = load(tmp_path, "", text=spec.to_xml())

    assert scene.model.nbody == first.model.nbody
    np.testing.assert_allclose(scene.world_from_base[:3, 3], [1.5, -0.5, 0], atol=1e-6)


def test_another_robot_is_furniture(tmp_path: Path) -> None:
    arm = """<body name="mopad/stranger" pos="2.5 1.5 0.5"><joint axis="0 0 1"/><geom size="0.1"/></body>"""
    scene = load(tmp_path, ROOM + arm)
    stranger = scene.model.body("mopad/stranger").id
    assert stranger not in scene.robot_bodies
    assert scene.model.body(f"{scene.robot_prefix}base").id in scene.robot_bodies


BOX_AT_START = '<body name="sofa"><geom type="box" pos="{} 0 {}" size="0.5 0.5 {}"/></body><site name="start"/>'


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("not a scene at all", "scene .*scene.xml: is not XML"),
        ("", "is not XML"),
        ("<mujoco><worldbody><geom type='blob'/></worldbody></mujoco>", "does not compile: .*blob.*line 1"),
        ("<mujoco><worldbody><geom size='0 0 0'/></worldbody></mujoco>", "does not compile: .*size 0 must be positive"),
        (
            "<mujoco><asset><mesh name='m' file='gone.obj'/></asset><worldbody/></mujoco>",
            "does not compile: .*gone.obj",
        ),
        (f"<mujoco><worldbody>{WALLS}</worldbody></mujoco>", "no floor under the start"),
        (
            f"<mujoco><worldbody>{WALLS}<site name='start' pos='0 0 .1'/></worldbody></mujoco>",
            r"no floor under the start: nothing within 3 m below \(0.00, 0.00, 0.10\)",
        ),
        (f"<mujoco><worldbody>{FLOOR}</worldbody></mujoco>", "no wall within 15 m"),
        (
            f"<mujoco><worldbody>{FLOOR}{WALLS}<site name='start' pos='30 0 0'/></worldbody></mujoco>",
            r"no wall within 15 m of the start at \(30.00, 0.00, 0.00\)",
        ),
        (
            f"<mujoco><worldbody>{FLOOR}{WALLS}{BOX_AT_START.format(0.7, 0.4, 0.4)}</worldbody></mujoco>",
            r"the start at \(0.00, 0.00, 0.00\) is inside geom 5 of body 'sofa'",
        ),
        (
            f"<mujoco><worldbody>{FLOOR}{WALLS}<site name='start' pos='2.8 0 0'/></worldbody></mujoco>",
            r"is inside east",
        ),
    ],
)
def test_a_bad_scene_is_one_line_that_says_what_and_where(tmp_path: Path, text: str, says: str) -> None:
    with pytest.raises(SimError, match=says) as caught:
        load(tmp_path, "", text=text)
    assert "\n" not in str(caught.value)


def test_a_missing_file_and_a_missing_keyframe_are_said_by_name(tmp_path: Path) -> None:
    with pytest.raises(SimError, match="nowhere.xml: no such file"):
        load_scene(tmp_path / "nowhere.xml")
    with pytest.raises(SimError, match="no keyframe 'noon'; it has 'shut', 'ajar'"):
        load(tmp_path, ROOM + VANE, extra=TWO_KEYS, keyframe="noon")
