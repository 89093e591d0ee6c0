"""Time of the detector: over the number of views, over the area of wall, and stage by stage."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from detector.detect import detect_wall
from detector.parameters import DetectorParameters
from detector.room import Room, View, Wall
from mission.bench.speed.timing import Timing, growth_exponent, in_turns
from mission.bench.speed.worlds import World
from mission.colouring import colour_scan
from mission.config import MissionConfig
from mission.rigid import Pose
from mission.samples import place, sample_scan
from mission.structure import find_structure
from mission.voxels import label_voxels, room_from
from sim.camera import Camera
from sim.scanner import Scanner

VIEWS = (1, 2, 4, 8)
SHARES = (0.25, 0.5, 1.0)
"""Parts of the wall's width that are searched."""
RING = 0.15
"""Views are taken on a ring of this radius round the robot's start, so that all see the same [m]."""


@dataclass(frozen=True)
class DetectorTimes:
    """The detector on the largest wall of a scene."""

    area: float
    """Of the wall [m2]."""
    by_views: dict[int, Timing]
    by_area: dict[float, Timing]
    """With two views; by area [m2]."""
    stages: dict[str, float]
    """Median seconds of each stage with four views."""

    @property
    def views_exponent(self) -> float:
        """Of the growth of time with views."""
        return growth_exponent(list(self.by_views), [timing.median for timing in self.by_views.values()])

    @property
    def area_exponent(self) -> float:
        """Of the growth of time with area."""
        return growth_exponent(list(self.by_area), [timing.median for timing in self.by_area.values()])


def time_detector(world: World, repeats: int) -> DetectorTimes:
    """Scan and photograph the world from eight places, and search its largest wall."""
    room = _scanned(world)
    wall = max(room.walls, key=lambda wall: wall.width * wall.height)
    parameters = DetectorParameters()
    stages: dict[str, list[float]] = defaultdict(list)

    def detect(views: int, width: float) -> None:
        searched = replace(room, views=room.views[:views], walls=(_cut(wall, width),))
        result = detect_wall(searched, searched.walls[0], parameters)
        if views == 4:
            for stage, seconds in result.stage_seconds:
                stages[stage].append(seconds)

    by_views = in_turns({str(views): partial(detect, views, wall.width) for views in VIEWS}, repeats)
    by_area = in_turns({str(share): partial(detect, 2, share * wall.width) for share in SHARES}, repeats)
    area = wall.width * wall.height
    return DetectorTimes(
        area=area,
        by_views={int(views): timing for views, timing in by_views.items()},
        by_area={float(share) * area: timing for share, timing in by_area.items()},
        stages={stage: float(np.median(seconds)) for stage, seconds in stages.items()},
    )


def _cut(wall: Wall, width: float) -> Wall:
    """The left part of a wall."""
    columns = int(np.ceil(width / wall.voxel_size - 1e-9))
    return replace(wall, width=width, voxel_labels=wall.voxel_labels[:, :columns])


def _scanned(world: World) -> Room:
    """The world as the mission hands it to the detector, by true poses."""
    config = MissionConfig()
    scanner = Scanner(world.model, config.scanner, hidden_bodies=world.hidden_bodies)
    camera = Camera(world.renderer, config.camera)
    views: list[View] = []
    samples = []
    for pose in _ring(world.world_from_scanner, max(VIEWS)):
        scan = scanner.scan(world.data, pose, np.random.default_rng(len(views)))
        photos = camera.photograph(world.data, pose, np.random.default_rng(len(views)))
        samples.append(place(sample_scan(scan, config.samples), pose))
        views.append(colour_scan(scan, photos, pose))
    structure = find_structure(samples, config.structure, scanner=config.scanner)
    voxels = label_voxels(structure, samples, config.voxels, scanner=config.scanner)
    return room_from(structure, voxels, views)


def _ring(world_from_scanner: Pose, count: int) -> Sequence[Pose]:
    poses = []
    for angle in np.arange(count) * 2 * np.pi / count:
        pose = world_from_scanner.copy()
        pose[:2, 3] += RING * np.array([np.cos(angle), np.sin(angle)])
        poses.append(pose)
    return poses
