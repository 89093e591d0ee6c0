"""How much of a door furniture hides, and how highlights fall."""

from __future__ import annotations

import cv2
import mujoco
import numpy as np
import pytest

from mission.bench.walls.finishes import WHITE
from mission.bench.walls.fitting import is_fair, places_for
from mission.bench.walls.glossy import SHOWS
from mission.bench.walls.hidden import Hidden, hidden_shares, scanner_origins
from mission.bench.walls.plans import DoorPlan, WallPlan
from mission.bench.walls.rooms import BenchRoom, rooms
from sim.camera import Camera
from sim.doors import true_doors
from sim.rays import Rays
from sim.render import Renderer

PANEL = np.array([[0.0, 0, 0], [1, 0, 0], [1, 0, 2], [0, 0, 2]])
AHEAD = np.array([[0.5, -4.0, 1.0]])


def board(
    x: tuple[float, float], z: tuple[float, float], y: float = -0.03, passed: frozenset[int] = frozenset()
) -> Rays:
    """Rays past a thin upright board before the panel."""
    place = f"{sum(x) / 2} {y} {sum(z) / 2}"
    size = f"{(x[1] - x[0]) / 2} 0.001 {(z[1] - z[0]) / 2}"
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><worldbody><body><geom type="box" pos="{place}" size="{size}"/></body></worldbody></mujoco>'
    )
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return Rays(model, data, passed)


def test_a_board_over_the_left_half_hides_half_the_panel_and_the_left_side_of_the_frame() -> None:
    hidden = hidden_shares(board((-0.5, 0.5), (-1, 2.01)), PANEL, AHEAD)
    assert hidden.panel == pytest.approx(0.5, abs=0.04)
    assert hidden.frame == pytest.approx(2 / 5, abs=0.04)  # of 2 m left, 2 m right and 1 m above


def test_a_board_up_to_half_height_hides_half_the_panel_and_both_sides_up_to_it() -> None:
    hidden = hidden_shares(board((-0.5, 1.5), (-1, 1.0)), PANEL, AHEAD)
    assert hidden.panel == pytest.approx(0.5, abs=0.04)
    assert hidden.frame == pytest.approx(2 / 5, abs=0.04)


def test_a_board_over_an_upright_hides_that_side_and_the_corner_above_it() -> None:
    # over the left upright and a fifth of the top, its upper edge 2 cm above the frame's
    whole = hidden_shares(board((-0.5, 0.2), (-1, 2.05)), PANEL, AHEAD)
    np.testing.assert_allclose(whole.sides, (1, 0.2, 0), atol=0.04)
    assert not whole.corners_seen and not is_fair(whole)
    # 1 m of the left upright's 2 m
    half = hidden_shares(board((-0.5, 0.2), (-1, 1.0)), PANEL, AHEAD)
    np.testing.assert_allclose(half.sides, (0.5, 0, 0), atol=0.04)
    assert half.corners_seen and is_fair(half)


def test_an_upper_corner_counts_as_seen_from_one_place_that_sees_all_of_it() -> None:
    # 1 m before the wall a rod at the left upright's height: seen from ahead it is before the corner
    rays = board((-0.05, 0.1), (1.5, 2.5), y=-1.0)
    ahead, beside = np.array([0.0, -4.0, 1.9]), np.array([2.5, -4.0, 1.9])
    assert not hidden_shares(rays, PANEL, ahead[None]).corners_seen
    assert hidden_shares(rays, PANEL, np.array([ahead, beside])).corners_seen


def test_a_door_is_fair_up_to_40_percent_of_its_panel_50_of_its_frame_and_60_of_each_side() -> None:
    assert is_fair(Hidden(panel=0.4, frame=0.5, sides=(0.6, 0.2, 0.6)))
    assert not is_fair(Hidden(panel=0.41, frame=0.2))
    assert not is_fair(Hidden(panel=0.2, frame=0.51))
    assert not is_fair(Hidden(panel=0.2, frame=0.3, sides=(0.61, 0, 0)))
    assert not is_fair(Hidden(panel=0.2, frame=0.3, corners_seen=False))


def test_what_one_scan_place_sees_is_not_hidden() -> None:
    # 1 m before the panel a board of 0.3 m throws shadows of 0.4 m; seen from 2 m left and right they are 1.3 m apart
    rays = board((0.35, 0.65), (-1, 2.5), y=-1.0)
    apart = np.array([[-1.5, -4.0, 1.0], [2.5, -4.0, 1.0]])
    assert hidden_shares(rays, PANEL, AHEAD).panel == pytest.approx(0.4, abs=0.04)  # one column
    assert hidden_shares(rays, PANEL, apart).panel == 0


