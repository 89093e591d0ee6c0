"""Structure of a room from its scans: floor, ceiling, wall rectangles and the floor's polygon (section 3)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from mission.by_columns import chosen, gathered
from mission.errors import MissionError
from mission.plan_polygon import Loop, within_polygon
from mission.samples import PosedSample, thinned
from mission.visibility import Visibility, VisibilityParameters
from mission.wall_finder import Outline, WallFinder, WallParameters, WallRectangle
from sim.parameters import Parameters
from sim.scan import ScannerParameters

Floats = NDArray[np.float64]


class StructureParameters(Parameters):
    """What floor, ceiling and walls are."""

    reach: float = Field(default=15.0, ge=3, le=200, description="floor and walls lie within this of some scanner [m]")
    spacing: float = Field(default=0.03, ge=0.005, le=0.2, description="of the points that are looked at [m]")
    min_level_area: float = Field(default=1.0, gt=0, le=100, description="least area of floor or ceiling [m2]")
    min_height: float = Field(default=1.8, ge=0.5, le=20, description="of a ceiling above the floor [m]")
    ceiling_share: float = Field(default=0.2, ge=0, le=1, description="of the room's area that a ceiling shows")
    walls: WallParameters = Field(default_factory=WallParameters)
    visibility: VisibilityParameters = Field(default_factory=VisibilityParameters)


@dataclass(frozen=True, eq=False)
class Structure:
    """Floor, ceiling and walls of a room."""

    floor_height: float
    """World z [m]."""
    ceiling_height: float | None
    """World z [m]; None where there is none."""
    walls: tuple[WallRectangle, ...]
    """Counter-clockwise seen from above; those round columns last."""
    polygon: Floats
    """(P, 2) outline of the floor, counter-clockwise [m]."""
    polygon_walls: NDArray[np.int_]
    """(P,) wall on the edge from vertex p to p + 1; -1 where the room is open, or not seen yet."""
    holes: tuple[Floats, ...] = ()
    """Outlines (P, 2) of what stands in the room from floor to ceiling, clockwise [m]."""

    def interior(self, points: NDArray[np.floating]) -> NDArray[np.bool_]:
        """(N,) True for points (N, 2) or (N, 3) over the floor, and between floor and ceiling if they have a height."""
        inside = within_polygon(points, self.polygon)
        for hole in self.holes:
            inside &= ~within_polygon(points, hole)
        if points.shape[1] == 3:
            inside &= points[:, 2] > self.floor_height
            if self.ceiling_height is not None:
                inside &= points[:, 2] < self.ceiling_height
        return inside


def find_structure(
    scans: Sequence[PosedSample],
    parameters: StructureParameters | None = None,
    *,
    scanner: ScannerParameters | None = None,
) -> Structure:
    """Find floor, ceiling and walls of the room that the scans were taken in.

    A wall is a vertical surface that reaches the ceiling (the walls' common top where there is none), that a scanner
    sees with no other wall before it, and that has no like surface close behind it; so cabinets, door leaves, posters,
    reveals and the corridor beyond an open door are none.

    Args:
        scans: Samples of all scans of the room.
        parameters: What floor, ceiling and walls are.
        scanner: What took the scans.

    Raises:
        MissionError: There is no scan, no floor under the scanners, or no wall round them.
    """
    if not scans:
        raise MissionError("no scan of the room found its place")
    parameters = parameters or StructureParameters()
    scanners = np.array([scan.scanner_in_world for scan in scans])
    points, normals = _merged(scans, scanners, parameters)
    floor = _floor(points, normals, scanners, parameters)
    visibility = Visibility(scans, scanner or ScannerParameters(), parameters.visibility)
    finder = WallFinder(points, normals, floor, visibility, parameters.walls)
    ceiling = _ceiling(points, normals, floor, scanners, parameters)
    if ceiling is not None:
        outline = finder.outline(ceiling)
        if _covered(points, ceiling, outline.loops[0].vertices, parameters):
            return _structure(floor, ceiling, outline)
    return _structure(floor, None, finder.outline(None))


def _structure(floor: float, ceiling: float | None, outline: Outline) -> Structure:
    return Structure(
        floor_height=floor,
        ceiling_height=ceiling,
        walls=outline.walls,
        polygon=outline.loops[0].vertices,
        polygon_walls=outline.loops[0].lines,
        holes=tuple(loop.vertices for loop in outline.loops[1:] if loop.area < 0),
    )


def _covered(points: Floats, ceiling: float, polygon: Floats, parameters: StructureParameters) -> bool:
    """Whether a ceiling of that height is over the room, and not over the next one."""
    level = points[np.abs(points[:, 2] - ceiling) < 0.05]
    area = np.count_nonzero(within_polygon(level, polygon)) * parameters.spacing**2
    return bool(area >= parameters.ceiling_share * _area(polygon))


def _merged(scans: Sequence[PosedSample], scanners: Floats, parameters: StructureParameters) -> tuple[Floats, Floats]:
    """Points and normals (N, 3) of all scans within reach, thinned together; both by columns."""
    points = gathered([scan.points_in_world for scan in scans])
    normals = gathered([scan.normals_in_world for scan in scans])
    near = np.zeros(len(points), bool)
    for x, y, _ in scanners:
        near |= (points[:, 0] - x) ** 2 + (points[:, 1] - y) ** 2 < parameters.reach**2
    points, normals = chosen(points, near), chosen(normals, near)
    kept = thinned(points, parameters.spacing, first=np.isfinite(normals[:, 0]))
    return chosen(points, kept), chosen(normals, kept)


def _floor(points: Floats, normals: Floats, scanners: Floats, parameters: StructureParameters) -> float:
    under = points[:, 2] < scanners[:, 2].min() - 0.3
    level = _level(points[(normals[:, 2] > 0.95) & under, 2], parameters)
    if level is None:
        raise MissionError("no floor found under the scanner")
    return level


def _ceiling(
    points: Floats, normals: Floats, floor: float, scanners: Floats, parameters: StructureParameters
) -> float | None:
    over = points[:, 2] > max(floor + parameters.min_height, scanners[:, 2].max() + 0.3)
    return _level(points[(normals[:, 2] < -0.95) & over, 2], parameters)


def _level(heights: Floats, parameters: StructureParameters) -> float | None:
    """Height of the largest level surface [m]; None if all are too small."""
    if len(heights) == 0:
        return None
    width = 0.02
    low = heights.min() - width
    counts = np.bincount(((heights - low) / width).astype(int))
    smooth = np.convolve(counts, np.ones(3), mode="same")
    peak = int(np.argmax(smooth))
    if smooth[peak] * parameters.spacing**2 < parameters.min_level_area:
        return None
    level = low + (peak + 0.5) * width
    for reach in (0.03, 0.015, 0.015):
        level = float(np.median(heights[np.abs(heights - level) < reach]))
    return level


def _area(polygon: Floats) -> float:
    return abs(Loop(polygon, np.zeros(len(polygon), int)).area)
