"""One planner in one room: the mission's own stages from scan to scan, without photographs and doors."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mission.bench.planners.truth import seen
from mission.config import MissionConfig
from mission.errors import MissionError
from mission.events import Drove, Planned, Scanned
from mission.explored_room import ExploredRoom
from mission.grid import Footprint
from mission.mopad import Mopad
from mission.registration import Registrar
from mission.rigid import Pose
from mission.stopwatch import Stopwatch
from mission.surveyor import Surveyor
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
    seen_cells, coverage, metres, driven, reason = np.zeros(len(cells), bool), [], [], 0.0, ""
    with Mopad(scene, config, seed=seed) as mopad:
        mopad.robot.set_down(world_from_base)
        surveyor = Surveyor(mopad, config, Stopwatch(), seed=seed)
        room = ExploredRoom(1, Footprint(*mopad.robot.footprint), config, Registrar(config.registration))
        try:
            for event in surveyor.survey(room, photograph=False):
                match event:
                    case Scanned():
                        seen_cells |= seen(cells, event.scan, event.true_world_from_scanner)
                        coverage.append(float(seen_cells.mean()))
                        metres.append(driven)
                    case Drove():
                        driven += float(np.hypot(*np.diff(event.world_from_base[:, :2, 3], axis=0).T).sum())
                    case Planned():
                        reason = event.plan.stop_reason or ""
        except MissionError as error:  # such as no walls: what was seen until then counts
            reason = str(error)
    return Exploration(
        scene=path.name,
        room=number,
        planner=config.planning.planner,
        seed=seed,
        coverage=tuple(coverage),
        metres=tuple(metres),
        stop_reason=reason,
    )
