"""Tests of the photographs: geometry, flash, sensor."""

from __future__ import annotations

import numpy as np
import pytest

from sim.camera import FLASH, Camera, CameraParameters
from sim.render.materials import linear_from_srgb, materials_of
from sim.shading import Window, seen_from_flash

SMALL = CameraParameters(width=178, height=268, shots=7, noise=False, ambient=0)
MEDIUM = SMALL.model_copy(update={"width": 356, "height": 536})
MATT = '<material name="matt" rgba=".7 .7 .7 1" specular="0"/>'


def photograph(renderer_of, scene, parameters=SMALL, place=None, seed=0, **hidden):
    camera = Camera(renderer_of(scene[0], **hidden), parameters)
    return camera.photograph(scene[1], np.eye(4) if place is None else place, np.random.default_rng(seed))


def wall(x, *, material="matt", size=40):
    """A wall square to x, its face at that x, centred on the camera."""
    return f'<geom type="box" size=".5 {size} {size}" pos="{x + 0.5} 0 0.2" material="{material}"/>'


def light(photo, row, column):
    """Linear brightness of a pixel, red channel, parts of full scale."""
    return linear_from_srgb(photo.image[row, column, 0] / 255)


def project(photo, point_in_scanner):
    """(u, v) [px] of a point."""
    camera_from_scanner = np.linalg.inv(photo.scanner_from_camera)
    x, y, z = camera_from_scanner[:3, :3] @ point_in_scanner + camera_from_scanner[:3, 3]
    u, v, _ = photo.intrinsics @ [x / z, y / z, 1]
    assert z > 0
    return u, v


def test_ten_photographs_go_all_round_with_overlap(world, renderer_of):
    photos = photograph(renderer_of, world(wall(3), MATT), SMALL.model_copy(update={"shots": 10}))
    forward = np.array([photo.scanner_from_camera[:3, 2] for photo in photos])
    angles = np.unwrap(np.arctan2(forward[:, 1], forward[:, 0]))
    assert np.allclose(np.diff(np.degrees(angles)), 36)
    field = 2 * np.degrees(np.arctan(photos[0].intrinsics[0, 2] / photos[0].intrinsics[0, 0]))
    assert field == pytest.approx(58.9, abs=0.1)  # 14 mm, 15.8 mm across: 39 % of a picture is in the next one, too


def test_all_photographs_share_one_centre_on_the_scanner_s_axis(world, renderer_of):
    for photo in photograph(renderer_of, world(wall(3), MATT)):
        assert np.allclose(photo.scanner_from_camera[:3, 3], [0, 0, 0.20])
        assert np.allclose(photo.scanner_from_camera[:3, 1], [0, 0, -1])  # level: y of the picture is straight down


@pytest.mark.parametrize("corner", [(3.0, 0.4, 0.9), (3.0, -0.5, -0.6), (2.5, 1.4, 1.2)], ids=str)
def test_a_point_is_where_the_intrinsics_say(world, renderer_of, corner):
    # The lower right quarter of the wall beyond the corner is red: its corner must be found where it projects to.
    x, y, z = corner
    red = f'<geom type="box" size=".0005 5 5" pos="{x} {y - 5} {z - 5}" rgba="1 0 0 1"/>'
    grey = f'<geom type="box" size=".01 20 20" pos="{x + 0.011} 0 0" rgba=".8 .8 .8 1"/>'
    photo = photograph(renderer_of, world(red + grey), MEDIUM)[0]
    u, v = project(photo, np.array([x, y, z]))
    is_red = photo.image[..., 0] > 2.0 * photo.image[..., 1]
    rows, columns = np.nonzero(is_red)
    assert columns.min() == pytest.approx(u, abs=0.51)  # the first pixel with its centre, at k + 0.5, beyond the edge
    assert rows.min() == pytest.approx(v, abs=0.51)


def test_the_camera_follows_the_scanner(world, renderer_of):
    # The scanner lies on its side at (5, 0, 0): its z is the world's -y, so that the camera is at y = -0.2.
    place = np.eye(4)
    place[:3, :3] = [[1, 0, 0], [0, 0, -1], [0, 1, 0]]
    place[:3, 3] = 5, 0, 0
    photo = photograph(renderer_of, world('<geom size=".2" pos="8 -.2 0"/>'), place=place)[0]
    rows, columns = np.nonzero(photo.image[..., 1] > 20)
    assert rows.mean() == pytest.approx(133.5, abs=1)
    assert columns.mean() == pytest.approx(88.5, abs=1)


