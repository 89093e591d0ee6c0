"""The small room, scanned once on the draft pattern."""

from __future__ import annotations

from pathlib import Path

import pytest
from small_room import small_room

from mission.bench.walls.cache import cached_scan
from mission.bench.walls.scanning import ScannedRoom
from mission.config import MissionConfig, read_config


@pytest.fixture(scope="session")
def draft() -> MissionConfig:
    """Coarse scans, small photographs."""
    return read_config(None, ["scanner.pattern=draft", "camera.width=356", "camera.height=536", "camera.shots=7"])


@pytest.fixture(scope="session")
def cache(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of scanned rooms."""
    return tmp_path_factory.mktemp("cache")


@pytest.fixture(scope="session")
def scanned(draft: MissionConfig, cache: Path) -> ScannedRoom:
    """The small room, fresh from the sensors; it is in the cache, too."""
    return cached_scan(small_room(), draft, seed=0, folder=cache)
