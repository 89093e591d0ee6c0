"""Which of several lines in plan a surface belongs to: lines that cross, and what stands little before a wall."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from mission.plan_lines import Columns, LineParameters, PlanLine

_PROUD = (0.04, 0.2)
"""What stands out from a wall by this much may be a part of it or stand before it [m]."""
_CROSSING = np.cos(np.radians(15.0))
"""Lines at a smaller angle share points for a long way about where they cross [cosine]."""


def on_one_line(lines: Sequence[PlanLine], surfaces: Sequence[Columns], parameters: LineParameters) -> list[Columns]:
    """Leave out what lies on a longer line, too: that of a leaf ajar meets its wall's plane beside the door, at an
    angle so small that half a metre of the wall is on both."""
    kept = []
    for line, columns in zip(lines, surfaces, strict=True):
        own = len(columns.numbers)
        for other, longer in zip(lines, surfaces, strict=True):
            if len(longer.numbers) > own and line.normal @ other.normal > _CROSSING:
                columns = columns.chosen(np.abs(other.depth(_spots(line, columns, parameters))) > parameters.thickness)
        kept.append(columns)
    return kept


def set_back(lines: Sequence[PlanLine], surfaces: Sequence[Columns], parameters: LineParameters) -> list[Columns]:
    """Leave out what stands little before a wall of which more is seen: pilasters, curtains, pipes."""
    kept = []
    for line, columns in zip(lines, surfaces, strict=True):
        spots = _spots(line, columns, parameters)
        for other, behind in zip(lines, surfaces, strict=True):
            depth = other.depth(spots)
            before = (depth > _PROUD[0]) & (depth < _PROUD[1]) & (line.normal @ other.normal > 0.99)
            if before.any() and _is_part_of(columns.chosen(before), other.along(spots[before]), behind):
                columns, spots = columns.chosen(~before), spots[~before]
        kept.append(columns)
    return kept


def _spots(line: PlanLine, columns: Columns, parameters: LineParameters) -> NDArray[np.float64]:
    """(K, 2) middles of columns in plan [m]."""
    return line.at((columns.numbers + 0.5) * parameters.column)


def _is_part_of(columns: Columns, along: NDArray[np.floating], wall: Columns) -> bool:
    """Whether columns, at coordinates (K,) along a wall little behind them, stand before it: more of the wall shows
    between them, or it goes on beyond both ends. A wall that only begins where they end is a step in the plan."""
    between = np.count_nonzero((wall.lows > along.min()) & (wall.highs < along.max()))
    beyond = np.count_nonzero(wall.highs < along.min()), np.count_nonzero(wall.lows > along.max())
    own = len(columns.numbers)
    return bool(between > own or (min(beyond) >= 3 and sum(beyond) > own))
