"""The scene file that a user names."""

from __future__ import annotations

import difflib
from pathlib import Path

import assets
from mission.errors import UsageError


def find_scene(scene: str) -> Path:
    """The scene file: a path, or else a name in assets/rooms/.

    Raises:
        UsageError: There is no such file.
    """
    rooms = assets.FOLDER / "rooms"
    for path in (Path(scene), rooms / scene):
        if path.is_file():
            return path
    if scene and Path(scene).is_dir():
        raise UsageError(f"the scene is a folder, not an MJCF file: {scene}")
    shipped = sorted(path.name for path in rooms.glob("*.xml"))
    close = difflib.get_close_matches(scene, shipped, n=1)
    hint = f"did you mean {close[0]}?" if close else f"shipped scenes: {', '.join(shipped)}"
    raise UsageError(f"no such scene: {scene!r} ({hint})")
