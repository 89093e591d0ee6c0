"""The house: which way the arrows point, and what the wheel carries."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
import zipfile
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
MUJOCO = {"mujoco"}
"""What benchmarks may import beside the simulator: they generate scenes and judge by their truth."""


def imports(path: Path) -> Iterator[str]:
    """Top names of all modules that a file imports, anywhere in it, type checking apart."""
    tree = ast.parse(path.read_text())
    guarded = {
        node
        for block in ast.walk(tree)
        if isinstance(block, ast.If) and ast.unparse(block.test) == "TYPE_CHECKING"
        for node in ast.walk(block)
    }
    for node in ast.walk(tree):
        if node in guarded:
            continue
        if isinstance(node, ast.Import):
            yield from (alias.name.split(".")[0] for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            yield node.module.split(".")[0]


@pytest.mark.parametrize(
    ("folder", "banned"),
    [
        ("sim", {"mission", "detector", "rerun", "foxglove", "mcap"}),
        ("detector", {"mission", "sim", "mujoco", "rerun", "foxglove", "mcap", "pathlib", "json"}),
        ("mission", {"mujoco"}),
    ],
)
def test_the_arrows_point_one_way(folder: str, banned: set[str]) -> None:
    files = sorted((ROOT / folder).rglob("*.py"))
    assert files
    crossed = {str(path.relative_to(ROOT)): hits for path in files if (hits := banned & set(imports(path)))}
    crossed = {path: hits for path, hits in crossed.items() if not path.startswith("mission/bench/") or hits != MUJOCO}
    assert crossed == {}


def test_only_the_recording_package_knows_a_log_format() -> None:
    files = [path for path in (ROOT / "mission").rglob("*.py") if "recording" not in path.parts]
    assert [path.name for path in files if {"rerun", "foxglove", "mcap"} & set(imports(path))] == []


@pytest.mark.slow
def test_the_wheel_carries_its_assets_and_works_from_any_folder(tmp_path: Path) -> None:
    build = [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "--wheel-dir", str(tmp_path), str(ROOT)]
    subprocess.run(build, check=True)
    (wheel,) = tmp_path.glob("*.whl")
    unpacked = tmp_path / "unpacked"
    zipfile.ZipFile(wheel).extractall(unpacked)
    for asset in (ROOT / "assets").rglob("*"):
        if asset.is_file() and "__pycache__" not in asset.parts:
            assert (unpacked / asset.relative_to(ROOT)).is_file(), asset
    command = [sys.executable, "-c", f"import sys; sys.path.insert(0, {str(unpacked)!r}); sys.path.remove('')\n"
               "import assets; from mission.__main__ import main\n"
               f"assert str(assets.FOLDER).startswith({str(unpacked)!r})\n"
               "sys.exit(main(['run', 'room.xml', '--door', 'nobody=1']))"]  # fmt: skip
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 2
    assert "study_door" in done.stderr


def test_the_pictures_of_the_readme_are_there_and_small() -> None:
    pictures = re.findall(r"\]\((assets/[^)]+)\)", (ROOT / "README.md").read_text())
    assert len(set(pictures)) >= 3
    assert all((ROOT / picture).stat().st_size < 400_000 for picture in pictures)
