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
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field

from detector.room import VoxelLabel
from mission.grid import Footprint, OccupancyGrid
from mission.navigation import NavigationParameters, RoadMap, road_map
from mission.prediction import Cells, Prospect, ScannerView, cubes, prospect

COVERAGE, NO_GAIN, SCAN_LIMIT = "coverage", "no gain", "scan limit"
NO_OVERLAP, UNREACHABLE = "no overlap", "nothing reachable"
"""Reasons to stop."""


class PlanningParameters(BaseModel):
    """What a scan is worth, and when to stop."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    max_scans: int = Field(default=6, ge=1, le=100, description="Scans of a room, the first included")
    target_coverage: float = Field(default=0.98, gt=0.0, le=1.0, description="Share of the structure's area")
    min_value: float = Field(default=0.4, ge=0.0, le=100.0, description="A scan must be worth so much [m2]")
    min_overlap: float = Field(default=0.3, ge=0.0, le=1.0, description="Known share of what is seen, for registration")
    travel_cost: float = Field(default=0.05, ge=0.0, le=5.0, description="Decay of the value with the way [1/m]")
    quality_weight: float = Field(default=0.2, ge=0.0, le=10.0, description="Of wall area seen only obliquely so far")
    doorway_weight: float = Field(default=0.5, ge=0.0, le=10.0, description="Of doorway area seen from a new side")
    oblique_deg: float = Field(default=65.0, gt=0.0, lt=90.0, description="Incidence beyond which a view is poor")
    aside_deg: float = Field(default=20.0, ge=0.0, lt=90.0, description="Bearing from which a doorway's side is seen")
    max_candidates: int = Field(default=400, ge=1, le=10_000, description="More are thinned out evenly")
    view: ScannerView = ScannerView()


class StructuralVoxels(Protocol):
    """The voxels of walls, floor and ceiling as one table."""

    @property
    def cells_in_world(self) -> NDArray[np.floating]:
        """(M, 3) centres on the surface [m]."""

    @property
    def normals(self) -> NDArray[np.floating]:
        """(M, 3) unit normals into the room."""

    @property
    def labels(self) -> NDArray[np.uint8]:
        """(M,) `VoxelLabel`."""

    @property
    def areas(self) -> NDArray[np.floating]:
        """(M,) area of the surface in the voxel [m2]."""


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
    survey = _Survey(voxels, points_in_world, scanners_in_world, floor_height, parameters)
    offered = np.arange(1, len(roads.points))
    offered = offered[:: -(-len(offered) // parameters.max_candidates) or 1]
    candidates = tuple(survey.judged(roads, int(k), base_from_scanner) for k in offered)
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


class _Survey:
    """What the scans so far have seen of the structure, against which candidates are judged."""

    def __init__(
        self,
        voxels: StructuralVoxels,
        points_in_world: NDArray[np.floating],
        scanners_in_world: NDArray[np.float64],
        floor_height: float,
        parameters: PlanningParameters,
    ) -> None:
        self._cells = Cells(np.asarray(voxels.cells_in_world, np.float64), np.asarray(voxels.normals, np.float64))
        self._areas = np.asarray(voxels.areas, np.float64)
        self._parameters = parameters
        self._floor_height = floor_height
        self._occluders = cubes(points_in_world, self._cells, side=parameters.view.occluder)
        self._occluded = voxels.labels == VoxelLabel.OCCLUDED
        self._occupied = voxels.labels == VoxelLabel.OCCUPIED
        self._walls = abs(self._cells.normals_in_world[:, 2]) < 0.5
        self._doorways = self._down_to_floor((voxels.labels == VoxelLabel.OPENING) & self._walls)
        earlier = [self._prospect(scanner) for scanner in np.asarray(scanners_in_world, np.float64)]
        nowhere = np.zeros(len(self._areas), dtype=np.bool_)
        self._well_seen = np.logical_or.reduce([nowhere] + [self._well(p) for p in earlier])
        self._seen_from_left = np.logical_or.reduce([nowhere] + [self._from_side(p, 1) for p in earlier])
        self._seen_from_right = np.logical_or.reduce([nowhere] + [self._from_side(p, -1) for p in earlier])
        self.coverage = 1.0 - float(self._areas[self._occluded].sum() / max(self._areas.sum(), 1e-9))

    def judged(self, roads: RoadMap, index: int, base_from_scanner: NDArray[np.float64]) -> ScanCandidate:
        """What a scan from a point of the road map would bring."""
        position, travel = roads.points[index], float(roads.metres[index])
        if not np.isfinite(travel):
            return _candidate(position, travel=travel, reason="no way there")
        ahead = position - roads.points[roads.before[index]]
        heading = float(np.arctan2(ahead[1], ahead[0]))
        cos, sin = ahead / max(float(np.hypot(*ahead)), 1e-9)
        x, y, z = base_from_scanner[:3, 3]
        scanner = np.array([position[0] + cos * x - sin * y, position[1] + sin * x + cos * y, self._floor_height + z])
        view = self._prospect(scanner)
        new_side = (self._from_side(view, 1) & ~self._seen_from_left) | (
            self._from_side(view, -1) & ~self._seen_from_right
        )
        known = self._area(view.seen & self._occupied)
        gain = self._area(view.seen & self._occluded)
        candidate = _candidate(
            position,
            heading=heading,
            travel=travel,
            gain=gain,
            quality=self._area(self._well(view) & self._occupied & self._walls & ~self._well_seen),
            doorway=self._area(new_side & self._doorways),
            overlap=known / max(known + gain, 1e-9),
        )
        if candidate.overlap < self._parameters.min_overlap:
            return replace(candidate, reason=f"overlap under {self._parameters.min_overlap:g}")
        value = worth(candidate, self._parameters)
        return replace(candidate, score=value * float(np.exp(-self._parameters.travel_cost * travel)))

    def _prospect(self, scanner: NDArray[np.float64]) -> Prospect:
        return prospect(scanner, self._cells, self._occluders, self._parameters.view)

    def _area(self, chosen: NDArray[np.bool_]) -> float:
        return float(self._areas[chosen].sum())

    def _well(self, view: Prospect) -> NDArray[np.bool_]:
        """(M,) cells seen at a good angle."""
        return view.seen & (view.cosine >= np.cos(np.radians(self._parameters.oblique_deg)))

    def _from_side(self, view: Prospect, side: int) -> NDArray[np.bool_]:
        """(M,) cells seen from well to one side of their normal: 1 is anticlockwise of it, -1 clockwise."""
        return view.seen & (side * view.bearing > np.radians(self._parameters.aside_deg))

    def _down_to_floor(self, openings: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """(M,) opening cells in columns whose lowest 0.3 m (a voxel and a half) are open too."""
        from scipy.spatial import cKDTree

        centres = self._cells.centres_in_world
        at_floor = openings & (centres[:, 2] < self._floor_height + 0.3)
        doorways = np.zeros(len(openings), dtype=np.bool_)
        if at_floor.any():
            distance, _ = cKDTree(centres[at_floor, :2]).query(centres[openings, :2])
            doorways[openings] = distance < 0.02  # the same column
        return doorways


def worth(candidate: ScanCandidate, parameters: PlanningParameters, *, covered: bool = False) -> float:
    """Value of a scan from a candidate [m2], before the way there; without the gain where that is no longer wanted."""
    extras = parameters.quality_weight * candidate.quality + parameters.doorway_weight * candidate.doorway
    return extras if covered else candidate.gain + extras


def _candidate(position: NDArray[np.float64], *, travel: float, **fields: Any) -> ScanCandidate:
    nothing = dict(heading=0.0, gain=0.0, quality=0.0, doorway=0.0, overlap=0.0, score=0.0, reason=None)
    return ScanCandidate(position=position, travel=travel, **{**nothing, **fields})


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
