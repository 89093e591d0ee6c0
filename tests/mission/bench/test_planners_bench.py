"""The planners benchmark: rooms and visible structure from the truth, sums by mental arithmetic, the command line."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from mission.__main__ import main
from mission.bench.planners.exploring import Exploration
from mission.bench.planners.report import PlannersReport
from mission.bench.planners.rooms import rooms_of
from mission.bench.planners.statistics import Count, comparison, mean_coverage, summary
from mission.bench.planners.truth import CELL, seen, visible_structure
from mission.bench.walls.scanning import scanner_mount
from mission.config import MissionConfig
from sim.scanner import Scanner, ScannerParameters
from sim.scene import load_scene

TWO_ROOMS = """
<mujoco>
  <compiler angle="degree"/>
  <worldbody>
    <geom type="box" pos="4 0 -0.05" size="6.2 2.2 0.05"/>
    <geom type="box" pos="4 0 2.55" size="6.2 2.2 0.05"/>
    <geom type="box" pos="4 2.1 1.25" size="6.2 0.1 1.25"/>
    <geom type="box" pos="4 -2.1 1.25" size="6.2 0.1 1.25"/>
    <geom type="box" pos="-2.1 0 1.25" size="0.1 2 1.25"/>
    <geom type="box" pos="10.1 0 1.25" size="0.1 2 1.25"/>
    <geom type="box" pos="2.1 1.25 1.25" size="0.1 0.75 1.25"/>
    <geom type="box" pos="2.1 -1.25 1.25" size="0.1 0.75 1.25"/>
    <geom type="box" pos="2.1 0 2.25" size="0.1 0.5 0.25"/>
    {things}
    <body name="door" pos="2.02 0.5 1">
      <joint axis="0 0 1" range="-100 0" damping="1"/>
      <geom type="box" pos="0 -0.5 0" size="0.02 0.498 0.998"/>
    </body>
    <site name="start"/>
  </worldbody>
