"""The next best scan: from where would the most of the room's hidden structure come into view?

After Adan, Quintana et al. (Towards the Automatic Scanning of Indoors with Robots, Sensors 15(5), 2015) in the outline
of section 3 of the paper: candidates are reachable places, a candidate's gain is the area of structural voxels that are
still occluded and that it would see, it must also see enough of the known structure to be registered, and the way there
costs. The loop ends when no candidate is worth a scan.

    score = value exp(-travel_cost travel),  value = gain + quality_weight quality + doorway_weight doorway

is the form of nbvplanner (Bircher et al., ICRA 2016), whose 0.25 per metre suits an aircraft that maps on the way; here
a scan with its photographs takes two minutes, as long as 37 m of driving, so the way decides between similar views
only. Simpler planners are in `mission.planners`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from detector.parallel import each
from mission.candidates import PlanningParameters, ScanCandidate
from mission.grid import Footprint, OccupancyGrid
from mission.navigation import NavigationParameters, RoadMap, road_map
from mission.planners import Planner, planner
from mission.survey import NOTHING, Preview, StructuralVoxels, Survey
from sim.scan import ScannerParameters

COVERAGE, SCAN_LIMIT = "coverage", "scan limit"
NO_OVERLAP, UNREACHABLE = "no overlap", "nothing reachable"
"""Reasons to stop, beside those of the planners."""
NO_WAY = "no way there"
"""Reason against a candidate."""
LITTLE_OVERLAP = "overlap under"
"""What the reason against a candidate begins with from which too little of what is known would be seen."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Plan:
    """All candidates for the next scan, and the choice."""

    candidates: tuple[ScanCandidate, ...]
    chosen: int | None
    """Index of the chosen candidate; None when the room is done."""
    path: NDArray[np.float64] | None
    """(P, 2) way points to it, the robot's position first [m]."""
    stop_reason: str | None
    """One of the reasons above; None if there is to be another scan."""
    coverage: float
    """Share of the structure's area that is not occluded."""


