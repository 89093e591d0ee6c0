"""Generated rooms: what they hold, where it stands, and that the truth says the same."""

from __future__ import annotations

from functools import cache

import mujoco
import numpy as np
import pytest

from mission.bench.walls import very_complex
from mission.bench.walls.fitting import MOST_HIDDEN
from mission.bench.walls.plans import RoomPlan
from mission.bench.walls.rooms import CATEGORIES, BenchRoom, rooms
from sim.doors import DoorTruth, true_doors
from sim.rays import Rays
from sim.scene import FOOTPRINT
from sim.start import require_surroundings, upright_pose

DOORS = {"simple": 10, "occlusion": 7, "specular": 4, "semi-open": 5, "very complex": 9}
WALLS = {"simple": 7, "occlusion": 6, "specular": 3, "semi-open": 4, "very complex": 7}


@cache
def of_category(seed: int, category: str) -> tuple[BenchRoom, ...]:
    return tuple(rooms(seed, [category]))


def loaded(room: BenchRoom) -> tuple[mujoco.MjModel, mujoco.MjData]:
    model = mujoco.MjModel.from_xml_string(room.xml, dict(room.assets))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return model, data


def opening(truth: DoorTruth) -> list[float]:
    return [leaf.opening if truth.kind == "sliding" else leaf.opening_angle for leaf in truth.leaves]


def check_truth(room: BenchRoom) -> None:
    """The truth finds the judged doors and no others, in their walls and as far open as they are said to be."""
    model, data = loaded(room)
    found = {truth.name: truth for truth in true_doors(model, data)}
    judged = {"+".join(door.bodies): (wall, door) for wall in room.walls for door in wall.doors}
    assert found.keys() == judged.keys(), room.name
    for name, (wall, door) in judged.items():
        truth = found[name]
        np.testing.assert_allclose(opening(truth), door.qpos, atol=1e-3)
        along = np.subtract(wall.end, wall.origin)
        length = float(np.linalg.norm(along))
        places = (truth.corners_in_world - wall.origin) @ along / length
        assert places.min() > 0.1 and places.max() < length - 0.1, name
        outward = np.cross([0, 0, 1], along / length)
        assert np.abs((truth.corners_in_world - wall.origin) @ outward).max() < 0.25, name  # in the wall
        assert truth.corners_in_world[:, 2].max() < wall.height


@pytest.mark.parametrize("category", ["specular", "semi-open"])
def test_the_truth_finds_exactly_the_judged_doors(category: str) -> None:
    for room in of_category(0, category):
        check_truth(room)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(5))
def test_every_seed_has_35_doors_in_27_walls_and_the_truth_finds_them(seed: int) -> None:
    for category in CATEGORIES:
        made = of_category(seed, category)
        walls = [wall for room in made for wall in room.walls]
        assert len(walls) == WALLS[category]
        assert sum(len(wall.doors) for wall in walls) == DOORS[category]
        assert {wall.category for wall in walls} == {category}
        assert all(2 <= len(room.scan_places) <= 4 and len(room.walls) <= 4 for room in made)
        for room in made:
            check_truth(room)


def test_a_category_comes_out_the_same_twice_and_alone_or_with_others() -> None:
    again = rooms(0, ["specular", "semi-open"])
    for room in again:
        first = next(one for one in of_category(0, room.walls[0].category) if one.name == room.name)
        assert first == room


def test_another_seed_makes_other_rooms() -> None:
    assert of_category(0, "specular")[0].xml != of_category(1, "specular")[0].xml


def test_a_category_that_does_not_exist_is_named_beside_those_that_do() -> None:
    with pytest.raises(ValueError, match="'odd'.*simple, occlusion"):
        rooms(0, ["odd"])