def test_light_falls_with_the_square_of_the_distance(world, renderer_of):
    # Two strips of a matt wall, 2 m and 4 m away, straight ahead within 0.15 m: four times as bright.
    near = '<geom type="box" size=".05 .1 .1" pos="2.05 .1 .2" material="matt"/>'
    far = '<geom type="box" size=".05 .2 .2" pos="4.05 -.2 .2" material="matt"/>'
    photo = photograph(renderer_of, world(near + far, MATT))[0]
    u_near, v = map(int, project(photo, np.array([2, 0.1, 0.2])))
    u_far, _ = map(int, project(photo, np.array([4, -0.2, 0.2])))
    reach2 = [x**2 + (y - -FLASH[0]) ** 2 for x, y in ((2, 0.1), (4, -0.2))]
    cosines = [x / r**0.5 for x, r in zip((2, 4), reach2, strict=True)]
    expected = cosines[0] / reach2[0] / (cosines[1] / reach2[1])
    assert light(photo, v, u_near) / light(photo, v, u_far) == pytest.approx(expected, rel=0.03)


def test_light_falls_with_the_cosine(world, renderer_of):
    # On a flat wall at D, brightness goes with cos^3 of the angle from the flash: cosine x inverse square.
    photo = photograph(renderer_of, world(wall(3), MATT))[0]
    middle = light(photo, 134, 89)
    u, v = map(int, project(photo, np.array([3.0, 0.09, 0.2 + 2.0])))  # 2 m above the flash's own foot
    assert light(photo, v, u) / middle == pytest.approx((3 / 13**0.5) ** 3, rel=0.03)


def test_the_highlight_is_at_the_mirror_point(world, renderer_of):
    # The flash sits 0.09 m to the left of the lens: the mirror point is 0.045 m left, whatever the distance.
    gloss = '<material name="gloss" rgba=".2 .2 .2 1" specular=".6" shininess=".5"/>'
    shiny = photograph(renderer_of, world(wall(3, material="gloss"), gloss), MEDIUM)[0]
    u, v = project(shiny, np.array([3.0, -FLASH[0] / 2, 0.2]))
    rows, columns = np.nonzero(shiny.true_gloss > 12)
    assert rows.mean() + 0.5 == pytest.approx(v, abs=1)
    assert columns.mean() + 0.5 == pytest.approx(u, abs=1.5)
    white = np.nonzero((shiny.image == 255).all(axis=2))
    assert np.mean(white[1]) + 0.5 == pytest.approx(u, abs=2)


def test_a_matt_wall_has_no_highlight(world, renderer_of):
    assert not any(photo.true_gloss.any() for photo in photograph(renderer_of, world(wall(3), MATT)))


def test_the_highlight_narrows_with_the_shininess(world, renderer_of):
    areas = []
    for shininess in (0.25, 1.0):
        gloss = f'<material name="gloss" rgba=".5 .5 .5 1" specular=".5" shininess="{shininess}"/>'
        areas.append((photograph(renderer_of, world(wall(3, material="gloss"), gloss))[0].true_gloss > 12).sum())
    assert areas[0] / areas[1] == pytest.approx(4, rel=0.25)  # area goes with 1 / exponent


def test_materials_without_gloss_get_mujoco_s_defaults_and_roughness_counts(world):
    model, _ = world(
        '<geom size="1"/><geom size="1" material="plain"/><geom size="1" material="rough"/>',
        '<material name="plain"/><material name="rough" roughness=".5"/>',
    )
    materials = materials_of(model)
    assert materials.specular[:2] == pytest.approx([0.5, 0.5])
    assert materials.exponent[:2] == pytest.approx([64, 64])  # 128 x 0.5
    assert materials.exponent[2] == pytest.approx(30)  # 2 / 0.5^4 - 2


def test_the_flash_throws_shadows_to_the_other_side(world, renderer_of):
    # A post 1 m away before a wall at 2 m; the flash is 9 cm left of the lens, so the shadow shows right of the post:
    # its right edge, y = -0.05, is thrown to y = 0.09 - 2 x 0.14 = -0.19, and the post itself hides only down to -0.1.
    post = '<geom type="box" size=".005 .05 2" pos="1.005 0 0" material="matt"/>'
    photo = photograph(renderer_of, world(post + wall(2), MATT), MEDIUM)[0]
    for y, lit in ((-0.14, False), (-0.24, True), (0.14, True)):
        u, v = map(int, project(photo, np.array([2.0, y, 0.2])))
        assert (light(photo, v, u) > 0.02) == lit


