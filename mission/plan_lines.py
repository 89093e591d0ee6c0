"""Lines in plan: where vertical surfaces that reach the ceiling run, in any direction."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from sim.parameters import Parameters

Floats = NDArray[np.float64]


class LineParameters(Parameters):
    """What a wall's line is."""

    thickness: float = Field(default=0.03, ge=0.003, le=0.5, description="points this near belong to a line [m]")
    softness: float = Field(
        default=0.006, ge=0.001, le=0.1, description="Tukey width of the last fit: posters do not pull [m]"
    )
    min_points: int = Field(default=150, ge=10, le=100_000, description="of a line: 3 cm apart, half a metre by 0.3 m")
    column: float = Field(default=0.1, ge=0.02, le=1, description="width of the columns that a wall is judged by [m]")
    top_band: float = Field(default=0.15, ge=0.01, le=2, description="a wall reaches this near to the ceiling [m]")
    min_length: float = Field(default=0.3, ge=0.05, le=10, description="of a wall [m]")
    recess: tuple[Annotated[float, Field(ge=0, le=5)], Annotated[float, Field(ge=0, le=5)]] = Field(
        default=(0.2, 0.8), description="a surface with a like one this far behind it is furniture, not wall [m]"
    )


@dataclass(frozen=True, eq=False)
class PlanLine:
    """A vertical plane seen from above; the room, or another room, lies on the side of its normal."""

    normal: Floats
    """(2,) unit, towards the scanner that saw it."""
    offset: float
    """normal . x [m]."""

    @property
    def tangent(self) -> Floats:
        """(2,) unit; the normal is on its left."""
        return np.array([self.normal[1], -self.normal[0]])

    def depth(self, plan: NDArray[np.floating]) -> NDArray[np.floating]:
        """(N,) distance of points (N, 2) in front of the line [m]."""
        return plan[:, 0] * self.normal[0] + plan[:, 1] * self.normal[1] - self.offset

    def along(self, plan: NDArray[np.floating]) -> NDArray[np.floating]:
        """(N,) coordinate of points (N, 2) along the tangent [m]."""
        return plan[:, 0] * self.normal[1] - plan[:, 1] * self.normal[0]

    def at(self, along: NDArray[np.floating]) -> Floats:
        """(N, 2) points of the line at coordinates (N,) along the tangent [m]."""
        return self.offset * self.normal + np.asarray(along, float)[:, None] * self.tangent


def find_lines(plan: Floats, normals: Floats, parameters: LineParameters) -> list[PlanLine]:
    """Find lines on which many points lie that face the same way, the richest direction first.

    Args:
        plan: (N, 2) points on vertical surfaces, evenly spread [m].
        normals: (N, 2) their normals.
        parameters: What a line is.
    """
    headings = np.arctan2(normals[:, 1], normals[:, 0])
    free = np.ones(len(plan), bool)
    middle = plan.mean(axis=0) if len(plan) else np.zeros(2)
    lines: list[PlanLine] = []
    for heading in _directions(headings, parameters):
        alike = np.cos(headings - heading) > np.cos(np.deg2rad(6))
        while True:
            near = np.flatnonzero(free & alike)
            rough = _strongest_offset(plan[near], heading, middle, parameters)
            if rough is None:
                break
            line = _refined(rough, plan[near], parameters)
            facing = normals[:, 0] * line.normal[0] + normals[:, 1] * line.normal[1] > np.cos(np.deg2rad(15))
            claimed = free & facing & (np.abs(line.depth(plan)) < parameters.thickness)
            claimed[near[np.abs(rough.depth(plan[near])) < parameters.thickness / 2]] = True  # never found twice
            free &= ~claimed
            lines.append(line)
    return lines


def _directions(headings: Floats, parameters: LineParameters) -> list[float]:
    """Headings [rad] in which many normals point, the richest first, refined to the middle of their peak."""
    fine = np.bincount((np.rad2deg(headings) * 10 % 3600).astype(int) % 3600, minlength=3600).astype(float)
    counts = fine.reshape(360, 10).sum(axis=1)
    smooth = np.sum([np.roll(counts, k) for k in (-2, -1, 0, 1, 2)], axis=0)
    found: list[float] = []
    while smooth.max() >= parameters.min_points:
        peak = int(np.argmax(smooth))
        tenth = peak * 10 + 5
        for _ in range(5):  # mean shift over a window of 5 deg
            window = np.arange(tenth - 25, tenth + 26)
            weights = fine[window % 3600]
            mean = float(np.sum(window * weights) / max(weights.sum(), 1.0))
            tenth = int(round(mean))
        found.append(float(np.deg2rad((mean + 0.5) / 10)))
        smooth[np.arange(peak - 3, peak + 4) % 360] = 0
    return found


