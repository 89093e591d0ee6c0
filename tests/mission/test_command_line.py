"""The command line: what is said and returned when something is wrong, before anything has begun."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from mission.__main__ import EXAMPLES, main, parser
from mission.scene_file import find_scene
from sim.scene import load_scene

ROOM = """
<mujoco>
  <worldbody>
    <geom type="plane" size="0 0 1"/>
    <geom type="box" pos="0 2.5 1.3" size="3 0.1 1.3"/>
    <geom type="box" pos="0 -2.5 1.3" size="3 0.1 1.3"/>
    <geom type="box" pos="3 0 1.3" size="0.1 2.6 1.3"/>
    <geom type="box" pos="-3 0 1.3" size="0.1 2.6 1.3"/>
    {inside}
  </worldbody>
</mujoco>
"""


@pytest.fixture
def refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> object:
    """Runs a command line that must be refused: status 2, one line on standard error, nothing else. Gives the line."""

    def run(*arguments: str) -> str:
        assert main(["run", *arguments, "--out", str(tmp_path / "out")]) == 2
        printed = capsys.readouterr()
        assert printed.out == ""
        assert printed.err.count("\n") == 1
        assert printed.err.startswith("error: ")
        return printed.err

    return run


@pytest.fixture
def scene(tmp_path: Path) -> object:
    """Writes a scene file."""

    def write(text: str) -> str:
        path = tmp_path / "scene.xml"
        path.write_text(text)
        return str(path)

    return write


def test_a_scene_that_does_not_exist_is_named_with_those_that_do(refused) -> None:
    line = refused("nowhere.xml")
    assert "nowhere.xml" in line
    assert "room.xml" in line


@pytest.mark.parametrize("text", ["1", "1,x", "1,2,3,4", "1,2,-3", "1,nan", ""])
def test_an_obstacle_that_is_no_place_is_refused(refused, text: str) -> None:
    assert "X,Y" in refused("room.xml", f"--obstacle={text}")


def test_an_obstacle_in_a_wall_is_refused(refused) -> None:
    assert "(3.25, -1.50)" in refused("room.xml", "--obstacle=3.25,-1.5")


def test_a_planner_that_there_is_not_is_refused_with_those_there_are(capsys) -> None:
    with pytest.raises(SystemExit) as exit:
        main(["run", "room.xml", "--planner", "best"])
    assert exit.value.code == 2
    assert "frontier" in capsys.readouterr().err


def test_a_scene_that_is_not_xml_is_refused(refused, scene) -> None:
    assert "scene.xml" in refused(scene("not xml at all"))


def test_a_scene_that_does_not_compile_is_refused(refused, scene) -> None:
    line = refused(scene(ROOM.format(inside='<geom type="box" size="1 1 1" material="absent"/>')))
    assert "absent" in line


def test_a_scene_without_a_floor_is_refused(refused, scene) -> None:
    line = refused(scene(ROOM.format(inside='<site name="start"/>').replace('<geom type="plane" size="0 0 1"/>', "")))
    assert "floor" in line


def test_a_scene_without_walls_is_refused(refused, scene) -> None:
    line = refused(scene('<mujoco><worldbody><geom type="plane" size="0 0 1"/></worldbody></mujoco>'))
    assert "wall" in line


def test_a_start_inside_furniture_is_refused(refused, scene) -> None:
    inside = '<site name="start"/><geom name="sofa" type="box" pos="0.2 0 0.4" size="0.5 0.5 0.4"/>'
    assert "sofa" in refused(scene(ROOM.format(inside=inside)))


def test_an_unknown_door_is_named_with_those_that_exist(refused) -> None:
    line = refused("room.xml", "--door", "gate=30")
    assert "gate" in line
    assert "study_door" in line


def test_an_angle_outside_the_doors_range_is_refused_with_the_range(refused) -> None:
    line = refused("room.xml", "--door", "study_door=179")
    assert "study_door" in line
    assert "179" in line


def test_a_door_setting_that_is_no_number_is_refused(refused) -> None:
    assert "--door study_door=wide" in refused("room.xml", "--door", "study_door=wide")


def test_an_unknown_configuration_key_is_refused(refused) -> None:
    assert "detector.alfa1" in refused("room.xml", "--set", "detector.alfa1=0.4")


def test_a_parameter_out_of_bounds_is_refused_with_the_bound(refused) -> None:
    line = refused("room.xml", "--set", "scanner.max_range=0.5")
    assert "scanner.max_range = 0.5: input should be greater than or equal to 10" in line


def test_an_unknown_metric_is_refused(refused) -> None:
    assert "known: recall, precision" in refused("room.xml", "--fail-under", "beauty=1")


def test_an_unknown_keyframe_is_refused(refused) -> None:
    assert "dawn" in refused("room.xml", "--keyframe", "dawn")


def test_an_output_folder_that_cannot_be_made_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "file").write_text("in the way")
    assert main(["run", "room.xml", "--out", str(tmp_path / "file" / "out")]) == 2
    assert "cannot write the results" in capsys.readouterr().err


@pytest.mark.parametrize("wrong", [("--speed", "3"), ("--seed", "abc"), ("--seed", "-1"), ("--max-scans", "0")])
def test_a_wrong_option_is_said_in_one_line(wrong: tuple[str, str], capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as caught:
        main(["run", "room.xml", *wrong])
    assert caught.value.code == 2
    said = capsys.readouterr().err
    assert said.startswith("error: ")
    assert said.count("\n") == 1
    assert wrong[0] in said


def test_every_example_of_the_help_parses_and_names_doors_that_exist() -> None:
    examples = [line.split(" > ")[0].split() for line in EXAMPLES.splitlines() if "-m mission" in line]
    assert len(examples) >= 4
    for words in examples:
        options = parser().parse_args(words[words.index("mission") + 1 :])
        if options.scene == "room.xml":
            angles = dict.fromkeys((door.split("=")[0] for door in options.door), 0.5)
            load_scene(find_scene(options.scene), door_angles=angles)


def test_help_shows_real_command_lines_and_imports_nothing_heavy() -> None:
    code = (
        "import sys; from mission.__main__ import parser; print(parser().format_help());"
        "print([m for m in ('mujoco', 'numpy', 'cv2', 'rerun', 'sklearn', 'scipy', 'rich') if m in sys.modules])"
    )
    printed = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert "python -m mission run room.xml" in printed
    assert printed.rstrip().endswith("[]")
