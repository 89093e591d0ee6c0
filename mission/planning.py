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
from pydantic import BaseModel, ConfigDict, Field

from mission.grid import Footprint, OccupancyGrid
from mission.navigation import NavigationParameters, RoadMap, road_map
from mission.survey import Preview, StructuralVoxels, Survey, SurveyParameters

COVERAGE, NO_GAIN, SCAN_LIMIT = "coverage", "no gain", "scan limit"
NO_OVERLAP, UNREACHABLE = "no overlap", "nothing reachable"
"""Reasons to stop."""


class PlanningParameters(BaseModel):
    """What a scan is worth, and when to stop."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    max_scans: int = Field(default=6, ge=1, le=100, description="Scans of a room, the first included")
    target_coverage: float = Field(default=0.98, gt=0.0, le=1.0, description="Share of the structure's area")
    min_value: float = Field(default=0.5, ge=0.0, le=100.0, description="A scan must be worth so much [m2]")
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
    """Area of wall that no scan has yet seen less obliquely than `oblique_deg`, and this one would [m2]."""
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
    room: NDArray[np.float64] | None = None,
    footprint: Footprint | None = None,
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
        room: (P, 2) polygon that candidates must lie in; anywhere by default.
    """
    parameters, footprint = parameters or PlanningParameters(), footprint or Footprint()
    roads = road_map(grid, world_from_base, footprint=footprint, parameters=navigation, within=room)
    survey = Survey(
        voxels,
        points_in_world,
        scanners_in_world,
        floor_height=floor_height,
        room=room,
        parameters=parameters.survey,
    )
    mount = base_from_scanner[:3, 3] + np.array([0.0, 0.0, floor_height])
    offered = np.arange(1, len(roads.points))
    offered = offered[:: -(-len(offered) // parameters.max_candidates) or 1]
    candidates = tuple(_judged(survey, roads, int(point), mount, parameters) for point in offered)
    stop_reason = _stop_reason(
        candidates, coverage=survey.coverage, scans=len(scanners_in_world), parameters=parameters
    )
    chosen = None if stop_reason else int(np.argmax([candidate.score for candidate in candidates]))
    return Plan(
        candidates=candidates,
        chosen=chosen,
        path=None if chosen is None else roads.path_to(int(offered[chosen])),
        stop_reason=stop_reason,
        coverage=survey.coverage,
    )


def worth(candidate: ScanCandidate, parameters: PlanningParameters, *, covered: bool = False) -> float:
    """Value of a scan from a candidate [m2], before the way there; without the gain where that is no longer wanted."""
    extras = parameters.quality_weight * candidate.quality + parameters.doorway_weight * candidate.doorway
    return extras if covered else candidate.gain + extras


def _judged(
    survey: Survey, roads: RoadMap, point: int, mount: NDArray[np.float64], parameters: PlanningParameters
) -> ScanCandidate:
    """What a scan from a point of the road map would bring, the scanner at (3,) `mount` in a base on z = 0."""
    position, travel = roads.points[point], float(roads.metres[point])
    if not np.isfinite(travel):
        nothing = Preview(gain=0.0, quality=0.0, doorway=0.0, overlap=0.0)
        return _candidate(position, nothing, heading=0.0, travel=travel, reason="no way there")
    way = position - roads.points[roads.before[point]]
    cos, sin = way / max(float(np.hypot(*way)), 1e-9)
    offset = np.array([cos * mount[0] - sin * mount[1], sin * mount[0] + cos * mount[1], mount[2]])
    preview = survey.preview(np.append(position, 0.0) + offset)
    too_new = preview.overlap < parameters.min_overlap
    candidate = _candidate(
        position,
        preview,
        heading=float(np.arctan2(sin, cos)),
        travel=travel,
        reason=f"overlap under {parameters.min_overlap:g}" if too_new else None,
    )
    if too_new:
        return candidate
    return replace(candidate, score=worth(candidate, parameters) * float(np.exp(-parameters.travel_cost * travel)))


def _candidate(
    position: NDArray[np.float64], preview: Preview, *, heading: float, travel: float, reason: str | None
) -> ScanCandidate:
    return ScanCandidate(
        position=position,
        heading=heading,
        gain=preview.gain,
        quality=preview.quality,
        doorway=preview.doorway,
        overlap=preview.overlap,
        travel=travel,
        score=0.0,
        reason=reason,
    )


def _stop_reason(
    candidates: Sequence[ScanCandidate], *, coverage: float, scans: int, parameters: PlanningParameters
) -> str | None:
    """Why to stop; None to go on. Doorways and oblique walls can keep a covered room going, small gains cannot."""
    possible = [candidate for candidate in candidates if candidate.reason is None]
    covered = coverage >= parameters.target_coverage
    worthwhile = any(worth(candidate, parameters, covered=covered) >= parameters.min_value for candidate in possible)
    if covered and not worthwhile:
        return COVERAGE
    if scans >= parameters.max_scans:
        return SCAN_LIMIT
    if not possible:
        reachable = any(np.isfinite(candidate.travel) for candidate in candidates)
        return NO_OVERLAP if reachable else UNREACHABLE
    return None if worthwhile else NO_GAIN
