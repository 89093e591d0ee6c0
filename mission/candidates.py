"""Places to scan from, and the parameters of the choice among them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from mission.survey import SurveyParameters
from sim.parameters import Parameters


class PlanningParameters(Parameters):
    """What a scan is worth, and when to stop."""

    planner: Literal["nbs", "frontier", "random", "grid"] = Field(
        default="nbs", description="Next best scan, or a baseline to compare it with: see mission/planners.py"
    )
    max_scans: int = Field(default=6, ge=1, le=100, description="Scans of a room, the first included")
    max_rooms: int = Field(default=30, ge=1, le=1000, description="Rooms of a mission")
    target_coverage: float = Field(default=0.98, gt=0.0, le=1.0, description="Share of the structure's area")
    min_value: float = Field(default=0.5, ge=0.0, le=100.0, description="A scan must be worth so much [m2]")
    min_separation: float = Field(default=0.5, ge=0.0, le=5.0, description="From the places scanned before [m]")
    min_overlap: float = Field(default=0.3, ge=0.0, le=1.0, description="Known share of what is seen, for registration")
    travel_cost: float = Field(default=0.025, ge=0.0, le=5.0, description="Decay of the value with the way [1/m]")
    quality_weight: float = Field(default=0.15, ge=0.0, le=10.0, description="Of wall area seen only obliquely so far")
    doorway_weight: float = Field(default=0.5, ge=0.0, le=10.0, description="Of doorway area seen from a new side")
    frontier_length: float = Field(
        default=0.6, ge=0.0, le=10.0, description="Shorter ones are no frontier: about the robot's width [m]"
    )
    grid_spacing: float = Field(default=2.0, ge=0.25, le=20.0, description="Of the planner `grid`'s places [m]")
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
    """What the choice goes by, in the planner's own measure, of `nbs` [m2]; 0 for what is out of the question."""
    reason: str | None
    """Why the candidate is out of the question; None if it is not."""


def worth(candidate: ScanCandidate, parameters: PlanningParameters, *, covered: bool = False) -> float:
    """Value of a scan from a candidate [m2], before the way there; a covered room is no longer scanned for the gain."""
    extras = parameters.quality_weight * candidate.quality + parameters.doorway_weight * candidate.doorway
    return extras if covered else candidate.gain + extras
