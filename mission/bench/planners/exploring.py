"""One planner in one room: the mission's own stages from scan to scan, without photographs and doors."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mission.bench.planners.truth import seen
from mission.config import MissionConfig
from mission.driving import Drive, drive
from mission.errors import MissionError
from mission.explored_room import ExploredRoom
from mission.grid import Footprint
from mission.localisation import localise
from mission.mission import MAX_DETOURS, NO_ARRIVAL
from mission.mopad import Mopad
from mission.planning import Plan
from mission.registration import Registrar
from mission.rigid import Pose, inverted
from mission.samples import place, sample_scan
from mission.structure import Structure
from sim.scene import load_scene


@dataclass(frozen=True)
class Exploration:
    """What a planner made of a room."""

    scene: str
    room: int
    planner: str
    seed: int
    coverage: tuple[float, ...]
    """After each scan: share of the visible structure that was seen."""
    metres: tuple[float, ...]
    """Driven before each scan, in all [m]."""
    stop_reason: str

    def scans_to(self, coverage: float) -> int | None:
        """How many scans it took to see so much; None if it never did."""
        return next((k + 1 for k, share in enumerate(self.coverage) if share >= coverage - 1e-9), None)


def explore(
    path: Path, number: int, world_from_base: Pose, cells: NDArray[np.float64], config: MissionConfig, *, seed: int
) -> Exploration:
    """Scan a room from place to place until the planner of the configuration stops.

    Args:
        path: Scene.
        number: Of the room.
        world_from_base: (4, 4) where the robot starts.
        cells: (C, 3) the room's visible structure, for the coverage [m].
        config: Of all stages.
        seed: Of all noise, and of choices by chance.

    Raises:
        SimError: The scene cannot be loaded.
    """
    scene = load_scene(path)
    with Mopad(scene, config, seed=seed) as mopad:
        mopad.robot.set_down(world_from_base)
        explorer = _Explorer(mopad, config, cells, seed=seed)
        try:
            reason = explorer.run()
        except MissionError as error:  # such as no walls: what was seen until then counts
            reason = str(error)
    return Exploration(
        scene=path.name,
        room=number,
        planner=config.planning.planner,
        seed=seed,
        coverage=tuple(explorer.coverage),
        metres=tuple(explorer.metres),
        stop_reason=reason,
    )


@dataclass
class _Explorer:
    """A robot in a room, and the truth about what it has seen."""

    mopad: Mopad
    config: MissionConfig
    cells: NDArray[np.float64]
    seed: int = field(kw_only=True)
    coverage: list[float] = field(default_factory=list)
    metres: list[float] = field(default_factory=list)

    def __post_init__(self) -> None:
        self._room = ExploredRoom(1, Footprint(*self.mopad.robot.footprint), self.config)
        self._registrar = Registrar(self.config.registration)
        self._seen = np.zeros(len(self.cells), bool)
        self._driven = 0.0

    def run(self) -> str:
        """Go on until the room is done; gives the reason to stop."""
        while True:
            self._scan()
            structure = self._room.structure()
            reason = self._move_on(structure)
            if reason is not None:
                return reason

    def _scan(self) -> None:
        mopad, room = self.mopad, self._room
        truth = mopad.true_world_from_scanner
        scan = mopad.scan()
        self._seen |= seen(self.cells, scan, truth)
        self.coverage.append(float(self._seen.mean()))
        self.metres.append(self._driven)
        guess = mopad.world_from_base @ mopad.robot.base_from_scanner
        sample = sample_scan(scan, self.config.samples)
        found = self._registrar.register(sample, guess)
        if not found.accepted:
            room.rejected_in_world.append(guess[:3, 3])
            return
        mopad.believe(found.world_from_scanner @ inverted(mopad.robot.base_from_scanner))
        self._look_around()
        room.samples.append(place(sample, found.world_from_scanner))

    def _move_on(self, structure: Structure) -> str | None:
        """Plan and drive; gives the reason to stop, None when the robot stands where it is to scan next."""
        voxels = self._room.voxels(structure)
        for attempt in range(MAX_DETOURS):
            plan = self._room.plan(
                structure,
                voxels,
                self._room.grid(structure),
                world_from_base=self.mopad.world_from_base,
                base_from_scanner=self.mopad.robot.base_from_scanner,
                seed=(self.seed, len(self.coverage), attempt),
            )
            if plan.path is None:
                return plan.stop_reason
            if self._drive(plan, structure.floor_height).arrived:
                return None
        return NO_ARRIVAL

    def _drive(self, plan: Plan, floor_height: float) -> Drive:
        mopad, room, navigation = self.mopad, self._room, self.config.navigation
        assert plan.path is not None
        track: list[NDArray[np.float64]] = []
        laser_map = room.laser_map(floor_height + mopad.robot.base_from_lasers[0][2, 3])
        leg = drive(
            mopad.robot,
            plan.path,
            mopad.measure_lasers,
            world_from_odometry=mopad.world_from_odometry,
            footprint=room.footprint,
            parameters=navigation.driving,
            localise=partial(localise, laser_map, parameters=navigation.localisation),
            watch=lambda: track.append(mopad.robot.true_world_from_base[:2, 3]),
        )
        self._driven += float(np.hypot(*np.diff(track, axis=0).T).sum())
        mopad.believe(leg.world_from_base[-1])
        if not leg.arrived:
            room.lasers += zip(leg.laser_scans, leg.world_from_base_at_laser, strict=True)
            self._look_around()
        return leg

    def _look_around(self) -> None:
        world_from_base = self.mopad.world_from_base
        self._room.robot_poses.append(world_from_base)
        self._room.lasers += [(scan, world_from_base) for scan in self.mopad.measure_lasers()]
