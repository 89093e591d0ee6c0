"""One benchmark room through the detector, judged wall by wall against the joints."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np

from detector.detect import detect_wall
from detector.result import Door, Rectangle, WallResult
from detector.room import Wall
from mission.bench.walls.cache import cached_scan
from mission.bench.walls.glossy import NONE, HighlightCount, count_highlights
from mission.bench.walls.rooms import BenchRoom, BenchWall
from mission.bench.walls.rows import DoorRow, confidence_of, door_rows
from mission.bench.walls.scanning import judged_doors
from mission.config import MissionConfig
from mission.errors import MissionError
from mission.evaluation import SAME_DIRECTION, SAME_PLANE, doorway_on, evaluate
from mission.report import peak_memory
from sim.door_truth import DoorTruth

JPEG_QUALITY = 85


@dataclass(frozen=True, eq=False)
class WallPicture:
    """The merged orthoimage of a wall rectangle with what is true and what was found, small enough to hand round."""

    jpeg: bytes
    pixel_size: float
    """Of the image in it [m]."""
    width: float
    """[m]"""
    height: float
    """[m]"""
    true: tuple[Rectangle, ...]
    found: tuple[Rectangle, ...]
    labels: tuple[str, ...]
    """One for each of `found`."""


@dataclass(frozen=True, eq=False)
class WallJudgement:
    """What came out for one benchmark wall."""

    seed: int
    category: str
    wall: str
    rows: tuple[DoorRow, ...]
    """Its true doors from left to right, then false positives."""
    pictures: tuple[WallPicture, ...]
    """One for each rectangle that the mission found on the judged face; none if it found none."""
    stage_seconds: Mapping[str, float]
    """Wall clock time of each stage of the detector [s]."""
    area: float
    """Of these rectangles [m2]."""
    highlights: HighlightCount
    pose_error: float
    """Of the worst scan of the room [m]."""
    remark: str | None
    """What went wrong before the detector."""
    peak_bytes: int
    """Largest resident set of the process so far."""


def judge_room(room: BenchRoom, config: MissionConfig, *, seed: int, cache: Path) -> tuple[WallJudgement, ...]:
    """Scan a room, or take its scans from the cache, detect the doors of its judged walls, and compare.

    A room that the mission cannot make sense of counts: all its doors are missed.

    Raises:
        SimError: The room does not compile, or its doors are none.
        DetectorError: A wall is malformed.
        OSError: The cache cannot be written.
    """
    truths = judged_doors(room)
    try:
        scanned = cached_scan(room, config, seed=seed, folder=cache)
    except MissionError as error:
        return tuple(_judgement(wall, seed, truths, (), remark=str(error)) for wall in room.walls)
    given = scanned.room()
    gloss = tuple(scan.gloss for scan in scanned.scans)
    judgements = []
    for wall in room.walls:
        results = tuple(detect_wall(given, w, config.detector) for w in given.walls if is_on_face(w, wall))
        counts = [count_highlights(result, given, gloss, config.detector) for result in results]
        judgements.append(
            _judgement(
                wall,
                seed,
                truths,
                results,
                highlights=sum(counts, NONE),
                pose_error=float(scanned.pose_errors.max()),
                remark=None if results else "the mission found no wall here",
            )
        )
    return tuple(judgements)


def is_on_face(found: Wall, judged: BenchWall) -> bool:
    """Whether a wall that the mission found lies on a judged face, or is a part of it."""
    origin, end = np.array(judged.origin), np.array(judged.end)
    length = float(np.linalg.norm(end - origin))
    along = (end - origin) / length
    normal = np.cross(along, [0.0, 0.0, 1.0])
    left, right = (float((corner - origin) @ along) for corner in (found.origin, found.origin + found.width * found.u))
    common = min(right, length) - max(left, 0.0)
    middle = found.origin + found.width / 2 * found.u
    away = abs(float((middle - origin) @ normal))
    return bool(
        found.normal @ normal > SAME_DIRECTION and away < SAME_PLANE and common > 0.5 * min(found.width, length)
    )


def _judgement(
    wall: BenchWall,
    seed: int,
    truths: Mapping[frozenset[str], DoorTruth],
    results: Sequence[WallResult],
    *,
    highlights: HighlightCount = NONE,
    pose_error: float = float("nan"),
    remark: str | None = None,
) -> WallJudgement:
    doors = [(door, truths[frozenset(door.bodies)]) for door in wall.doors]
    face = np.array([wall.origin, wall.end])[:, :2]
    evaluations, _ = evaluate(results, [truth for _, truth in doors], room=1, outline=face)
    seconds: dict[str, float] = {}
    for stage, time in (pair for result in results for pair in result.stage_seconds):
        seconds[stage] = seconds.get(stage, 0.0) + time
    return WallJudgement(
        seed=seed,
        category=wall.category,
        wall=wall.name,
        rows=door_rows(wall, seed, doors, evaluations),
        pictures=tuple(_picture(result, [truth for _, truth in doors]) for result in results),
        stage_seconds=seconds,
        area=sum(result.wall.width * result.wall.height for result in results),
        highlights=highlights,
        pose_error=pose_error,
        remark=remark,
        peak_bytes=peak_memory(),
    )


def _picture(result: WallResult, truths: Sequence[DoorTruth]) -> WallPicture:
    colour = cv2.cvtColor(result.merged.colour, cv2.COLOR_RGB2BGR)  # OpenCV has blue first
    ok, jpeg = cv2.imencode(".jpg", colour, [cv2.IMWRITE_JPEG_QUALITY, JPEG_QUALITY])
    assert ok
    return WallPicture(
        jpeg=jpeg.tobytes(),
        pixel_size=result.merged.pixel_size,
        width=result.wall.width,
        height=result.wall.height,
        true=tuple(r for truth in truths if (r := doorway_on(result.wall, truth)) is not None),
        found=tuple(door.rectangle for door in result.doors),
        labels=tuple(_label(door) for door in result.doors),
    )


def _label(door: Door) -> str:
    opening = f" at {np.degrees(door.opening_angle):.1f} deg" if door.opening_angle > 0 else ""
    if door.opened_fraction > 0:
        opening = f", {door.opened_fraction:.0%} open"
    sure = confidence_of(door)
    return f"{door.kind}, {door.state}{opening}" + ("" if sure is None else f", {sure:.2f}")
