"""Tests of depth, segments and albedo."""

from __future__ import annotations

import os
import subprocess
import sys
from types import SimpleNamespace

import mujoco
import numpy as np
import pytest

from sim.errors import SimError
from sim.render import Renderer, View, looking_along
from sim.render import context as gl


def view_from(position, azimuth=0.0, *, tangent=1.0, size=200):
    """A square picture, level, with the same tangent on all four sides."""
    pose = looking_along(azimuth)
    pose[:3, 3] = position
    return View(pose, -tangent, tangent, -tangent, tangent, size, size)


def metres(renderer: Renderer, raw):
    return 1 / (raw.astype(float) * renderer.inverse_depth_scale + renderer.inverse_depth_offset)


def test_depth_is_the_distance_along_the_optical_axis(world, renderer_of):
    model, data = world('<geom type="box" size=".1 5 5" pos="3.1 0 0"/>')  # front face at x = 3
    renderer = renderer_of(model)
    picture = renderer.depth(data, view_from([0, 0, 0]))
    assert np.allclose(metres(renderer, picture.raw), 3, atol=1e-5)  # everywhere, corners too


def test_an_infinite_plane_is_right_out_to_the_scanner_s_reach(world, renderer_of):
    model, data = world('<geom type="plane" size="0 0 1"/>')
    renderer = renderer_of(model)
    view = view_from([1234.5, -77, 1.5], azimuth=0.4)
    depth = metres(renderer, renderer.depth(data, view).raw[:, 0])
    down = 1 - (np.arange(200) + 0.5) / 100  # tangent below the horizon, bottom row first
    near = down > 1.5 / 600
    assert near.sum() == 100  # the lower half of the picture
    assert np.allclose(depth[near] * down[near], 1.5, rtol=2e-4)


def test_the_clip_planes_do_not_depend_on_the_scene(world, renderer_of):
    # A speck 5 km away makes MuJoCo's own near plane 50 m, for it scales with the extent of the scene.
    model, data = world('<geom size=".1" pos="0 0 5000"/><geom type="box" size=".1 1 1" pos=".2 0 0"/>')
    renderer = renderer_of(model)
    assert metres(renderer, renderer.depth(data, view_from([0, 0, 0])).raw[100, 100]) == pytest.approx(0.1, abs=1e-6)


def test_a_renderer_that_fails_to_start_frees_its_context(world, monkeypatch):
    freed = []
    context = SimpleNamespace(make_current=lambda: None, free=lambda: freed.append("context"))

    def refuse(*_):
        raise mujoco.FatalError("no framebuffer")

    monkeypatch.setattr("sim.render.renderer.make_context", lambda: context)
    monkeypatch.setattr(mujoco, "MjrContext", refuse)
    with pytest.raises(mujoco.FatalError):
        Renderer(world('<geom size=".1"/>')[0])
    assert freed == ["context"]


def test_a_renderer_may_be_closed_twice(world):
    renderer = Renderer(world('<geom size=".1"/>')[0])
    renderer.close()
    renderer.close()


def test_segments_name_the_geom(world, renderer_of):
    model, data = world(
        '<geom size=".1" group="3"/>'  # a collision shape comes first, so that segment and geom id differ
        '<geom type="box" size=".1 1 9" pos="3 1 0"/><geom type="box" size=".1 1 9" pos="3 -1 0"/>'
    )
    picture = renderer_of(model).depth(data, view_from([0, 0, 0], tangent=0.5))
    assert set(picture.geom_ids[picture.segments[:, 20]]) == {1}  # y > 0 is on the left
    assert set(picture.geom_ids[picture.segments[:, 180]]) == {2}


def test_more_than_255_geoms_keep_their_ids(world, renderer_of):
    balls = "".join(f'<geom size=".01" pos="0 0 {k}"/>' for k in range(1, 300))
    model, data = world(balls + '<geom type="box" size=".1 1 1" pos="3 0 0"/>')
    picture = renderer_of(model).depth(data, view_from([0, 0, 0], tangent=0.1))
    assert set(picture.geom_ids[picture.segments].ravel()) == {299}


def test_a_plane_is_seen_from_its_front_only_as_by_rays(world, renderer_of, true_ranges):
    scene = world('<geom type="plane" size="5 5 1"/>')
    renderer = renderer_of(scene[0])
    above, below = (renderer.depth(scene[1], view_from([0, 0, z])).raw for z in (1, -1))
    assert (above[0] > 0).all()  # bottom row: floor from above
    assert (below == 0).all()
    assert true_ranges(scene, np.array([0, 0, -1.0]), np.array([[0, 0, 1.0]]))[0] == np.inf


def test_both_sides_of_a_mesh_are_seen(world, renderer_of):
    mesh = '<mesh name="m" vertex="3 -9 -9  3 9 -9  3 0 9  3.001 0 0"/>'  # a thin wedge of a wall
    model, data = world('<geom type="mesh" mesh="m"/>', mesh)
    renderer = renderer_of(model)
    front = metres(renderer, renderer.depth(data, view_from([0, 0, 0], tangent=0.1)).raw)
    back = metres(renderer, renderer.depth(data, view_from([6, 0, 0], np.pi, tangent=0.1)).raw)
    assert np.allclose(front, 3, atol=0.01)
    assert np.allclose(back, 3, atol=0.01)


