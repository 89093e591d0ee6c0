"""Tests of what is seen along a grid of beams."""

from __future__ import annotations

import numpy as np
import pytest

from sim.facets import panorama, picture
from sim.render import View
from sim.sight import Sight
from sim.surfaces import Surfaces

ROOM = """
<geom type="box" size="4 3 .1" pos="0 0 -1.1"/> <geom type="box" size=".1 3 2" pos="4.1 0 1" euler="0 0 5"/>
<geom type="box" size=".3 .4 .9" pos="2.5 -1 0" euler="10 20 30"/> <geom type="plane" size="0 0 1" pos="0 0 -2"/>
<geom type="mesh" mesh="gem" pos="2 1 .3"/> <geom type="box" size=".1 .2 9" pos="3 2 0"/>
"""
GEM = '<mesh name="gem" vertex="0 0 0  .5 0 0  0 .6 0  0 0 .7"/>'
VIEW_FROM_CAMERA = np.array([[0, 0, 1.0], [0, -1, 0], [1, 0, 0]])  # forward, up, right from right, down, forward


def test_a_picture_has_the_depth_that_mujoco_draws_and_its_geoms(world, renderer_of):
    model, data = world(ROOM, GEM)
    camera = np.eye(4)  # looks along x, tilted
    camera[:3, :3] = np.array([[0, 0, 1.0], [-1, 0, 0], [0, -1, 0]]) @ np.linalg.qr(np.eye(3) + 0.1)[0].round(12)
    camera[:3, :3] *= np.sign(np.linalg.det(camera[:3, :3]))
    width, height, tangent = 120, 90, 0.9
    up = (np.arange(height)[::-1] + 0.5 - height / 2) * 2 * tangent / width
    across = (np.arange(width) + 0.5 - width / 2) * 2 * tangent / width
    pose = camera.copy()
    pose[:3, :3] = camera[:3, :3] @ VIEW_FROM_CAMERA.T
    seen = Sight(Surfaces(model), data, pose, picture(up, across)).seen(slice(0, height))

    renderer = renderer_of(model)
    top = tangent * height / width
    depth = renderer.depth(data, View(camera, -tangent, tangent, -top, top, width, height))
    drawn = (depth.raw * renderer.inverse_depth_scale + renderer.inverse_depth_offset)[::-1]
    geoms = depth.geom_ids[depth.segments][::-1]
    assert len(np.unique(geoms)) >= 5
    assert (seen.geoms == geoms).mean() > 0.999  # an edge may be on a pixel's centre
    same = (seen.geoms == geoms) & (geoms >= 0)
    assert np.quantile(np.abs(seen.inverse_range / drawn - 1)[same], 0.999) < 1e-4


@pytest.mark.parametrize("kind", ["panorama", "picture"])
def test_slopes_are_the_normal_and_lead_to_the_range(world, kind):
    # A wall at x = 2 has the plane x / 2 = 1, a ball of 0.5 m at (1.2, 0.3, 0) normals through its middle.
    model, data = world('<geom type="box" size=".1 9 9" pos="2.1 0 0"/><geom size=".5" pos="1.2 .3 0"/>')
    angles = np.linspace(0.4, -0.4, 41)
    if kind == "panorama":
        grid, columns = panorama(angles, np.arange(180) * np.pi / 90), slice(0, 12)
    else:
        grid, columns = picture(angles[::-1], angles), slice(20, 41)
    seen = Sight(Surfaces(model), data, np.eye(4), grid).seen(columns)
    ahead, aside = grid.ahead[columns, None], grid.aside[columns, None]
    beams = np.stack([ahead * grid.level, aside * grid.level, np.broadcast_to(grid.rise, seen.geoms.shape)])
    assert np.allclose((seen.slopes * beams).sum(axis=0), seen.inverse_range, atol=1e-6)
    assert np.allclose(seen.slopes[:, seen.geoms == 0].T, [0.5, 0, 0], atol=1e-6)
    ball = seen.geoms == 1
    assert ball.sum() > 50
    from_middle = (beams / seen.inverse_range)[:, ball] - np.array([[1.2], [0.3], [0]])
    assert np.allclose(np.linalg.norm(from_middle, axis=0), 0.5, atol=1e-5)
    normals = seen.slopes[:, ball] / np.linalg.norm(seen.slopes[:, ball], axis=0)
    assert np.allclose(normals, -from_middle / 0.5, atol=1e-4)


def test_what_is_far_above_or_below_a_picture_is_not_in_it(world):
    # A plane without end of 20 km behind a picture's upper edge, and one seen edge on by the middle row.
    model, data = world(
        '<geom type="plane" size="0 0 1" pos="0 0 1e-5" euler="180 0 0"/><geom type="plane" size="0 0 1"/>'
    )
    pose = np.eye(4)
    pose[2, 3] = 1e-6
    angles = np.linspace(0.5, -0.5, 21)
    geoms = Sight(Surfaces(model), data, pose, picture(angles, angles)).seen(slice(0, 21)).geoms
    assert (geoms[:, :10] == 0).all() and (geoms[:, 11:] == 1).all()
    tall = picture(angles, angles + 1e9)
    assert (Sight(Surfaces(model), data, pose, tall).seen(slice(0, 21)).geoms == 0).all()