def test_without_something_in_between_nothing_is_in_shadow(world, renderer_of):
    # Grazing floor, walls and a ball: no acne.
    room = (
        '<geom type="plane" size="0 0 1" pos="0 0 -1" material="matt"/><geom size=".4" pos="2 .5 0" material="matt"/>'
    )
    photo = photograph(renderer_of, world(room + wall(3), MATT))[0]
    u, v = map(int, project(photo, np.array([2.0, 0.2, -1])))
    floor = photo.image[v : v + 40, u - 20 : u + 20, 0]
    assert floor.min() > 0.5 * floor.max()


def test_a_shadow_reaches_into_a_picture_from_what_stands_outside_it(world, renderer_of):
    # The picture ends 29.4 deg to the left, at y = 0.56 on a wall 1 m away; a post 0.6 m away and from y = 0.35 on is
    # just outside. From the flash at y = 0.09 its edge is thrown to 0.09 + 0.26 / 0.6 = 0.52.
    post = '<geom type="box" size=".001 .05 2" pos=".601 .4 0" material="matt"/>'
    photo = photograph(renderer_of, world(post + wall(1), MATT), MEDIUM)[0]
    u, v = map(int, project(photo, np.array([1.0, 0.54, 0.2])))
    lit, _ = map(int, project(photo, np.array([1.0, 0.48, 0.2])))
    assert light(photo, v, u) < 0.02 < light(photo, v, lit)


def test_a_flash_above_the_lens_throws_shadows_downward():
    # An edge at half the depth, its lower border at the lens's own height: seen from 0.1 m above at focal length 100,
    # what is 1 m away moves down by 10 pixels and the edge at 0.5 m by 20: ten rows below it are in its shadow.
    rows, columns, margin = 60, 8, 25
    window = Window(100.0, 100.0, np.zeros((1, columns), np.float32), np.zeros((rows, 1), np.float32))
    near = np.arange(rows + 2 * margin)[:, None] < margin + 30 + 20
    from_flash = np.where(near, 2, 1).astype(np.float32).repeat(columns, axis=1)
    lens = np.where(np.arange(rows)[:, None] < 30, 2, 1).astype(np.float32).repeat(columns, axis=1)
    lit = seen_from_flash(lens, from_flash, (0.0, 0.1), window, (0, margin))
    assert np.flatnonzero(~lit[:, 4]).tolist() == list(range(30, 40))


def test_ambient_light_fills_the_shadow(world, renderer_of):
    post = '<geom type="box" size=".005 .05 2" pos="1.005 0 0" material="matt"/>'
    photo = photograph(renderer_of, world(post + wall(2), MATT), MEDIUM.model_copy(update={"ambient": 1.0}))[0]
    u, v = map(int, project(photo, np.array([2.0, -0.14, 0.2])))
    lit, _ = map(int, project(photo, np.array([2.0, 0.14, 0.2])))
    # ambient = the flash at 3 m: 1/9 against 1/4 + 1/9
    assert light(photo, v, u) / light(photo, v, lit) == pytest.approx((1 / 9) / (1 / 4 + 1 / 9), rel=0.04)


def test_a_white_wall_is_well_exposed_at_two_and_at_four_metres(world, renderer_of):
    for distance in (2, 4):
        white = '<material name="matt" rgba=".93 .93 .93 1" specular="0"/>'
        photo = photograph(renderer_of, world(wall(distance), white), SMALL.model_copy(update={"ambient": 0.5}))[0]
        assert 160 < photo.image[134, 89].min() < 255


def test_all_photographs_of_a_turn_are_exposed_alike(world, renderer_of):
    # A near wall ahead, a far one behind: as many times darker as the inverse square says, not evened out.
    far = '<geom type="box" size=".5 40 40" pos="-4.5 0 .2" material="matt"/>'
    photos = photograph(renderer_of, world(wall(2) + far, MATT), SMALL.model_copy(update={"shots": 8}))
    assert light(photos[0], 134, 89) / light(photos[4], 134, 89) == pytest.approx(4, rel=0.03)


def test_a_strong_highlight_clips_at_white(world, renderer_of):
    mirror = '<material name="gloss" rgba=".6 .6 .6 1" specular="1" shininess="1"/>'
    photo = photograph(renderer_of, world(wall(3, material="gloss"), mirror), MEDIUM)[0]
    assert (photo.image.max(axis=(0, 1)) == 255).all()
    assert photo.true_gloss[(photo.image == 255).all(axis=2)].max() >= 12  # the matt wall is at 0.9 here, sRGB 243
    assert photo.image[photo.true_gloss == 0].max() < 250


