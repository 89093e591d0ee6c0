"""Generated rooms: what they hold, where it stands, and that the truth says the same."""

from __future__ import annotations

from functools import cache

import mujoco
import numpy as np
import pytest

from mission.bench.walls import rooms as generator
from mission.bench.walls import semi_open, simple, very_complex
from mission.bench.walls.building import Building
from mission.bench.walls.fitting import NoPlaceError, fit_occluders
from mission.bench.walls.hidden import Hidden
from mission.bench.walls.plans import RoomPlan
from mission.bench.walls.rooms import CATEGORIES, BenchDoor, BenchRoom, rooms
from sim.doors import DoorTruth, true_doors
from sim.rays import Rays
from sim.scene import FOOTPRINT
from sim.start import require_surroundings, upright_pose

DOORS = {"simple": 10, "occlusion": 7, "specular": 4, "semi-open": 5, "very complex": 9}
WALLS = {"simple": 7, "occlusion": 6, "specular": 3, "semi-open": 4, "very complex": 7}


@cache
def of_category(seed: int, category: str) -> tuple[BenchRoom, ...]:
    return tuple(rooms(seed, [category]))


def doors_of(seed: int, category: str) -> list[BenchDoor]:
    return [door for room in of_category(seed, category) for wall in room.walls for door in wall.doors]


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


@pytest.mark.parametrize("seed", range(5))
def test_furniture_hides_as_much_of_the_doors_as_the_paper_s_but_leaves_in_sight_where_each_side_is(seed: int) -> None:
    hidden = doors_of(seed, "occlusion")
    assert all(door.panel_hidden <= 0.4 and door.frame_hidden <= 0.5 for door in hidden)
    assert all(max(door.sides_hidden) <= 0.6 and door.corners_seen for door in hidden)
    assert all(max(door.panel_hidden, door.frame_hidden) > 0.03 for door in hidden)
    assert max(door.panel_hidden for door in hidden) > 0.27
    assert max(door.frame_hidden for door in hidden) > 0.38
    assert np.mean([door.panel_hidden for door in hidden]) > 0.18


def test_each_occluder_is_there_in_one_size_and_stands_on_the_floor() -> None:
    for room, count in zip(of_category(0, "occlusion"), (4, 3), strict=True):
        model, data = loaded(room)
        names = [model.body(number).name for number in range(model.nbody)]
        occluders = [name for name in names if name.startswith("occluder")]
        assert len(occluders) == count
        assert all(data.body(name).xpos[2] == 0 for name in occluders)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(5))
def test_nothing_hides_the_doors_of_simple_scenes(seed: int) -> None:
    assert all(door.panel_hidden < 0.02 and door.frame_hidden < 0.02 for door in doors_of(seed, "simple"))


def test_a_category_in_which_an_occluder_finds_no_place_is_planned_anew(monkeypatch: pytest.MonkeyPatch) -> None:
    built = []

    def fit(building: Building, origins: np.ndarray) -> dict[tuple[int, int], Hidden]:
        built.append(building)
        if len(built) == 1:
            raise NoPlaceError("no place")
        return dict(fit_occluders(building, origins))

    monkeypatch.setattr(generator, "fit_occluders", fit)
    (room,) = rooms(0, ["semi-open"])
    assert len(built) == 2 and len(room.walls) == 4
    assert room.xml != of_category(0, "semi-open")[0].xml


def test_semi_open_doors_are_1_to_70_percent_closed_one_is_hardly_open_and_one_slides() -> None:
    for seed in range(3):
        (room,) = of_category(seed, "semi-open")
        model, _ = loaded(room)
        doors = doors_of(seed, "semi-open")
        slides = [model.joint(int(model.body(door.bodies[0]).jntadr[0])).type[0] == 2 for door in doors]  # mjJNT_SLIDE
        assert sum(slides) == 1
        little, *angles = sorted(
            np.degrees(door.qpos[0]) for door, slide in zip(doors, slides, strict=True) if not slide
        )
        assert 3 <= little <= 25
        closings = [1 - angle / 90 for angle in angles]
        assert 0.01 <= closings[-1] <= 0.05 and 0.6 <= closings[0] <= 0.70


def test_the_sliding_leaf_is_in_a_pocket_or_on_either_face_of_its_wall_by_the_seed() -> None:
    found = set()
    for seed in range(10):
        (plan,) = semi_open.plans(np.random.default_rng(seed))
        ((thickness, slide),) = [(wall.thickness, door) for wall in plan.walls for door in wall.doors if door.slides]
        found.add("inner face" if slide.recess < 0 else "outer face" if slide.recess > thickness else "pocket")
    assert found == {"inner face", "outer face", "pocket"}


@pytest.mark.parametrize("seed", range(5))
def test_one_simple_wall_is_painted_in_several_colours_none_of_them_its_door_s(seed: int) -> None:
    walls = [wall for plan in simple.plans(np.random.default_rng(seed)) for wall in plan.walls if wall.bands]
    (wall,) = walls
    (door,) = wall.doors
    strongest = wall.bands[-1]
    assert 1.0 <= strongest.top <= 1.5
    assert sum(strongest.finish.colour) < sum(wall.finish.colour) - 0.3  # darker by a tenth of full scale
    assert np.abs(np.subtract(strongest.finish.colour, door.finish.colour)).max() > 0.08


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
