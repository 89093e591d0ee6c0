"""The speed benchmark: what is compared is the same work, and what is reported is what was measured."""

from __future__ import annotations

import json
from pathlib import Path

import mujoco
import numpy as np
import pytest

from mission.__main__ import main
from mission.bench.speed import command, rivals
from mission.bench.speed.beams import OURS, Caster
from mission.bench.speed.missions import MissionTime
from mission.bench.speed.report import SpeedReport, write_report
from mission.bench.speed.timing import Timing, growth_exponent, in_turns
from mission.bench.speed.worlds import World, cluttered_world, cluttered_xml
from mission.bench_arguments import SPEED_PARTS


def test_contenders_take_turns_and_the_first_turn_does_not_count() -> None:
    calls: list[str] = []
    timings = in_turns({"a": lambda: calls.append("a"), "b": lambda: calls.append("b")}, repeats=2)
    assert calls == ["a", "b"] * 3
    assert [len(timing.seconds) for timing in timings.values()] == [2, 2]


def test_a_median_and_its_spread_are_those_of_the_numbers() -> None:
    # quartiles 2 and 4 lie 1 to either side of 3
    timing = Timing((5.0, 1.0, 3.0, 2.0, 4.0))
    assert (timing.median, timing.spread) == pytest.approx((3.0, 1 / 3))
    assert timing.scaled(100).median == pytest.approx(300)


def test_time_that_doubles_with_size_grows_with_its_first_power() -> None:
    assert growth_exponent([1, 2, 4], [3, 6, 12]) == pytest.approx(1.0)
    assert growth_exponent([1, 2, 4], [3, 12, 48]) == pytest.approx(2.0)


def test_the_cluttered_hall_has_200_meshes_of_1000_triangles_and_room_in_its_middle() -> None:
    model = mujoco.MjModel.from_xml_string(cluttered_xml())
    assert (model.nmesh, model.nmeshface) == (200, 200_000)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    boulders = data.geom_xpos[model.geom_type == mujoco.mjtGeom.mjGEOM_MESH]
    # radius up to 0.35 m and 12 % more; the scanner's nearest range is 1.5 m, but a boulder is no reason to fail
    assert np.hypot(*boulders[:, :2].T).min() > 1.2


@pytest.mark.slow
def test_all_rivals_measure_the_same_ranges_and_geoms() -> None:
    rng = np.random.default_rng(0)
    elevations, azimuths = rng.uniform(-0.6, 1.0, 500), rng.uniform(0, 2 * np.pi, 500)
    level = np.cos(elevations)
    beams = np.stack([level * np.cos(azimuths), level * np.sin(azimuths), np.sin(elevations)], axis=1)
    with cluttered_world() as world:
        true, geoms = rivals.multi_ray(world, beams)()
        ranges, met = rivals.embree(world, beams, 128)()
    assert (np.abs(ranges - true) < 1e-4).mean() > 0.99
    assert (met == geoms).mean() > 0.99


def test_what_the_sensors_do_not_see_no_rival_sees(world: World) -> None:
    # the robot's ball stands 1 m before a wall 3 m away: the ray meets the wall's face at 2.9 m
    beam = np.array([[1.0, 0.0, 0.0]])
    assert rivals.multi_ray(world, beam)()[0] == pytest.approx([2.9])
    assert rivals.embree(world, beam, 1)()[0] == pytest.approx([2.9])


@pytest.fixture
def world() -> World:
    model = mujoco.MjModel.from_xml_string(
        '<mujoco><worldbody><geom type="box" pos="3 0 0" size="0.1 2 2"/><body name="robot" pos="1 0 0">'
        '<geom type="sphere" size="0.2"/></body></worldbody></mujoco>'
    )
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    hidden = frozenset({int(model.body("robot").id)})
    return World("ball", model, data, None, np.eye(4), hidden)  # type: ignore[arg-type]  # rays need no renderer


@pytest.fixture
def report() -> SpeedReport:
    slow, fast = Timing((8.0, 8.0, 8.0)), Timing((2.0, 2.0, 2.0))
    casters = [Caster(OURS, fast, 10_000_000, 0.995, 1), Caster("rays", slow, 10_000_000, None, None)]
    mission = MissionTime("room.xml", "draft", 30.0, {"scan": 12.0}, ((1, 3, 20.0), (2, 2, 10.0)), 10**9, 15.0)
    return SpeedReport(3, {"hall": casters}, missions=[mission], start_up={"--help": Timing((0.2,))})


def test_tables_and_result_tell_what_was_measured(report: SpeedReport, tmp_path: Path) -> None:
    write_report(tmp_path, report)
    result = json.loads((tmp_path / "result.json").read_text())
    assert result["scans"]["hall"][OURS]["beams_per_second"] == 5e6
    assert result["mission_over_floor"] == 2.0 and result["help_s"] == 0.2 and result["peak_bytes"] == 10**9
    assert result["scan_vs_embree_cluttered"] is None and result["detector_exponent"] is None, "not measured"
    text = (tmp_path / "tables.md").read_text()
    assert "| rays | hall | 8.00 | +-0% | 1.25 | 4.00 x |" in text, "ours is four times as fast"
    assert "| room.xml, draft | 30.0 | 2.00 x bare renders | 1.00 GB |" in text
    assert "|   scan | 12.0 | 40% |" in text and "5.0 s a scan" in text
    assert (tmp_path / "scans.png").stat().st_size > 1000


def test_parts_are_named_alike_in_help_and_command() -> None:
    assert SPEED_PARTS == command.PARTS == tuple(command.parts(SpeedReport(1)))


def test_a_part_that_there_is_not_is_refused_in_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as refused:
        main(["bench", "speed", "--part", "nonsense"])
    assert refused.value.code == 2 and capsys.readouterr().err.count("\n") == 1