def test_gloss_is_what_the_picture_has_more_than_one_of_a_matt_wall(world, renderer_of):
    colour = '<material name="{}" rgba=".5 .3 .2 1" specular="{}" shininess="1"/>'
    matt, shiny = (
        photograph(renderer_of, world(wall(3, material=name), colour.format(name, specular)), MEDIUM)[0]
        for name, specular in (("dull", 0), ("gloss", 0.2))
    )
    brighter = (shiny.image.astype(float) - matt.image).mean(axis=2)
    assert np.abs(brighter - shiny.true_gloss).max() <= 1  # rounding
    assert shiny.true_gloss.max() > 30


def test_the_sheen_of_matt_paint_is_no_highlight(world, renderer_of):
    # roughness 0.8 is exponent 2 / 0.8^4 - 2 = 2.9: half height 38 deg off the mirror direction
    paint = '<material name="paint" rgba=".5 .5 .5 1" specular=".3" roughness=".8"/>'
    assert not any(photo.true_gloss.any() for photo in photograph(renderer_of, world(wall(3, material="paint"), paint)))


def test_colours_of_the_scene_survive(world, renderer_of):
    colour = '<material name="matt" rgba=".8 .4 .2 1" specular="0"/>'
    photo = photograph(renderer_of, world(wall(3), colour))[0]
    red, green, blue = linear_from_srgb(photo.image[134, 89] / 255)
    assert red / green == pytest.approx(linear_from_srgb(np.array(0.8)) / linear_from_srgb(np.array(0.4)), rel=0.03)
    assert green / blue == pytest.approx(linear_from_srgb(np.array(0.4)) / linear_from_srgb(np.array(0.2)), rel=0.06)


def test_the_photograph_shows_what_is_behind_glass_and_not_the_robot(world, renderer_of):
    scene = world(
        wall(3)
        + '<geom type="box" size=".01 9 9" pos="2 0 0" rgba="0 1 0 .3"/>'
        + '<body name="mast"><geom type="box" size=".1 9 9" pos="1 0 0" rgba="1 0 0 1"/></body>',
        MATT,
    )
    photo = photograph(renderer_of, scene, hidden_bodies={scene[0].body("mast").id})[0]
    red, green, blue = photo.image[134, 89]
    assert red == green == blue > 0


def test_noise_is_that_of_photons(world, renderer_of):
    # Half of full scale is 10 450 electrons: sigma 102 of them, with 11 of reading 103: 0.49 % of full scale.
    photo, quiet = (
        photograph(renderer_of, world(wall(3), MATT), SMALL.model_copy(update={"noise": noise}))[0]
        for noise in (True, False)
    )
    patch = np.s_[124:144, 79:99]
    signal = linear_from_srgb(quiet.image[patch] / 255).mean()
    expected = np.hypot(np.sqrt(signal * 20_900), 11) / 20_900
    difference = linear_from_srgb(photo.image[patch] / 255) - linear_from_srgb(quiet.image[patch] / 255)
    assert difference.std() == pytest.approx(expected, rel=0.2)  # 8 bits add a little


def test_the_same_seed_gives_the_same_photographs(world, renderer_of):
    scene = world(wall(3), MATT)
    noisy = SMALL.model_copy(update={"noise": True})
    first, again, other = (photograph(renderer_of, scene, noisy, seed=seed) for seed in (1, 1, 2))
    assert all((a.image == b.image).all() for a, b in zip(first, again, strict=True))
    assert (first[0].image != other[0].image).any()


def test_an_empty_world_makes_black_photographs(world, renderer_of):
    photo = photograph(renderer_of, world(""))[0]
    assert photo.image.shape == (268, 178, 3)
    assert not photo.image.any()


def test_bands_do_not_show_in_a_photograph(world, renderer_of, monkeypatch):
    # Shadow, gloss and noise across bands of 4 rows and in a single band: the same to the bit.
    shiny = '<material name="shiny" rgba=".3 .5 .7 1" specular=".8" shininess=".6"/>' + MATT
    scene = world(wall(3, material="shiny") + '<geom size=".3" pos="2 .2 .3" material="matt"/>', shiny)
    noisy = SMALL.model_copy(update={"noise": True})
    turns = []
    for pixels in (1, 10**9):
        monkeypatch.setattr("sim.bands._PIXELS", pixels)
        turns.append(photograph(renderer_of, scene, noisy))
    for narrow, whole in zip(*turns, strict=True):
        assert np.array_equal(narrow.image, whole.image)
        assert np.array_equal(narrow.true_gloss, whole.true_gloss)
    assert any(photo.true_gloss.any() for photo in turns[0])
