"""Tests of the caster: every beam meets what an exact ray meets."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

from sim.beams import BeamCaster, directions

ROWS, COLUMNS = 200, 400
ELEVATIONS = np.linspace(1.5, -1.5, ROWS)  # up to 4 deg from the poles
AZIMUTHS = np.arange(COLUMNS) * 2 * np.pi / COLUMNS
POINTS = np.random.default_rng(0).normal(size=(150, 3))
GEM = f'<mesh name="gem" vertex="{" ".join(f"{x:.4f}" for x in POINTS.ravel())}" scale=".3 .3 .3"/>'
HILLS = '<hfield name="hills" nrow="3" ncol="4" size="1 .7 .8 .1" elevation="0 .2 .5 0  .9 .1 .3 .6  0 1 .2 .4"/>'
GEOMS = {
    "box": '<geom type="box" size=".5 .7 .3" {}/>',
    "sphere": '<geom size=".6" {}/>',
    "ellipsoid": '<geom type="ellipsoid" size=".8 .3 .5" {}/>',
    "capsule": '<geom type="capsule" size=".3 .5" {}/>',
    "cylinder": '<geom type="cylinder" size=".4 .6" {}/>',
    "plane": '<geom type="plane" size=".8 .5 1" {}/>',
    "mesh": '<geom type="mesh" mesh="gem" {}/>',
    "height field": '<geom type="hfield" hfield="hills" {}/>',
}


def cast(scene, world_from_scanner=None, **hidden):
    model, data = scene
    pose = np.eye(4) if world_from_scanner is None else world_from_scanner
    return BeamCaster(model, **hidden).cast(data, pose, ELEVATIONS, AZIMUTHS)


def beams(rotation=None):
    """(ROWS * COLUMNS, 3) of the grid in the world."""
    e, a = (grid.ravel() for grid in np.meshgrid(ELEVATIONS, AZIMUTHS, indexing="ij"))
    return directions(e, a) @ (np.eye(3) if rotation is None else rotation.T)


def rays(scene, pose):
    """Exact inverse ranges [1/m], cosines of incidence and geom ids of the grid, by MuJoCo's own rays."""
    along, count = beams(pose[:3, :3]), ROWS * COLUMNS
    geoms, ranges, normals = np.empty(count, np.int32), np.empty(count), np.empty(3 * count)
    mujoco.mj_multiRay(
        *(*scene, pose[:3, 3].copy(), along.ravel(), None, True, -1, geoms, ranges, normals, count, 1e4),
    )
    cosine = np.abs((normals.reshape(-1, 3) * along).sum(axis=1))
    shape = ROWS, COLUMNS
    return np.where(geoms < 0, 0, 1 / ranges).reshape(shape), cosine.reshape(shape), geoms.reshape(shape)


def somewhere(seed):
    """(4, 4) any pose near the origin."""
    rng = np.random.default_rng(seed)
    pose = np.eye(4)
    pose[:3, :3] = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    pose[:3, 0] *= np.sign(np.linalg.det(pose[:3, :3]))
    pose[:3, 3] = rng.uniform(-0.2, 0.2, 3)
    return pose


@pytest.mark.parametrize("kind", GEOMS)
def test_range_incidence_and_geom_are_those_of_a_ray(world, kind):
    # Round about the scanner, before and behind each other, ahead and at the poles.
    rng = np.random.default_rng(2)
    places = [(1.6, 0, 0), (3.5, 0.8, 0.3), (-1.5, 0.3, 0), (0, 1.7, 0.4), (0.2, 0.1, 1.8), (0, -0.2, -1.7), (0, -2, 1)]
    geoms = [
        GEOMS[kind].format(f'pos="{x} {y} {z}" euler="{" ".join(map(str, rng.uniform(-180, 180, 3)))}"')
        for x, y, z in places
    ]
    scene = world("".join(geoms), GEM + HILLS)
    for seed in range(2):
        pose = somewhere(seed)
        hits = cast(scene, pose)
        inverse_range, cosine, geom = rays(scene, pose)
        same = hits.geoms == geom  # but for a few beams along an edge
        assert (~same).mean() < 1e-4 and (geom >= 0).mean() > 0.04
        assert np.abs(hits.inverse_range - inverse_range)[same].max() < 1e-6
        smooth = same & (geom >= 0)
        assert np.quantile(np.abs(hits.cosine - cosine)[smooth], 0.999) < 1e-5  # on an edge there are two


@pytest.mark.parametrize("kind", ["box", "sphere", "ellipsoid", "capsule", "cylinder", "mesh"])
def test_from_inside_a_thing_its_wall_is_met_all_round(world, kind):
    scene = world(GEOMS[kind].format('euler="20 30 40"'), GEM)
    pose = somewhere(1)
    hits = cast(scene, pose)
    assert (hits.geoms == 0).all()  # nor does any beam slip through between two triangles
    assert np.abs(hits.inverse_range - rays(scene, pose)[0]).max() < 1e-4