</mujoco>
"""
"""Rooms of 4 x 4 and 7.8 x 4 m, 2.5 m high, and between them a doorway of 1 x 2 m whose leaf opens into the first."""
WARDROBE = '<geom name="wardrobe" type="box" pos="-1 1.75 1" size="0.5 0.25 1"/>'


@pytest.fixture
def two_rooms(tmp_path: Path) -> object:
    """Writes the scene, with things in the first room."""

    def write(things: str = "") -> Path:
        path = tmp_path / "two_rooms.xml"
        path.write_text(TWO_ROOMS.format(things=things))
        return path

    return write


def exploration(planner: str, room: int, seed: int, *coverage: float) -> Exploration:
    """A run of 2 m from scan to scan."""
    metres = tuple(2.0 * k for k in range(len(coverage)))
    return Exploration("a.xml", room, planner, seed, coverage, metres, "coverage")


AREAS = {("a.xml", 1): 100.0, ("a.xml", 2): 300.0}
NBS = [exploration("nbs", 1, 0, 0.8, 0.99), exploration("nbs", 2, 0, 0.7, 0.96, 0.985)]
GRID = [exploration("grid", 1, 0, 0.8, 0.9, 0.95, 1.0), exploration("grid", 2, 0, 0.7, 0.9, 0.94, 0.97)]


def test_scans_and_metres_add_up_over_rooms_and_coverage_is_weighted_with_their_areas() -> None:
    one = summary(NBS, AREAS)
    assert (one.rooms, one.scans) == (2, 5.0)
    assert one.metres == pytest.approx(2.0 + 4.0)
    assert one.coverage == pytest.approx((0.99 * 100 + 0.985 * 300) / 400)
    assert one.scans_to == (Count(4.0, True), Count(4.0, True), Count(5.0, True))
    # The grid ends room 2 at 0.97: to 0.98 it takes 4 + more than 4 scans.
    assert str(summary(GRID, AREAS).scans_to[2]) == "≥ 9.0"
    two_seeds = [*NBS, exploration("nbs", 1, 1, 0.8), exploration("nbs", 2, 1, 0.7)]
    assert summary(two_seeds, AREAS).scans == pytest.approx((5 + 2) / 2)


def test_planners_are_compared_at_the_coverage_that_both_reach() -> None:
    # Room 1: 0.99 and 1, so 0.985 with the tolerance: 2 scans and 4. Room 2: 0.985 and 0.97, so 0.965: 3 scans and 4.
    both = comparison(NBS, GRID)
    assert (both.nbs_scans, both.baseline_scans) == (5.0, 8.0)
    assert both.coverage == pytest.approx((0.99 + 0.97) / 2)


def test_a_run_that_has_ended_keeps_its_coverage_in_the_curve() -> None:
    np.testing.assert_allclose(
        mean_coverage(NBS, AREAS), [(80 + 210) / 400, (99 + 288) / 400, (99 + 0.985 * 300) / 400]
    )


def test_the_tables_have_a_row_a_planner_and_a_row_a_baseline() -> None:
    ends, same = PlannersReport([*NBS, *GRID], AREAS, MissionConfig()).tables()
    assert [row[1] for row in ends.rows] == ["nbs", "grid"]
    assert same.rows == (("a.xml", "grid", "98.00%", "5.00", "8.00"),)


def test_rooms_are_what_the_robot_gets_into_and_a_closed_door_parts_them(two_rooms) -> None:
    (alone,) = rooms_of(load_scene(two_rooms()))
    # The disc of 0.61 m must be free of the walls: x and y within 1.39 m, at 0.25 m apart 11 by 11 places.
    assert len(alone.places_in_world) == 121
    assert abs(alone.places_in_world[:, :2]).max() == pytest.approx(1.25)
    first, second = rooms_of(load_scene(two_rooms(), door_angles={"door": np.radians(95)}))
    np.testing.assert_array_equal(first.places_in_world, alone.places_in_world)
    x, y = second.world_from_base[:2, 3]
    # It turns where the doorway's edges, 0.5 m aside, are out of the disc: from 2.2 + sqrt(0.61^2 - 0.5^2) = 2.55 on.
    assert 2.55 < x < 2.75 and abs(y) < 0.01
    assert second.places_in_world[:, 0].min() > 2.55


@pytest.mark.slow
def test_the_visible_structure_is_floor_ceiling_and_walls_of_the_room_without_its_furniture(two_rooms) -> None:
    scene = load_scene(two_rooms(WARDROBE), door_angles={"door": np.radians(95)})
    cells = visible_structure(scene, rooms_of(scene)[0], scanner_mount())
    # 16 + 16 m2 of floor and ceiling, 40 of walls; not 2 of doorway, nor 2 of wall and 0.5 of floor at the wardrobe.
    # The scanner sees nothing of the wall behind the open leaf's edge or just over the wardrobe: a few cells.
    assert len(cells) * CELL**2 == pytest.approx(16 + 16 + 40 - 2 - 2 - 0.5, rel=0.05)
    assert abs(cells[:, 0]).max() < 2.1 and abs(cells[:, 1]).max() < 2.1  # nothing of the other room
    front = (abs(cells[:, 1] - 1.5) < 0.05) & (abs(cells[:, 0] + 1) < 0.4) & (cells[:, 2] > 0.1) & (cells[:, 2] < 1.9)
    assert not front.any()


@pytest.mark.slow
def test_a_scan_sees_all_but_the_discs_below_and_above_itself(two_rooms) -> None:
    scene = load_scene(two_rooms())
    cells = visible_structure(scene, rooms_of(scene)[0], scanner_mount())
    pose = scene.world_from_base @ scanner_mount()
    scanner = Scanner(scene.model, ScannerParameters(pattern="draft"), hidden_bodies=scene.robot_bodies)
    scan = scanner.scan(scene.data, pose, np.random.default_rng(0))
    missed = cells[~seen(cells, scan, pose)]
    # Below -40 deg the floor is out of view, above 60 deg or within 1.5 m the ceiling: discs round the scanner, into
    # which the returns at their rims reach by 7 cm.
    height = pose[2, 3]
    floor = height / np.tan(np.radians(40)) - 0.07
    ceiling = max((2.5 - height) / np.tan(np.radians(60)), np.sqrt(max(1.5**2 - (2.5 - height) ** 2, 0))) - 0.07
    assert len(missed) * CELL**2 == pytest.approx(np.pi * (floor**2 + ceiling**2), rel=0.08)
    assert np.hypot(*(missed[:, :2] - pose[:2, 3]).T).max() < max(floor, ceiling) + 0.1


@pytest.fixture
def refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> object:
    """Runs a command line that must be refused: status 2 and one line on standard error. Gives the line."""

    def run(*arguments: str) -> str:
        try:
            status: object = main(["bench", "planners", "--out", str(tmp_path / "out"), *arguments])
        except SystemExit as exit:
            status = exit.code
        assert status == 2
        printed = capsys.readouterr()
        assert printed.out == ""
        assert printed.err.count("\n") == 1
        return printed.err

    return run


def test_what_cannot_be_used_is_refused_in_one_line(refused, tmp_path: Path) -> None:
    assert "nowhere.xml" in refused("--scene", "nowhere.xml")
    assert "'best'" in refused("--planner", "best")
    assert "did you mean 'travel_cost'" in refused("--set", "planning.travel_costs=1")
    assert "-1" in refused("--seed", "-1")


def test_a_scene_that_cannot_be_loaded_is_refused_in_one_line(tmp_path: Path, capsys) -> None:
    broken = tmp_path / "broken.xml"
    broken.write_text("<mujoco/>")
    assert main(["bench", "planners", "--scene", str(broken), "--jobs", "1", "--out", str(tmp_path)]) == 2
    assert "broken.xml" in capsys.readouterr().err.splitlines()[-1]


@pytest.mark.slow
def test_each_planner_explores_the_room_and_the_files_tell_of_it(two_rooms, tmp_path: Path) -> None:
    scene = two_rooms(WARDROBE)
    chosen = ["--planner", "nbs", "--planner", "grid", "--seed", "0", "--set", "planning.max_scans=2"]
    assert main(["bench", "planners", "--scene", str(scene), *chosen, "--jobs", "1", "--out", str(tmp_path)]) == 0
    result = json.loads((tmp_path / "result.json").read_text())
    nbs, grid = result["planners"]
    assert (nbs["planner"], nbs["scene"], nbs["rooms"], grid["planner"]) == ("nbs", "two_rooms.xml", 1, "grid")
    assert nbs["scans"] == 2 and nbs["metres"] > 0.4 and nbs["coverage"] > 0.95
    runs = json.loads((tmp_path / "runs.json").read_text())["runs"]
    # Both start at the same place; there the discs of the test above are missing, and what the wardrobe hides.
    assert runs[0]["coverage"][0] == runs[1]["coverage"][0] == pytest.approx(0.88, abs=0.03)
    assert "| two_rooms.xml | nbs |" in (tmp_path / "tables.md").read_text()
    assert (tmp_path / "coverage_two_rooms.png").is_file()
