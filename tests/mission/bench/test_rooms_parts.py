"""Slabs, pictures, outlines and doors that rooms are generated from."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

from mission.bench.walls import floor_plans, textures
from mission.bench.walls.doors import build_door
from mission.bench.walls.finishes import WHITE, Finish, plain, unlike
from mission.bench.walls.kit import Hole, Kit, slab_quads
from mission.bench.walls.plans import Band, DoorPlan, WallPlan, free_spans
from mission.bench.walls.shell import build_shell
from sim.rays import Rays
from sim.render import Renderer, View, looking_along


def compiled(kit: Kit) -> tuple[mujoco.MjModel, mujoco.MjData]:
    kit.spec.assets = kit.assets
    model = kit.spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return model, data


def test_a_slab_with_a_hole_has_the_surface_and_the_volume_that_are_left() -> None:
    # 4 x 0.2 x 2 m with a doorway of 1 x 1.5 m at its lower edge
    quads, _ = slab_quads((0, 0, 0), (4, 0.2, 2), [Hole(1.0000003, -1, 2, 1.5)], (1, 1))
    edges = quads[:, 1] - quads[:, 0], quads[:, 3] - quads[:, 0]
    areas = np.cross(*edges)
    faces = 2 * (4 * 2 - 1 * 1.5)
    rim = 0.2 * (4 + 2 * 2 + 3 + 2 * 1.5 + 1)  # top, ends, what is left of the bottom, jambs, lintel
    assert np.linalg.norm(areas, axis=1).sum() == pytest.approx(faces + rim, abs=1e-5)
    assert np.einsum("qk,qk->", quads.mean(axis=1), areas) / 3 == pytest.approx(6.5 * 0.2, abs=1e-5)  # all face out


def test_rays_pass_a_slab_through_its_hole_only() -> None:
    kit = Kit()
    kit.slab(kit.spec.worldbody.add_body(), (0, 1, 0), (4, 1.2, 2), WHITE, [Hole(1, -1, 2, 1.5)])
    model, data = compiled(kit)
    geom = np.zeros(1, np.int32)
    ahead = np.array([0.0, 1, 0])

    def distance(x: float, z: float) -> float:
        return float(mujoco.mj_ray(model, data, np.array([x, 0, z]), ahead, None, True, -1, geom, None))

    assert distance(0.5, 1) == pytest.approx(1.0, abs=1e-6)
    assert distance(1.5, 1.6) == pytest.approx(1.0, abs=1e-6)
    assert distance(1.5, 1.4) == -1


def test_a_picture_s_first_row_is_on_top_and_its_first_column_on_the_left_as_seen_from_inside() -> None:
    def quarters(rng: np.random.Generator, colour: textures.Colour, variation: float) -> textures.Picture:
        picture = np.zeros((64, 64, 3), np.uint8)
        picture[:32, :32], picture[:32, 32:], picture[32:] = (255, 0, 0), (0, 255, 0), (0, 0, 255)
        return picture

    kit = Kit()
    kit.slab(kit.spec.worldbody.add_body(), (-1, 2, -1), (1, 2.1, 1), Finish((1, 1, 1), quarters, period=(2, 2)))
    model, data = compiled(kit)
    with Renderer(model) as renderer:
        view = View(looking_along(np.pi / 2), -0.4, 0.4, -0.4, 0.4, 40, 40)  # along y, as one looks at a wall
        picture = renderer.albedo(data, view)[::-1]  # bottom row first to top row first
    assert picture[10, 10].tolist() == [255, 0, 0]
    assert picture[10, 30].tolist() == [0, 255, 0]
    assert picture[30, 20].tolist() == [0, 0, 255]


@pytest.mark.parametrize(
    "painter",
    [textures.plaster, textures.mottled, textures.tiles, textures.bricks, textures.grain, textures.boards]
    + [textures.planks, textures.carpet, textures.poster, textures.sign],
)
def test_a_picture_comes_out_the_same_for_the_same_seed_and_near_its_colour(painter: textures.Painter) -> None:
    colour = (0.6, 0.5, 0.4)
    one, other = (painter(np.random.default_rng(3), colour, 0.1) for _ in range(2))
    assert one.dtype == np.uint8 and one.shape[2] == 3
    np.testing.assert_array_equal(one, other)
    assert np.abs(one.mean(axis=(0, 1)) / 255 - colour).max() < 0.25


def test_stained_paint_varies_by_as_much_as_asked_in_each_colour() -> None:
    picture = textures.mottled(np.random.default_rng(0), (0.6, 0.55, 0.5), 0.28)
    np.testing.assert_allclose(np.ptp(picture.reshape(-1, 3), axis=0) / 255, 0.28, atol=1 / 255)


def test_plaster_goes_on_without_a_seam_where_it_repeats() -> None:
    picture = textures.plaster(np.random.default_rng(0), (0.8, 0.8, 0.8), 0.06).astype(int)
    inside = np.abs(np.diff(picture, axis=1)).max()
    assert np.abs(picture[:, 0] - picture[:, -1]).max() <= inside + 1


def test_an_l_has_one_reflex_corner_and_grows_by_the_same_on_all_sides() -> None:
    corners = floor_plans.angled(6, 5, (2, 1))
    assert floor_plans.reflex_corners(corners).tolist() == [False, False, False, False, True, False]
    np.testing.assert_allclose(floor_plans.side_lengths(corners), [6, 5, 4, 1, 2, 4])
    grown = floor_plans.grown(corners, 0.1)
    np.testing.assert_allclose(grown[0], [-0.1, 5.1])
    np.testing.assert_allclose(grown[4], [1.9, 0.9])  # into the corner that is no room


def test_scan_places_keep_off_walls_and_tables_and_see_what_they_should() -> None:
    corners = floor_plans.angled(7, 6, (2, 2))
    rng = np.random.default_rng(1)
    behind_the_corner = np.array([[6.5, 0.05]])
    places = floor_plans.scan_places(rng, corners, 4, seen=behind_the_corner, avoid=[(4.0, 3.5, 1.0)])
    x, y = np.array(places)[:, :2].T
    assert (np.minimum.reduce([x, y, 7 - x, 6 - y]) >= 1.6).all()
    assert (np.hypot(x - 2, y - 2)[(x < 2) | (y < 2)] >= 1.6).all()
    assert (np.hypot(x - 4, y - 3.5) >= 1).all()
    # the line from (6.5, 0.05) past the corner at (2, 2): places below it are hidden by the notch
    assert (y >= 2 - (x - 2) * 1.95 / 4.5).all()


def test_free_spans_are_what_doors_leave_of_a_wall() -> None:
    assert free_spans([(1.0, 2.0), (1.5, 2.2), (4.9, 5.5)], 6.0, 0.6) == [(0.0, 1.0), (2.2, 4.9)]


def test_a_wall_with_a_dado_has_its_colour_up_to_its_height_and_the_wall_s_above() -> None:
    kit = Kit()
    dado, paint = plain((0.3, 0.4, 0.5)), plain((0.9, 0.9, 0.8))
    wall = WallPlan(paint, 0.2, (DoorPlan(1.0, 1.0, 2.0, WHITE),), bands=(Band(0.0, 1.2, dado),))
    build_shell(kit, kit.spec.worldbody.add_body(), wall, (4.0, 2.6), (0.0, 0.0))
    model, data = compiled(kit)
    rays = Rays(model, data)

    def colour(x: float, z: float) -> tuple[float, ...] | None:
        hits = rays.cast(np.array([x, -1.0, z]), np.array([[0.0, 1, 0]]))
        return tuple(model.mat_rgba[model.geom_matid[hits.geoms[0]], :3].round(3)) if hits.geoms[0] >= 0 else None

    assert [colour(0.5, z) for z in (0.1, 1.19, 1.21, 2.5)] == [dado.colour] * 2 + [paint.colour] * 2
    assert colour(1.5, 0.6) is colour(1.5, 1.6) is None  # through the doorway
    assert colour(1.5, 2.3) == paint.colour


@pytest.mark.parametrize("hinge", ["left", "right"])
@pytest.mark.parametrize("opens", ["inward", "outward"])
def test_a_leaf_swings_about_its_hinge_to_the_side_that_it_opens_to(hinge, opens) -> None:
    kit = Kit()
    wall = kit.spec.worldbody.add_body()
    door = DoorPlan(1.0, 0.9, 2.0, plain((0.5, 0.4, 0.3)), recess=0.0, hinge=hinge, opens=opens, openings=(np.pi / 2,))
    assert build_door(kit, wall, door, 0.15, "leaf") == ("leaf",)
    model, data = compiled(kit)
    body = model.body("leaf").id
    assert data.qpos[0] == pytest.approx(np.pi / 2)
    slab = next(g for g in range(model.ngeom) if model.geom_bodyid[g] == body and model.geom_type[g] == 7)  # the mesh
    x, y, z = data.geom_xpos[slab]
    edge = 1.0 if hinge == "left" else 1.9
    assert abs(x - edge) == pytest.approx(0.02, abs=1e-3)  # square to the wall, half its thickness from the hinge
    assert y == pytest.approx(-0.45 if opens == "inward" else 0.04 + 0.45, abs=1e-3)
    assert z == pytest.approx(1.003, abs=1e-3)


def test_both_leaves_of_a_double_door_and_a_slide_stand_where_the_plan_says() -> None:
    kit = Kit()
    wall = kit.spec.worldbody.add_body()
    double = DoorPlan(0.0, 1.6, 2.0, WHITE, leaves=2, openings=(0.0, 0.5))
    slide = DoorPlan(3.0, 0.9, 2.0, WHITE, slides=True, hinge="right", openings=(0.4,))
    assert build_door(kit, wall, double, 0.15, "d") == ("d left", "d right")
    build_door(kit, wall, slide, 0.15, "s")
    model, data = compiled(kit)
    np.testing.assert_allclose(data.qpos, [0, 0.5, 0.4])
    np.testing.assert_allclose(data.body("s").xpos[0], 3.4)


def test_where_no_colour_is_far_enough_from_another_the_farthest_is_taken() -> None:
    colours = ((0.5, 0.5, 0.5), (0.55, 0.5, 0.5))
    taken = unlike(np.random.default_rng(0), colours, (0.5, 0.5, 0.5), least=0.4)
    np.testing.assert_allclose(taken, colours[1], atol=0.04)  # jittered by 0.03 and a third of it