@pytest.mark.parametrize(
    ("colour", "seen"), [(".2 .2 .9 .4", 3.0), (".2 .2 .9 .6", 2.0), (".5 .5 .5 .6", 2.0)], ids=str
)
def test_glass_lets_through_and_milk_glass_does_not(world, renderer_of, colour, seen):
    model, data = world(
        f'<geom type="box" size=".1 5 5" pos="3.1 0 0"/><geom type="box" size=".1 5 5" pos="2.1 0 0" rgba="{colour}"/>'
    )
    renderer = renderer_of(model)
    picture = renderer.depth(data, view_from([0, 0, 0]))
    assert np.allclose(metres(renderer, picture.raw), seen, atol=1e-5)


def test_glass_may_be_a_material(world, renderer_of):
    model, data = world(
        '<geom type="box" size=".1 5 5" pos="3.1 0 0" rgba="1 0 0 1"/>'
        '<geom type="box" size=".1 5 5" pos="2.1 0 0" material="glass"/>',
        '<material name="glass" rgba=".7 .8 .9 .2"/>',
    )
    assert (renderer_of(model).albedo(data, view_from([0, 0, 0])) == [255, 0, 0]).all()


def test_hidden_bodies_are_not_seen(world, renderer_of):
    model, data = world(
        '<geom type="box" size=".1 5 5" pos="3.1 0 0"/>'
        '<body name="robot"><geom type="box" size=".1 5 5" pos="1.1 0 0"/>'
        '<body name="arm"><geom type="box" size=".1 5 5" pos="2.1 0 0"/></body></body>'
    )
    robot = {model.body("robot").id, model.body("arm").id}
    renderer = renderer_of(model, hidden_bodies=robot)
    assert np.allclose(metres(renderer, renderer.depth(data, view_from([0, 0, 0])).raw), 3, atol=1e-5)


def test_albedo_is_texture_times_colour_to_the_digit(world, renderer_of):
    # One texel of 200 by a factor of 0.5 is 100, whatever the lights and however the surface glows or mirrors.
    model, data = world(
        '<light pos="1 0 0" diffuse="1 0 0"/><geom type="box" size=".1 5 5" pos="3.1 0 0" material="paint"/>',
        '<texture name="t" type="2d" builtin="flat" rgb1=".7844 .7844 .4001" width="8" height="8"/>'
        '<material name="paint" texture="t" rgba=".5 1 1 1" emission="1" reflectance=".5"/>',
    )
    assert (renderer_of(model).albedo(data, view_from([0, 0, 0])) == [100, 200, 102]).all()


def test_albedo_of_a_half_clear_geom_is_its_own_colour(world, renderer_of):
    model, data = world('<geom type="box" size=".1 5 5" pos="3.1 0 0" rgba=".2 .4 .6 .8"/>')
    assert (renderer_of(model).albedo(data, view_from([0, 0, 0])) == [51, 102, 153]).all()


def test_rendering_leaves_the_model_as_it_was(world, renderer_of):
    model, data = world('<geom type="plane" size="0 0 1" rgba="1 1 1 .3"/><geom size="1" group="2"/>')
    before = bytes(str(model.vis), "utf8"), model.geom_group.copy(), model.geom_rgba.copy()
    view = view_from([0, 0, 3])
    renderer = renderer_of(model)
    renderer.depth(data, view)
    renderer.albedo(data, view)
    after = bytes(str(model.vis), "utf8"), model.geom_group, model.geom_rgba
    assert before[0] == after[0]
    assert all((a == b).all() for a, b in zip(before[1:], after[1:], strict=True))


def test_no_opengl_is_one_line_that_names_the_packages(world, monkeypatch):
    monkeypatch.setattr(gl, "_loads", lambda library: False)
    with pytest.raises(SimError, match=r"apt-get install libegl1 libgl1.*libosmesa6") as caught:
        Renderer(world("")[0])
    assert "\n" not in str(caught.value)


def test_osmesa_is_the_second_choice(monkeypatch):
    monkeypatch.delenv("MUJOCO_GL", raising=False)
    monkeypatch.setattr(gl, "_loads", lambda library: "OSMesa" in library)
    assert gl._backend() == "mujoco.osmesa"


def backend_without_a_driver(*, osmesa: bool) -> str:
    """What a process prints that picks its back end where EGL's library loads, but finds no driver."""
    code = (
        "import sim.render.context as gl; from sim.errors import SimError; loads = gl._loads\n"
        f"gl._loads = lambda library: {osmesa} if 'OSMesa' in library else loads(library)\n"
        "try: print(gl._backend())\n"
        "except SimError as error: print(error)"
    )
    environment = {k: v for k, v in os.environ.items() if k != "MUJOCO_GL"}
    environment["__EGL_VENDOR_LIBRARY_FILENAMES"] = "/nonexistent"  # read by libEGL when it is first called
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, env=environment)
    return done.stdout


def test_osmesa_is_taken_where_egl_has_no_driver():
    assert backend_without_a_driver(osmesa=True) == "mujoco.osmesa\n"


def test_without_driver_and_osmesa_one_line_says_what_is_missing_and_which_packages_bring_it():
    said = backend_without_a_driver(osmesa=False)
    assert "EGL finds no device" in said and "libOSMesa.so.8" in said
    assert "apt-get install libegl1 libgl1" in said and "libosmesa6" in said
    assert said.count("\n") == 1
