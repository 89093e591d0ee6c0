"""The robot with its sensors, switched on and off."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from mission.config import MissionConfig
from mission.mopad import Mopad
from sim.errors import SimError
from sim.render import Renderer
from sim.scene import Scene, load_scene

HALL = """
<mujoco>
  <worldbody>
    <geom type="plane" size="8 8 1"/>
    <geom type="box" pos="3 0 1.25" size="0.1 3 1.25"/>
    <site name="start"/>
  </worldbody>
</mujoco>"""


@pytest.fixture
def scene(tmp_path: Path) -> Scene:
    path = tmp_path / "hall.xml"
    path.write_text(HALL)
    return load_scene(path)


@pytest.fixture
def opened(monkeypatch: pytest.MonkeyPatch) -> list[Renderer]:
    """The renderers that were made and not closed."""
    renderers: list[Renderer] = []

    class Counted(Renderer):
        def __init__(self, *args: Any, **kwargs: Any) -> None:
            super().__init__(*args, **kwargs)
            renderers.append(self)

        def close(self) -> None:
            super().close()
            renderers.remove(self)

    monkeypatch.setattr("mission.mopad.Renderer", Counted)
    return renderers


def test_switched_off_it_gives_its_renderer_back(scene: Scene, opened: list[Renderer]) -> None:
    with Mopad(scene, MissionConfig(), seed=0):
        assert len(opened) == 1
    assert opened == []


@pytest.mark.parametrize("part", ["Camera", "Hokuyo", "Robot"])
def test_whatever_part_fails_the_renderer_is_closed(
    scene: Scene, opened: list[Renderer], monkeypatch: pytest.MonkeyPatch, part: str
) -> None:
    def fail(*_: Any, **__: Any) -> None:
        raise SimError(f"{part} is broken")

    monkeypatch.setattr(f"mission.mopad.{part}", fail)
    with pytest.raises(SimError, match=part):
        Mopad(scene, MissionConfig(), seed=0)
    assert opened == []
