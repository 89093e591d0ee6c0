"""Beams per second of a full panorama, and how far each method's ranges are from exact rays."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mission.bench.speed import rivals
from mission.bench.speed.floor import render_panorama
from mission.bench.speed.timing import Timing, in_turns
from mission.bench.speed.worlds import World
from sim.beams import directions
from sim.echo import MIN_RANGE
from sim.scanner import PATTERNS, Pattern, Scanner, ScannerParameters

PATTERN = "panorama_60"
SAMPLED = 100
"""Of the slow methods' beams, one in so many is cast: their time does not depend on how many there are."""
CHECKED = 20_000
"""Beams that are compared with exact rays."""
OURS, FLOOR = "door-mission", "six bare depth renders"
EMBREE, MULTI_RAY, MUJOCO_LIDAR = "Open3D RaycastingScene", "mj_multiRay", "mujoco-lidar, CPU"


@dataclass(frozen=True)
class Caster:
    """One method in one world."""

    name: str
    timing: Timing
    """Of all beams of a panorama."""
    beams: int
    within_50_um: float | None
    """Share of the beams whose range is that of an exact ray; None where it has no ranges, or they are exact."""
    beyond_1_cm: int | None
    """Beams of 10 000 that are off by more; likewise."""

    @property
    def beams_per_second(self) -> float:
        """[1/s]"""
        return self.beams / self.timing.median


def compare_casters(world: World, repeats: int) -> list[Caster]:
    """Every method that is installed, the floor and ours first."""
    pattern = PATTERNS[PATTERN]
    elevations, azimuths = (
        grid.ravel() for grid in np.meshgrid(pattern.elevations(), pattern.azimuths(), indexing="ij")
    )
    few = np.random.default_rng(0).choice(len(elevations), len(elevations) // SAMPLED, replace=False)
    beams, turn = directions(elevations[few], azimuths[few]), world.world_from_scanner[:3, :3]
    slow: dict[str, Callable[[], object]] = {MULTI_RAY: rivals.multi_ray(world, beams @ turn.T)}
    if rivals.has_mujoco_lidar():
        slow[MUJOCO_LIDAR] = rivals.mujoco_lidar(world, elevations[few], azimuths[few])
    fast: dict[str, Callable[[], object]] = {FLOOR: lambda: render_panorama(world, pattern), OURS: _scan(world)}
    if rivals.has_open3d():
        rays = (directions(elevations, azimuths) @ turn.T).astype(np.float32)
        tried = {chunk: rivals.embree(world, rays, chunk) for chunk in rivals.CHUNKS}
        times = in_turns({str(chunk): cast for chunk, cast in tried.items()}, 1)
        fast[EMBREE] = tried[min(tried, key=lambda chunk: times[str(chunk)].median)]
    timings = in_turns({**fast, **slow}, repeats)
    errors = _errors(world, pattern)
    casters = []
    for name, timing in timings.items():
        within, beyond = errors.get(name, (None, None))
        whole = timing.scaled(SAMPLED) if name in slow else timing
        casters.append(Caster(name, whole, len(elevations), within, beyond))
    return casters


def _scan(world: World) -> Callable[[], object]:
    scanner = Scanner(world.model, ScannerParameters(pattern=PATTERN), hidden_bodies=world.hidden_bodies)
    return lambda: scanner.scan(world.data, world.world_from_scanner, np.random.default_rng(0))


def _errors(world: World, pattern: Pattern) -> dict[str, tuple[float, int]]:
    """Ours and Open3D's ranges on random beams beside those of exact rays."""
    rng = np.random.default_rng(1)
    rows, columns = rng.integers(pattern.rows, size=CHECKED), rng.integers(pattern.columns, size=CHECKED)
    beams = directions(pattern.elevations()[rows], pattern.azimuths()[columns]) @ world.world_from_scanner[:3, :3].T
    true, _ = rivals.multi_ray(world, beams)()
    parameters = ScannerParameters(pattern=PATTERN, noise=False)
    scanner = Scanner(world.model, parameters, hidden_bodies=world.hidden_bodies)
    scan = scanner.scan(world.data, world.world_from_scanner, np.random.default_rng(0))
    errors = {OURS: _judge(scan.ranges[rows, columns], true)}
    if rivals.has_open3d():
        errors[EMBREE] = _judge(rivals.embree(world, beams, len(beams))()[0], true)
    return errors


def _judge(ranges: NDArray[np.floating], true: NDArray[np.floating]) -> tuple[float, int]:
    """Shares of the beams that an exact ray has a return of within the scanner's reach; a beam without one is off."""
    measurable = np.isfinite(true) & (true > MIN_RANGE)
    off = np.abs(np.where(np.isfinite(ranges), ranges, np.inf)[measurable] - true[measurable])
    return float((off < 5e-5).mean()), int(round((off > 0.01).mean() * 10_000))
