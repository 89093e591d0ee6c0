"""Somebody else's house: radians, an include, a ground of heights, meshes, loose things, a robot, a nested door."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest

from sim.scanner import Scanner, ScannerParameters
from sim.scene import Scene, load_scene

WALLS = "".join(
    f'<geom type="box" pos="{pos}" size="{size}"/>'
    for pos, size in (
        ("3 -0.1 1.3", "3.2 0.1 1.3"),
        ("3 4.1 1.3", "3.2 0.1 1.3"),
        ("-0.1 2 1.3", "0.1 2 1.3"),
        ("6.1 0.6 1.3", "0.1 0.6 1.3"),
        ("6.1 3.1 1.3", "0.1 0.9 1.3"),
        ("6.1 1.7 2.35", "0.1 0.5 0.25"),
        ("3 2 2.65", "3.2 2.2 0.05"),
        ("8 2 1.3", "0.1 2 1.3"),
    )
)
DOOR = """
<body pos="6.0 1.2 0"><body pos="0.03 0.005 0.01"><body name="Tuer">
  <joint name="Band" axis="0 0 -1" range="-0.2 2"/>
  <geom type="mesh" mesh="slab" pos="0 0.495 1.03"/>
  <body pos="0 0.9 1.05"><geom type="capsule" size="0.012 0.06" euler="0 1.5708 0"/><site name="knob"/></body>
</body></body></body>"""
WARDROBE = """
<body pos="1 3.7 0"><geom type="box" pos="0 0.3 1" size="0.5 0.02 1"/>
  <geom type="box" pos="-0.5 0 1" size="0.02 0.3 1"/>
  <geom type="box" pos="0.5 0 1" size="0.02 0.3 1"/>
  <body pos="-0.48 -0.3 0"><joint axis="0 0 -1" range="0 2"/>
    <geom type="box" pos="0.48 0 1" size="0.47 0.01 0.97"/></body>
</body>"""
STUFF = """<mujoco><worldbody>
<body pos="1 1 0.5"><freejoint/><geom type="sphere" size="0.15"/></body>
<body pos="4.5 3.2 0"><geom type="ellipsoid" size="0.15 0.2 0.3" pos="0 0 0.3"/></body>
<body pos="4 1 0"><geom type="cylinder" size="0.12 1.3" pos="0 0 1.3"/></body>
<body name="cart" pos="2 3 0.1"><freejoint/><geom type="box" size="0.2 0.1 0.05"/>
  <body pos="0 0.13 -0.03"><joint name="left" axis="0 1 0"/>
    <geom type="cylinder" size="0.05 0.02" euler="1.5708 0 0"/></body>
  <body pos="0 -0.13 -0.03"><joint name="right" axis="0 1 0"/>
    <geom type="cylinder" size="0.05 0.02" euler="1.5708 0 0"/></body>
</body></worldbody>
<actuator><motor joint="left"/><motor joint="right"/><position joint="Band" kp="20"/></actuator>
<sensor><jointpos joint="Band"/><framepos objtype="site" objname="knob"/></sensor></mujoco>"""


@pytest.fixture
def house(tmp_path: Path) -> Scene:
    heights = " ".join(f"{height:.3f}" for height in np.random.default_rng(0).random(900))
    slab = "  ".join(f"{x} {y} {z}" for x in (-0.02, 0.02) for y in (-0.495, 0.495) for z in (-1.02, 1.02))
    (tmp_path / "stuff.xml").write_text(STUFF)
    (tmp_path / "house.xml").write_text(
        f"""<mujoco><compiler angle="radian"/><include file="stuff.xml"/><asset><mesh name="slab" vertex="{slab}"/>
        <hfield name="ground" nrow="30" ncol="30" size="6 4 0.008 0.1" elevation="{heights}"/></asset><worldbody>
        <geom type="hfield" hfield="ground" pos="3 2 0"/>{WALLS}{DOOR}{WARDROBE}
        <site name="start" pos="3 2 0.2" euler="0 0 1.5708"/></worldbody></mujoco>"""
    )
    return load_scene(tmp_path / "house.xml", door_angles={"Tuer": 1.0})


def test_its_one_door_is_found_and_opened_and_neither_wardrobe_nor_wheels_are_doors(house: Scene) -> None:
    (door,) = house.true_doors()
    assert door.name == "Tuer"
    assert [leaf.opening_angle for leaf in door.leaves] == pytest.approx([1.0])


def test_mopad_stands_on_its_ground_where_it_says(house: Scene) -> None:
    # the ground is up to 8 mm high, as far as it is not in a hollow
    x, y, z = house.world_from_base[:3, 3]
    assert (x, y) == pytest.approx((3, 2), abs=1e-6) and -0.001 < z < 0.009


@pytest.mark.slow
def test_its_surfaces_are_measured_where_rays_meet_them(house: Scene) -> None:
    place = np.eye(4)
    place[:3, 3] = 3, 2, 1.2
    parameters = ScannerParameters(pattern="draft", noise=False)
    scanner = Scanner(house.model, parameters, hidden_bodies=house.robot_bodies)
    scan = scanner.scan(house.data, place, np.random.default_rng(0))
    rng = np.random.default_rng(1)
    rows, columns = rng.integers(scan.ranges.shape[0], size=3000), rng.integers(scan.ranges.shape[1], size=3000)
    e, a = scan.elevations[rows], scan.azimuths[columns]
    beams = np.column_stack([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])
    hidden = np.isin(house.model.geom_bodyid, list(house.robot_bodies))
    house.model.geom_group[:] = np.where(hidden, 5, 0)
    groups = np.array([1, 1, 1, 1, 1, 0], np.uint8)
    geom = np.zeros(1, np.int32)
    true = np.array(
        [mujoco.mj_ray(house.model, house.data, place[:3, 3], beam, groups, True, -1, geom) for beam in beams]
    )
    known = true >= 1.5
    off = np.abs(scan.ranges[rows, columns] - true)[known]
    assert known.mean() > 0.7 and (off < 1e-4).mean() > 0.98