def test_bodies_that_are_passed_hide_nothing() -> None:
    assert hidden_shares(board((-0.5, 1.5), (-1, 3), passed=frozenset([1])), PANEL, AHEAD).panel == 0


def test_the_scanner_of_a_turned_robot_is_above_its_base_and_turned_with_it() -> None:
    (ahead, turned) = scanner_origins(((0.0, 0.0, 0.0), (0.0, 0.0, np.pi / 2)))
    np.testing.assert_allclose(turned, [-ahead[1], ahead[0], ahead[2]], atol=1e-12)
    assert 1.05 <= ahead[2] <= 1.25


def test_an_occluder_may_stand_before_its_own_door_only_and_not_in_the_right_corner() -> None:
    doors = tuple(DoorPlan(left, 0.8, 2.0, WHITE) for left in (1.2, 3.4))
    places = places_for(WallPlan(WHITE, 0.2, doors), 1, 0.8, 5.0)
    assert places and min(places) - 0.4 > 2.0  # right of the other door
    assert max(places) + 0.4 < 5.0 - 0.9
    assert all(abs(x - 3.8) < 0.8 for x in places)  # before some of its own


def highlights(room: BenchRoom) -> list[tuple[float, bool]]:
    """Area [m2] of each highlight on each judged wall and whether it reaches over a door's upright edge."""
    model = mujoco.MjModel.from_xml_string(room.xml, dict(room.assets))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    edges = np.concatenate([truth.corners_in_world[:2] for truth in true_doors(model, data)])
    found = []
    with Renderer(model) as renderer:
        camera = Camera(renderer)
        for (*_, heading), origin in zip(room.scan_places, scanner_origins(room.scan_places), strict=True):
            world_from_scanner = np.eye(4)
            c, s = np.cos(heading), np.sin(heading)
            world_from_scanner[:2, :2], world_from_scanner[:3, 3] = [[c, -s], [s, c]], origin
            for photo in camera.photograph(data, world_from_scanner, np.random.default_rng(0)):
                world_from_camera = world_from_scanner @ photo.scanner_from_camera
                rows, columns = np.nonzero(photo.true_gloss >= SHOWS)
                pixels = np.column_stack([columns + 0.5, rows + 0.5, np.ones(len(rows))])
                beams = pixels @ np.linalg.inv(photo.intrinsics).T @ world_from_camera[:3, :3].T
                for wall in room.walls:
                    start, along = np.array(wall.origin), np.subtract(wall.end, wall.origin)
                    length = float(np.linalg.norm(along))
                    along /= length
                    outward = np.cross([0, 0, 1], along)
                    with np.errstate(divide="ignore"):
                        reach = ((start - world_from_camera[:3, 3]) @ outward) / (beams @ outward)
                    met = world_from_camera[:3, 3] + reach[:, None] * beams - start
                    x, z = met @ along, met[:, 2]
                    on = (reach > 0) & (x > 0) & (x < length) & (z > 0.2) & (z < wall.height)
                    mask = np.zeros((int(wall.height * 100) + 2, int(length * 100) + 2), np.uint8)
                    mask[(z[on] * 100).astype(int), (x[on] * 100).astype(int)] = 1
                    mask = cv2.morphologyEx(mask, cv2.MORPH_CLOSE, np.ones((3, 3), np.uint8))
                    own = edges[np.abs((edges - start) @ outward) < 0.25]
                    for left, _, width, _, area in cv2.connectedComponentsWithStats(mask)[2][1:]:
                        over = ((own - start) @ along * 100 > left) & ((own - start) @ along * 100 < left + width)
                        found.append((float(area) * 1e-4, bool(over.any())))
    return found


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(2))
def test_glossy_rooms_throw_back_highlights_of_the_paper_s_sizes_and_some_across_a_door_s_border(seed: int) -> None:
    (room,) = rooms(seed, ["specular"])
    seen = [one for one in highlights(room) if one[0] > 8e-4]
    assert max(area for area, _ in seen) <= 0.4  # the paper's largest has 0.27, by its own outlines
    assert max(area for area, _ in seen) > 0.03
    assert any(over and area > 0.01 for area, over in seen)