def test_no_beam_slips_through_a_mesh_of_many_triangles(world):
    # A ball of 2048 triangles, some of them smaller than the beams' distance, seen from 20 places within.
    fine = np.random.default_rng(5).normal(size=(1026, 3))
    words = " ".join(f"{x:.5f}" for x in (fine / np.linalg.norm(fine, axis=1)[:, None]).ravel())
    scene = world('<geom type="mesh" mesh="ball"/>', f'<mesh name="ball" vertex="{words}"/>')
    for seed in range(20):
        assert (cast(scene, somewhere(seed)).geoms == 0).all()


def test_a_plane_is_seen_from_its_front_only_and_to_its_end(world):
    # 1 m above a plane of 2 x 4 m: it ends 1 m ahead at 45 deg; from below there is nothing.
    scene = world('<geom type="plane" size="1 2 1"/>')
    above, below = np.eye(4), np.eye(4)
    above[2, 3], below[2, 3] = 1, -1
    ahead = cast(scene, above).geoms[:, 0] == 0
    assert np.array_equal(ahead, -np.pi / 4 > ELEVATIONS)
    assert (cast(scene, below).geoms == -1).all()


@pytest.mark.parametrize("far", [30, 3e5])
@pytest.mark.parametrize("size", ["0 0 1", "9e5 0 1"])
def test_an_endless_plane_reaches_the_horizon_from_anywhere(world, far, size):
    pose = np.eye(4)
    pose[:3, 3] = 20, -far, 1.5  # along y it never ends
    hits = cast(world(f'<geom type="plane" size="{size}"/>'), pose)
    assert np.array_equal(hits.geoms == 0, np.repeat(ELEVATIONS[:, None] < 0, COLUMNS, axis=1))
    expected = np.maximum(-np.sin(ELEVATIONS), 0) / 1.5
    assert np.abs(hits.inverse_range - expected[:, None]).max() < 1e-6


def test_what_lies_across_the_first_column_is_seen_on_both_sides_of_it(world):
    hits = cast(world('<geom type="box" size=".1 1 1" pos="2 0 0"/>'))
    level = hits.geoms[ROWS // 2]
    reach = int(np.degrees(np.arctan(1 / 1.9)) / 360 * COLUMNS)  # columns to either side
    assert np.array_equal(np.flatnonzero(level == 0), [*range(reach + 1), *range(COLUMNS - reach, COLUMNS)])


def test_beams_pass_hidden_bodies_glass_and_collision_shapes(world):
    scene = world(
        '<body name="mast"><geom size=".2" pos="1 0 0"/><geom type="box" size=".1 .1 .1" pos="1 0 0"/></body>'
        '<geom size=".2" pos="1.5 0 0" rgba="1 1 1 .2"/><geom size=".2" pos="2 0 0" group="3"/>'
        '<geom name="wall" type="box" size=".1 5 5" pos="4 0 0"/>'
    )
    hits = cast(scene, hidden_bodies={scene[0].body("mast").id})
    assert hits.geoms[ROWS // 2, 0] == scene[0].geom("wall").id
    assert set(np.unique(hits.geoms)) == {-1, scene[0].geom("wall").id}


def test_soft_things_are_met_as_they_are_drawn(capfd, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)  # where MuJoCo writes what it warns of
    # A cloth of 1.5 m and 2 cm thick across the beam at 3 m, and a skin of 2 m at 4 m on the other side.
    cloth = '<flexcomp name="f" type="grid" count="4 4 1" spacing=".5 .5 .5" radius=".01" mass="1" euler="0 90 0"/>'
    model = mujoco.MjModel.from_xml_string(f"""<mujoco><worldbody><body name="b" pos="3 0 0">{cloth}</body>
        <body name="bone"><geom size=".01" group="3"/></body></worldbody><deformable>
        <skin vertex="-4 -1 -1  -4 1 -1  -4 1 1  -4 -1 1" face="0 1 2  0 2 3">
        <bone body="bone" bindpos="0 0 0" bindquat="1 0 0 0" vertid="0 1 2 3" vertweight="1 1 1 1"/></skin>
        </deformable></mujoco>""")
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    capfd.readouterr()
    hits = cast((model, data))
    assert not capfd.readouterr().err
    assert (hits.geoms == -1).all()
    assert 1 / hits.inverse_range[ROWS // 2, 0] == pytest.approx(2.99, abs=0.001)
    assert 1 / hits.inverse_range[ROWS // 2, COLUMNS // 2] == pytest.approx(4, abs=0.001)
    assert (hits.inverse_range > 0).sum() > 1000
    model.flex_group[:] = 3  # a collision shape
    model.skin_rgba[:, 3] = 0.1  # glass
    assert not cast((model, data)).inverse_range.any()


def test_more_cores_do_not_change_what_is_met(world, monkeypatch):
    scene = world(
        "".join(GEOMS[kind].format(f'pos="{1.5 + k} 0 {k / 5}"') for k, kind in enumerate(GEOMS)), GEM + HILLS
    )
    found = []
    for cores in (1, 3):
        monkeypatch.setattr("os.cpu_count", lambda cores=cores: cores)
        found.append(cast(scene))
    assert np.array_equal(found[0].inverse_range, found[1].inverse_range)
    assert np.array_equal(found[0].geoms, found[1].geoms)
