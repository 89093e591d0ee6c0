"""Scanned rooms on disk, by content: a change of the detector is measured without scanning again."""

from __future__ import annotations

import hashlib
import json
import logging
import os
import zipfile
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any
from uuid import uuid4

import numpy as np

from detector.room import Wall
from mission.bench.walls import scanning
from mission.bench.walls.scanning import JudgedScan, ScannedRoom, scan_room, scanner_mount
from mission.bench.walls.sources import source_digest

if TYPE_CHECKING:
    from mission.bench.walls.rooms import BenchRoom
    from mission.config import MissionConfig

logger = logging.getLogger(__name__)

PACKAGES = ("mujoco", "numpy", "opencv-python-headless", "scipy")
"""Whose version may change a scan."""
CAPACITY = 20e9
"""The rooms unused for longest are deleted beyond this [bytes]; the 27 walls of a seed take about 2e9."""

_SCAN = ("elevations", "azimuths", "ranges", "world_from_scanner", "camera_in_world", "colours", "gloss")
_MASKS = ("coloured",)
_WALL = ("origin", "u", "v", "width", "height", "voxel_labels", "voxel_size")


def default_folder() -> Path:
    """Where scanned rooms are kept unless told otherwise."""
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "door-mission"


def cached_scan(room: BenchRoom, config: MissionConfig, *, seed: int, folder: Path) -> ScannedRoom:
    """The scanned room, from the cache if it is there, else into it.

    Raises:
        MissionError, SimError: As `scan_room`.
        OSError: The cache cannot be written.
    """
    path = folder / f"{fingerprint(room, config, seed=seed)}.npz"
    try:
        scanned = read(path)
        path.touch()  # used just now
        return scanned
    except FileNotFoundError:
        pass
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile) as error:
        logger.warning("%s cannot be read (%s): the room is scanned again", path, error)
    scanned = scan_room(room, config, seed=seed)
    write(path, scanned)
    _make_room(folder)
    return scanned


def fingerprint(room: BenchRoom, config: MissionConfig, *, seed: int) -> str:
    """Of everything that a scanned room depends on: the room, the seed, parameters, our source text, packages."""
    digest = hashlib.sha256()
    parameters = config.model_dump(mode="json", include=set(scanning.STAGES))
    versions = [version(package) for package in PACKAGES]
    facts = [room.name, room.xml, room.scan_places, seed, parameters, versions, scanner_mount().tolist()]
    digest.update(json.dumps(facts, sort_keys=True).encode())
    for name, content in sorted(room.assets.items()):
        digest.update(f"{name} {len(content)} ".encode())
        digest.update(content)
    digest.update(source_digest(scanning.__name__).encode())
    return digest.hexdigest()


def write(path: Path, scanned: ScannedRoom) -> None:
    """Write a room in one step: a reader sees all of it or nothing. Noise does not compress, so nothing is."""
    arrays: dict[str, Any] = {
        "floor_height": scanned.floor_height,
        "ceiling_height": np.nan if scanned.ceiling_height is None else scanned.ceiling_height,
        "pose_errors": scanned.pose_errors,
        "walls": len(scanned.walls),
    }
    for number, scan in enumerate(scanned.scans):
        arrays |= {f"scan/{number}/{name}": getattr(scan, name) for name in _SCAN}
        arrays |= {f"scan/{number}/{name}": np.packbits(getattr(scan, name)) for name in _MASKS}
    for number, wall in enumerate(scanned.walls):
        arrays |= {f"wall/{number}/{name}": getattr(wall, name) for name in _WALL}
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_name(f".{path.stem}-{uuid4().hex}.part")
    try:
        with part.open("wb") as file:
            np.savez(file, **arrays)
        part.replace(path)
    finally:
        part.unlink(missing_ok=True)


def read(path: Path) -> ScannedRoom:
    """Read a room that `write` wrote.

    Raises:
        OSError, ValueError, KeyError, EOFError, BadZipFile: It is not there, or not whole.
    """
    with np.load(path, allow_pickle=False) as arrays:
        ceiling = float(arrays["ceiling_height"])
        return ScannedRoom(
            scans=tuple(_read_scan(arrays, f"scan/{number}") for number in range(len(arrays["pose_errors"]))),
            walls=tuple(_read_wall(arrays, f"wall/{number}") for number in range(int(arrays["walls"]))),
            floor_height=float(arrays["floor_height"]),
            ceiling_height=None if np.isnan(ceiling) else ceiling,
            pose_errors=arrays["pose_errors"],
        )


def _read_scan(arrays: Any, key: str) -> JudgedScan:
    plain = {name: arrays[f"{key}/{name}"] for name in _SCAN}
    count = len(plain["colours"])
    masks = {name: np.unpackbits(arrays[f"{key}/{name}"], count=count).astype(bool) for name in _MASKS}
    return JudgedScan(**plain, **masks)


def _read_wall(arrays: Any, key: str) -> Wall:
    fields: dict[str, Any] = {name: arrays[f"{key}/{name}"][()] for name in _WALL}  # [()] makes a number of 0 axes
    return Wall(**fields)


def _make_room(folder: Path) -> None:
    """Delete what was unused for longest; another worker may do the same at the same time."""
    files = []
    for path in folder.glob("*.npz"):
        try:
            files.append((path.stat().st_mtime, path.stat().st_size, path))
        except FileNotFoundError:
            continue
    total = 0.0
    for _, size, path in sorted(files, reverse=True):
        total += size
        if total > CAPACITY:
            path.unlink(missing_ok=True)
