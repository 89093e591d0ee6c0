"""How to choose among the places to scan from: the next best scan, and three baselines to compare it with.

The baselines know the same candidates and obey the same objections (no way there, scanned beside it, too little
overlap to be registered), and stop as soon as the room's structure is covered:

- `frontier`: the nearest frontier between free and unknown floor (Yamauchi, A frontier-based approach for autonomous
  exploration, CIRA 1997). Frontier cells that touch form a region; short regions are left out; the place for a region
  is the reachable one nearest to the cell in its middle; a region whose place was scanned from is done with.
- `random`: any reachable place, each as likely.
- `grid`: the reachable places nearest to the points of a regular grid through the first scan, the nearest first.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import cv2
import numpy as np
from numpy.typing import NDArray

from mission.candidates import PlanningParameters, ScanCandidate, worth
from mission.grid import Cell, OccupancyGrid
from mission.plan_polygon import within_polygon

NO_GAIN, NO_FRONTIER, NO_GRID_PLACE, NO_PLACE = "no gain", "no frontier", "no grid place", "no place left"
"""Reasons to stop, or against a candidate, of one planner each."""


class Planner(Protocol):
    """A way to choose."""

    @property
    def lack(self) -> str:
        """Why there is no further scan where none of the candidates is worth one."""

    def scores(self, candidates: Sequence[ScanCandidate]) -> list[float | None]:
        """Score of each candidate, the larger the better; None for one that the planner has no use for.

        Args:
            candidates: All of them, also those that are out of the question.
        """

    def is_worth_a_scan(self, candidate: ScanCandidate) -> bool:
        """Whether the room should be scanned from the best candidate, or is done."""


def planner(
    parameters: PlanningParameters,
    *,
    grid: OccupancyGrid,
    room: NDArray[np.float64] | None,
    tried_in_world: NDArray[np.float64],
    covered: bool,
    seed: Sequence[int],
) -> Planner:
    """The planner that the parameters name.

    Args:
        grid: The floor as far as it is known.
        room: (P, 2) polygon [m]; None for everywhere.
        tried_in_world: (S, 3) places that were scanned from, the first scan first [m].
        covered: Whether the structure is covered as far as is asked for.
        seed: Of this choice, where chance has a say.
    """
    match parameters.planner:
        case "nbs":
            return NextBestScan(parameters, covered)
        case "frontier":
            return NearestFrontier(covered, grid, room, parameters.frontier_length)
        case "random":
            return RandomPlace(covered, seed)
        case "grid":
            return RegularGrid(covered, tried_in_world, parameters.grid_spacing)


@dataclass(frozen=True)
class NextBestScan:
    """The place from which most comes into view, less what the way costs."""

    parameters: PlanningParameters
    covered: bool
    lack: str = NO_GAIN

    def scores(self, candidates: Sequence[ScanCandidate]) -> list[float | None]:
        """The candidates' worth, which decays with the way."""
        decay = self.parameters.travel_cost
        return [self._value(candidate) * float(np.exp(-decay * candidate.travel)) for candidate in candidates]

    def is_worth_a_scan(self, candidate: ScanCandidate) -> bool:
        """Whether enough would come into view."""
        return self._value(candidate) >= self.parameters.min_value

    def _value(self, candidate: ScanCandidate) -> float:
        return worth(candidate, self.parameters, covered=self.covered)


@dataclass(frozen=True, eq=False)
class _Baseline:
    """A planner that goes on until the room is covered."""

    covered: bool

    def is_worth_a_scan(self, candidate: ScanCandidate) -> bool:
        """Whether the room is not covered yet."""
        return not self.covered


@dataclass(frozen=True, eq=False)
class NearestFrontier(_Baseline):
    """The place at the nearest frontier."""

    grid: OccupancyGrid
    room: NDArray[np.float64] | None
    length: float
    lack: str = NO_FRONTIER

    def scores(self, candidates: Sequence[ScanCandidate]) -> list[float | None]:
        """The nearer, the better; None away from frontiers."""
        scores: list[float | None] = [None] * len(candidates)
        reachable = [k for k, candidate in enumerate(candidates) if np.isfinite(candidate.travel)]
        if not reachable:
            return scores
        places = np.array([candidates[k].position for k in reachable])
        for middle in frontiers(self.grid, room=self.room, length=self.length):
            k = reachable[int(np.hypot(*(places - middle).T).argmin())]
            scores[k] = _nearness(candidates[k])
        return scores


@dataclass(frozen=True, eq=False)
class RandomPlace(_Baseline):
    """Any place."""

    seed: Sequence[int]
    lack: str = NO_PLACE

    def scores(self, candidates: Sequence[ScanCandidate]) -> list[float | None]:
        """Drawn evenly."""
        return [1.0 - float(drawn) for drawn in np.random.default_rng(self.seed).random(len(candidates))]


@dataclass(frozen=True, eq=False)
class RegularGrid(_Baseline):
    """The nearest place of a regular grid that was not scanned from."""

    tried_in_world: NDArray[np.float64]
    spacing: float
    lack: str = NO_GRID_PLACE

    def scores(self, candidates: Sequence[ScanCandidate]) -> list[float | None]:
        """The nearer, the better; None away from the grid, and where its square holds a scan."""
        places = np.array([candidate.position for candidate in candidates]).reshape(-1, 2)
        square, off = self._squares(places)
        taken = {tuple(one) for one in self._squares(self.tried_in_world[:, :2])[0].tolist()}
        best: dict[tuple[int, ...], int] = {}
        for k in np.argsort(off, kind="stable").tolist():
            if np.isfinite(candidates[k].travel):
                best.setdefault(tuple(square[k].tolist()), k)
        chosen = {k for one, k in best.items() if one not in taken}
        return [_nearness(candidate) if k in chosen else None for k, candidate in enumerate(candidates)]

    def _squares(self, places: NDArray[np.float64]) -> tuple[NDArray[np.intp], NDArray[np.float64]]:
        """The square (N, 2) round a grid point that each place (N, 2) is in, and how far off the point it is [m]."""
        steps = (places - self.tried_in_world[0, :2]) / self.spacing
        square = np.rint(steps)
        return square.astype(np.intp), self.spacing * np.hypot(*(steps - square).T)


def frontiers(grid: OccupancyGrid, *, room: NDArray[np.float64] | None, length: float) -> list[NDArray[np.float64]]:
    """(2,) the middle cell of each frontier: of a connected region of free cells that border on unknown ones [m].

    Args:
        grid: The floor as far as it is known.
        room: (P, 2) polygon that frontiers lie in [m]; None for everywhere.
        length: Regions of fewer cells than fill this length are left out [m].
    """
    unknown = (grid.cells == Cell.UNKNOWN).astype(np.uint8)
    border = (grid.cells == Cell.FREE) & (cv2.dilate(unknown, np.ones((3, 3), np.uint8)) > 0)
    centres = grid.centres()
    if room is not None:
        border[border] = within_polygon(centres[border], room)
    _, region, facts, _ = cv2.connectedComponentsWithStats(border.astype(np.uint8), connectivity=8)
    middles = []
    for number in range(1, len(facts)):  # 0 is what is no border
        if facts[number, cv2.CC_STAT_AREA] * grid.resolution >= length:
            cells = centres[region == number]
            middles.append(cells[np.hypot(*(cells - cells.mean(axis=0)).T).argmin()])
    return middles


def _nearness(candidate: ScanCandidate) -> float:
    return 1.0 / (1.0 + candidate.travel)