def test_the_robot_can_stand_at_every_scan_place_1_5_m_from_the_judged_walls() -> None:
    for category in ("occlusion", "semi-open"):
        for room in of_category(0, category):
            rays = Rays(*loaded(room))
            for x, y, heading in room.scan_places:
                require_surroundings(rays, upright_pose(np.array([x, y, 0.0]), heading), FOOTPRINT)
                for wall in room.walls:
                    along = np.subtract(wall.end, wall.origin)
                    outward = np.cross([0, 0, 1], along / np.linalg.norm(along))
                    assert (np.array(wall.origin) - [x, y, 0]) @ outward > 1.5


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(5))
def test_furniture_hides_doors_in_the_occlusion_category_only_and_no_more_than_the_paper_s(seed: int) -> None:
    hidden = [door for room in of_category(seed, "occlusion") for wall in room.walls for door in wall.doors]
    assert all(door.panel_hidden <= MOST_HIDDEN.panel and door.frame_hidden <= MOST_HIDDEN.frame for door in hidden)
    assert all(max(door.panel_hidden, door.frame_hidden) > 0.03 for door in hidden)
    assert max(door.panel_hidden for door in hidden) > 0.27
    clear = [door for room in of_category(seed, "simple") for wall in room.walls for door in wall.doors]
    assert all(door.panel_hidden < 0.02 and door.frame_hidden < 0.02 for door in clear)


def test_semi_open_doors_are_1_to_70_percent_closed_and_one_slides() -> None:
    for seed in range(3):
        (room,) = of_category(seed, "semi-open")
        model, _ = loaded(room)
        doors = [door for wall in room.walls for door in wall.doors]
        slides = [model.joint(int(model.body(door.bodies[0]).jntadr[0])).type[0] == 2 for door in doors]  # mjJNT_SLIDE
        assert sum(slides) == 1
        closings = sorted(
            1 - door.qpos[0] / (np.pi / 2) for door, slide in zip(doors, slides, strict=True) if not slide
        )
        assert 0.01 <= closings[0] <= 0.05 and 0.6 <= closings[-1] <= 0.70


def test_semi_open_doors_hinge_left_and_right_and_open_inward_and_outward() -> None:
    (room,) = of_category(0, "semi-open")
    model, data = loaded(room)
    kinds = set()
    for truth in true_doors(model, data):
        if truth.kind == "sliding":
            continue
        wall = next(w for w in room.walls if any(truth.name in door.bodies for door in w.doors))
        along = np.subtract(wall.end, wall.origin)
        outward = np.cross([0, 0, 1], along / np.linalg.norm(along))
        leaf = truth.leaves[0]
        middle = truth.corners_in_world.mean(axis=0)
        kinds.add(
            (
                "left" if (leaf.corners_in_world[0] - middle) @ along < 0 else "right",
                "outward" if leaf.swing_normal @ outward > 0 else "inward",
            )
        )
    assert kinds == {("left", "inward"), ("right", "inward"), ("left", "outward"), ("right", "outward")}


@cache
def complex_plans(seed: int) -> tuple[RoomPlan, ...]:
    return very_complex.plans(np.random.default_rng(seed))


@pytest.mark.parametrize("seed", range(5))
def test_very_complex_doors_come_as_near_to_their_wall_s_colour_as_the_paper_s_and_no_nearer(seed: int) -> None:
    walls = [wall for plan in complex_plans(seed) for wall in plan.walls if wall.is_judged]
    differences = np.array(
        [np.abs(np.subtract(door.finish.colour, wall.finish.colour)) for wall in walls for door in wall.doors]
    )
    assert len(differences) == 9
    assert (differences >= np.array(very_complex.LEAST_DIFFERENCE) - 1e-9).all()
    assert np.abs(differences - very_complex.LEAST_DIFFERENCE).max(axis=1).min() < 1e-9  # one as near as can be
    assert all(door.recess <= 0.012 for wall in walls for door in wall.doors)  # in the wall's plane, or nearly


@pytest.mark.parametrize("seed", range(5))
def test_very_complex_walls_include_a_double_door_tiles_stains_glass_and_baits_in_their_wall_s_colour(
    seed: int,
) -> None:
    walls = [wall for plan in complex_plans(seed) for wall in plan.walls if wall.is_judged]
    doors = [door for wall in walls for door in wall.doors]
    painters = {wall.finish.painter.__name__: wall.finish for wall in walls if wall.finish.painter}
    assert {"tiles", "mottled", "boards"} <= painters.keys()
    assert painters["mottled"].variation == very_complex.WALL_VARIATION
    assert sum(door.leaves == 2 for door in doors) == 1
    assert any(door.panel in ("glazed", "vision") for door in doors)
    assert any(getattr(stood.thing, "finish", None) == wall.finish for wall in walls for stood in wall.stood)