def plan_next_scan(
    voxels: StructuralVoxels,
    points_in_world: NDArray[np.floating],
    grid: OccupancyGrid,
    *,
    world_from_base: NDArray[np.float64],
    base_from_scanner: NDArray[np.float64],
    scanners_in_world: NDArray[np.float64],
    floor_height: float,
    footprint: Footprint,
    room: NDArray[np.float64] | None = None,
    failed_in_world: NDArray[np.float64] | None = None,
    scanner: ScannerParameters | None = None,
    navigation: NavigationParameters | None = None,
    parameters: PlanningParameters | None = None,
    seed: Sequence[int] = (0,),
) -> Plan:
    """Choose where to scan next, or say why the room is done.

    Args:
        voxels: The room's structure as labelled so far.
        points_in_world: (N, 3) points of all scans, which stand in the way of beams [m].
        grid: Where the robot can go.
        world_from_base: (4, 4) pose of the robot now.
        base_from_scanner: (4, 4) mount of the scanner.
        scanners_in_world: (S, 3) where was scanned so far [m].
        floor_height: World z of the floor [m].
        footprint: Of the robot.
        room: (P, 2) polygon that candidates must lie in; anywhere by default.
        failed_in_world: (F, 3) where scans were taken that could not be used [m]: they count, and are not repeated.
        scanner: What is to scan: its range and field of view.
        seed: Of a choice by chance; another for every plan.
    """
    parameters = parameters or PlanningParameters()
    roads = road_map(grid, world_from_base, footprint=footprint, parameters=navigation, within=room)
    survey = Survey(
        voxels,
        points_in_world,
        scanners_in_world,
        floor_height=floor_height,
        room=room,
        scanner=scanner or ScannerParameters(),
        parameters=parameters.survey,
    )
    mount = base_from_scanner[:3, 3] + np.array([0.0, 0.0, floor_height])
    offered = np.arange(1, len(roads.points))
    offered = offered[:: -(-len(offered) // parameters.max_candidates) or 1]
    tried = scanners_in_world if failed_in_world is None else np.concatenate([scanners_in_world, failed_in_world])
    covered = survey.coverage >= parameters.target_coverage
    chooser = planner(parameters, grid=grid, room=room, tried_in_world=tried, covered=covered, seed=seed)
    judge = _Judge(survey, tried, mount, parameters)
    candidates = _scored(each(partial(judge.candidate, roads), offered.tolist()), chooser)
    best = max(range(len(candidates)), key=lambda k: candidates[k].score, default=None)
    stop_reason = _stop_reason(candidates, best, chooser, covered=covered)
    if stop_reason is None and len(tried) >= parameters.max_scans:
        stop_reason = SCAN_LIMIT
    chosen = best if stop_reason is None else None
    return Plan(
        candidates=candidates,
        chosen=chosen,
        path=None if chosen is None else roads.path_to(int(offered[chosen])),
        stop_reason=stop_reason,
        coverage=survey.coverage,
    )


class _Judge:
    """Previews candidates, and raises what speaks against them whoever chooses."""

    def __init__(
        self,
        survey: Survey,
        tried: NDArray[np.float64],
        mount: NDArray[np.float64],
        parameters: PlanningParameters,
    ) -> None:
        """Take what all candidates have in common.

        Args:
            survey: Of the room.
            tried: (S, 3) places scanned from, with or without success [m].
            mount: (3,) of the scanner on a robot at the origin, facing along x, on the room's floor [m].
            parameters: How near is too near, and how little overlap too little.
        """
        self._survey, self._tried = survey, tried
        self._mount, self._parameters = mount, parameters

    def candidate(self, roads: RoadMap, point: int) -> ScanCandidate:
        """What a scan from a point of the road map would bring."""
        position, travel = roads.points[point], float(roads.metres[point])
        way = position - roads.points[max(roads.before[point], 0)]
        cos, sin = way / np.hypot(*way) if way.any() else (1.0, 0.0)
        x, y, z = self._mount
        scanner = np.array([position[0] + cos * x - sin * y, position[1] + sin * x + cos * y, z])
        preview = self._survey.preview(scanner) if np.isfinite(travel) else NOTHING
        return ScanCandidate(
            position=position,
            heading=float(np.arctan2(sin, cos)),
            gain=preview.gain,
            quality=preview.quality,
            doorway=preview.doorway,
            overlap=preview.overlap,
            travel=travel,
            score=0.0,
            reason=self._objection(preview, scanner, travel),
        )

    def _objection(self, preview: Preview, scanner: NDArray[np.float64], travel: float) -> str | None:
        """Why a candidate is out of the question."""
        if not np.isfinite(travel):
            return NO_WAY
        distance = np.hypot(*(self._tried[:, :2] - scanner[:2]).T)
        if distance.min(initial=np.inf) < self._parameters.min_separation:
            return f"scanned from {distance.min():.2f} m beside it"
        if preview.overlap < self._parameters.min_overlap:
            return f"{LITTLE_OVERLAP} {self._parameters.min_overlap:g}"
        return None


def _scored(candidates: Sequence[ScanCandidate], chooser: Planner) -> tuple[ScanCandidate, ...]:
    """The candidates with the planner's scores, and its objections where there is a way."""
    return tuple(
        replace(candidate, reason=chooser.lack if candidate.reason != NO_WAY else NO_WAY)
        if score is None
        else replace(candidate, score=score if candidate.reason is None else 0.0)
        for candidate, score in zip(candidates, chooser.scores(candidates), strict=True)
    )


def _stop_reason(
    candidates: Sequence[ScanCandidate], best: int | None, chooser: Planner, *, covered: bool
) -> str | None:
    """Why to stop; None to go on."""
    possible = best is not None and candidates[best].reason is None
    if best is not None and possible and chooser.is_worth_a_scan(candidates[best]):
        return None
    if covered:
        return COVERAGE
    reasons = {candidate.reason or "" for candidate in candidates}
    if possible:
        return chooser.lack
    if any(reason.startswith(LITTLE_OVERLAP) for reason in reasons):
        return NO_OVERLAP
    return chooser.lack if chooser.lack in reasons else UNREACHABLE