def _strongest_offset(plan: Floats, heading: float, middle: Floats, parameters: LineParameters) -> PlanLine | None:
    """The line of a heading with most points; None if none has enough."""
    if len(plan) < parameters.min_points:
        return None
    normal = np.array([np.cos(heading), np.sin(heading)])
    offsets = (plan[:, 0] - middle[0]) * normal[0] + (plan[:, 1] - middle[1]) * normal[1]
    width = parameters.thickness / 2
    low = offsets.min() - 2 * width
    counts = np.bincount(((offsets - low) / width).astype(int) + 1)
    smooth = np.convolve(counts, np.ones(3), mode="same")
    peak = int(np.argmax(smooth))
    if smooth[peak] < parameters.min_points:
        return None
    middle_of_bin = low + (peak - 0.5) * width
    return PlanLine(normal, float(middle_of_bin + middle @ normal))


def _refined(line: PlanLine, plan: Floats, parameters: LineParameters) -> PlanLine:
    """Robust total least squares with Tukey weights that narrow to `softness`."""
    for width in (2 * parameters.thickness, parameters.thickness, *(3 * [parameters.softness])):
        depth = line.depth(plan)
        near = np.abs(depth) < width
        if np.count_nonzero(near) < 10:
            break
        weights = (1 - (depth[near] / width) ** 2) ** 2
        points = plan[near]
        middle = np.sum(points * weights[:, None], axis=0) / weights.sum()
        spread = np.einsum("ni,nj->ij", (points - middle) * weights[:, None], points - middle)
        normal = np.linalg.eigh(spread)[1][:, 0]
        if np.abs(normal @ line.normal) < 0.97:
            break  # a blob, not a line
        normal = normal * np.sign(normal @ line.normal)
        line = PlanLine(normal, float(normal @ middle))
    return line


@dataclass(frozen=True, eq=False)
class Columns:
    """A line's surface, column by column."""

    numbers: NDArray[np.int_]
    """(K,) column k spans k to k + 1 column widths along the line."""
    lows: Floats
    """(K,) least coordinate along the line [m]."""
    highs: Floats
    """(K,) greatest coordinate along the line [m]."""
    bottoms: Floats
    """(K,) height of the lowest point [m]."""
    tops: Floats
    """(K,) height of the highest point [m]."""
    rows: NDArray[np.int_]
    """(K,) number of occupied cells."""
    recessed: NDArray[np.bool_]
    """(K,) a like surface is close behind."""

    def chosen(self, which: NDArray[np.bool_]) -> Columns:
        """Those columns alone."""
        return Columns(*(getattr(self, field.name)[which] for field in fields(self)))


def columns_of(
    line: PlanLine, points: Floats, normals: Floats, heights: tuple[float, float], parameters: LineParameters
) -> Columns:
    """Divide the surface on a line into columns.

    Args:
        line: Where.
        points: (N, 3) points of any surface [m].
        normals: (N, 3) normals; NaN where the surface is not flat.
        heights: From just above the floor to just below the ceiling [m].
        parameters: Sizes.
    """
    depth = line.depth(points[:, :2])
    nearest, farthest = parameters.recess
    beside = np.flatnonzero(
        (depth < parameters.thickness) & (depth > -farthest) & (points[:, 2] > heights[0]) & (points[:, 2] < heights[1])
    )
    depth, z = depth[beside], points[beside, 2]
    facing = normals[beside, 0] * line.normal[0] + normals[beside, 1] * line.normal[1]
    along = line.along(points[beside, :2])
    column = np.floor(along / parameters.column).astype(int)
    on_line = (depth > -parameters.thickness) & (np.isnan(facing) | (facing > 0.8))
    behind = (depth < -nearest) & (facing > 0.97)

    facing_it, counts = np.unique(column[on_line & (facing > 0.8)], return_counts=True)
    firm = facing_it[counts >= 3]  # else it is the edge of something that only crosses the line
    on_line &= np.isin(column, np.concatenate([firm - 1, firm, firm + 1]))
    numbers = np.unique(column[on_line])
    place = np.searchsorted(numbers, column[on_line])
    bottoms, tops, lows, highs = np.full((4, len(numbers)), -np.inf)
    np.maximum.at(tops, place, z[on_line])
    np.maximum.at(bottoms, place, -z[on_line])
    np.maximum.at(highs, place, along[on_line])
    np.maximum.at(lows, place, -along[on_line])
    row = ((z[on_line] - heights[0]) / parameters.column).astype(int)
    cells = np.unique(place * 10000 + row)
    rows = np.bincount(cells // 10000, minlength=len(numbers))
    crowded, counts = np.unique(column[behind], return_counts=True)
    return Columns(numbers, -lows, highs, -bottoms, tops, rows, np.isin(numbers, crowded[counts >= 10]))
