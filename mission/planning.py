"""The next best scan: from where would the most of the room's hidden structure come into view?

After Adan, Quintana et al. (Towards the Automatic Scanning of Indoors with Robots, Sensors 15(5), 2015) in the outline
of section 3 of the paper: candidates are reachable places, a candidate's gain is the area of structural voxels that are
still occluded and that it would see, it must also see enough of the known structure to be registered, and the way there
costs. The loop ends when no candidate is worth a scan.

    score = value exp(-travel_cost travel),  value = gain + quality_weight quality + doorway_weight doorway

is the form of nbvplanner (Bircher et al., ICRA 2016), whose 0.25 per metre suits an aircraft that maps on the way; here
a scan takes as long as 25 m of driving, so the way decides between similar views only.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from mission.grid import Footprint, OccupancyGrid
from mission.navigation import NavigationParameters, RoadMap, road_map
from mission.survey import NOTHING, Preview, StructuralVoxels, Survey, SurveyParameters
from sim.parameters import Parameters
from sim.scanner import ScannerParameters

COVERAGE, NO_GAIN, SCAN_LIMIT = "coverage", "no gain", "scan limit"
NO_OVERLAP, UNREACHABLE = "no overlap", "nothing reachable"
"""Reasons to stop."""
NO_WAY = "no way there"
"""Reason against a candidate."""


class PlanningParameters(Parameters):
    """What a scan is worth, and when to stop."""

    max_scans: int = Field(default=6, ge=1, le=100, description="Scans of a room, the first included")
    max_rooms: int = Field(default=30, ge=1, le=1000, description="Rooms of a mission")
    target_coverage: float = Field(default=0.98, gt=0.0, le=1.0, description="Share of the structure's area")
    min_value: float = Field(default=0.5, ge=0.0, le=100.0, description="A scan must be worth so much [m2]")
    min_separation: float = Field(default=0.5, ge=0.0, le=5.0, description="From the places scanned before [m]")
    min_overlap: float = Field(default=0.3, ge=0.0, le=1.0, description="Known share of what is seen, for registration")
    travel_cost: float = Field(default=0.05, ge=0.0, le=5.0, description="Decay of the value with the way [1/m]")
    quality_weight: float = Field(default=0.15, ge=0.0, le=10.0, description="Of wall area seen only obliquely so far")
    doorway_weight: float = Field(default=0.5, ge=0.0, le=10.0, description="Of doorway area seen from a new side")
    survey: SurveyParameters = SurveyParameters()
    max_candidates: int = Field(default=400, ge=1, le=10_000, description="More are thinned out evenly")


@dataclass(frozen=True, kw_only=True, eq=False)
class ScanCandidate:
    """A place to scan from, and what that would bring."""

    position: NDArray[np.float64]
    """(2,) of the robot in the world [m]."""
    heading: float
    """On arrival [rad]; the scanner turns full circle, so any would do."""
    gain: float
    """Area of occluded structure that would come into view [m2]."""
    quality: float
    """Area of wall that no scan has yet seen less obliquely than `oblique_incidence`, and this one would [m2]."""
    doorway: float
    """Area of openings down to the floor seen from a side, left or right, from which no scan has seen them [m2].

    An open leaf and its hinge show from one side only; which one is not known before.
    """
    overlap: float
    """Share of the structure in view that is known already."""
    travel: float
    """Length of the way [m]; infinite where there is none."""
    score: float
    """What the choice goes by [m2]; 0 for what is out of the question."""
    reason: str | None
    """Why the candidate is out of the question; None if it is not."""


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
    tried = [scanners_in_world] if failed_in_world is None else [scanners_in_world, failed_in_world]
    judge = _Judge(survey, np.concatenate(tried), mount, parameters)
    candidates = tuple(judge.candidate(roads, int(point)) for point in offered)
    best = max(range(len(candidates)), key=lambda k: candidates[k].score, default=None)
    stop_reason = judge.stop_reason(candidates, best)
    chosen = best if stop_reason is None else None
    return Plan(
        candidates=candidates,
        chosen=chosen,
        path=None if chosen is None else roads.path_to(int(offered[chosen])),
        stop_reason=stop_reason,
        coverage=survey.coverage,
    )


def worth(candidate: ScanCandidate, parameters: PlanningParameters, *, covered: bool = False) -> float:
    """Value of a scan from a candidate [m2], before the way there; a covered room is no longer scanned for the gain."""
    extras = parameters.quality_weight * candidate.quality + parameters.doorway_weight * candidate.doorway
    return extras if covered else candidate.gain + extras


class _Judge:
    """Puts candidates and the room as a whole to the test."""

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
            parameters: What a scan is worth.
        """
        self._survey, self._tried = survey, tried
        self._mount, self._parameters = mount, parameters
        self._little_overlap = f"overlap under {parameters.min_overlap:g}"
        self._covered = survey.coverage >= parameters.target_coverage

    def candidate(self, roads: RoadMap, point: int) -> ScanCandidate:
        """What a scan from a point of the road map would bring."""
        parameters, position, travel = self._parameters, roads.points[point], float(roads.metres[point])
        way = position - roads.points[max(roads.before[point], 0)]
        cos, sin = way / np.hypot(*way) if way.any() else (1.0, 0.0)
        x, y, z = self._mount
        scanner = np.array([position[0] + cos * x - sin * y, position[1] + sin * x + cos * y, z])
        preview = self._survey.preview(scanner) if np.isfinite(travel) else NOTHING
        reason = self._objection(preview, scanner, travel)
        candidate = ScanCandidate(
            position=position,
            heading=float(np.arctan2(sin, cos)),
            gain=preview.gain,
            quality=preview.quality,
            doorway=preview.doorway,
            overlap=preview.overlap,
            travel=travel,
            score=0.0,
            reason=reason,
        )
        if reason is not None:
            return candidate
        value = worth(candidate, parameters, covered=self._covered)
        return replace(candidate, score=value * float(np.exp(-parameters.travel_cost * travel)))

    def _objection(self, preview: Preview, scanner: NDArray[np.float64], travel: float) -> str | None:
        """Why a candidate is out of the question."""
        if not np.isfinite(travel):
            return NO_WAY
        distance = np.hypot(*(self._tried[:, :2] - scanner[:2]).T)
        if distance.min(initial=np.inf) < self._parameters.min_separation:
            return f"scanned from {distance.min():.2f} m beside it"
        if preview.overlap < self._parameters.min_overlap:
            return self._little_overlap
        return None

    def stop_reason(self, candidates: Sequence[ScanCandidate], best: int | None) -> str | None:
        """Why to stop; None to go on."""
        possible = best is not None and candidates[best].reason is None
        if best is not None and possible:
            value = worth(candidates[best], self._parameters, covered=self._covered)
            if value >= self._parameters.min_value:
                return SCAN_LIMIT if len(self._tried) >= self._parameters.max_scans else None
        if self._covered:
            return COVERAGE
        if possible:
            return NO_GAIN
        return NO_OVERLAP if any(c.reason == self._little_overlap for c in candidates) else UNREACHABLE
