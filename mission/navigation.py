"""Ways that the robot can take: turning points joined by straight legs.

The robot is an oblong that turns on the spot, so two kinds of room are needed. Where it turns, the disc that its half
diagonal sweeps must be free; where it drives straight, only a band as wide as its body. The road map is made of exactly
these: points whose disc is free, and between them legs whose band is free (the body's ends stay within the discs at
the leg's ends). Legs have any direction, so that the robot passes a gap hardly wider than itself, also in a rotated
building, but never turns in it. One Dijkstra search finds the ways to all points, which the planner of scans needs.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from mission.exits import ExitParameters
from mission.following import DrivingParameters
from mission.grid import Cell, Footprint, GridParameters, OccupancyGrid
from mission.localisation import LocalisationParameters
from mission.plan_polygon import within_polygon
from sim.parameters import Parameters


class NavigationParameters(Parameters):
    """How the robot finds and follows its way."""

    margin: float = Field(
        default=0.08,
        ge=0.0,
        le=0.5,
        description="Kept clear around the body [m]: 5 cm wanted, 3 cm of odometry drift and tracking",
    )
    spacing: float = Field(
        default=0.25, ge=0.1, le=1.0, description="One turning point in each square of this side [m]"
    )
    max_leg: float = Field(
        default=2.0, ge=0.5, le=5.0, description="Of the road map [m]; ways are straightened afterwards"
    )
    turn_cost: float = Field(default=0.2, ge=0.0, le=5.0, description="Price of a turning point in metres of way")
    comfort: float = Field(
        default=0.25, ge=0.0, le=1.0, description="Clearance beyond the margin that is worth a detour [m]"
    )
    escape: float = Field(
        default=1.5, ge=0.0, le=5.0, description="Furthest straight move out of a spot too tight to turn in [m]"
    )
    exits: ExitParameters = ExitParameters()
    grid: GridParameters = GridParameters()
    driving: DrivingParameters = DrivingParameters()
    localisation: LocalisationParameters = LocalisationParameters()


@dataclass(frozen=True, eq=False)
class RoadMap:
    """Turning points and the best way to each from where the robot stands."""

    points: NDArray[np.float64]
    """(K, 2) in the world [m]; the first is the robot's own position."""
    metres: NDArray[np.float64]
    """(K,) length of the way there [m]; infinite where there is none."""
    before: NDArray[np.intp]
    """(K,) index of the point before on the way, -1 for the first and for points without a way."""
    grid: OccupancyGrid
    turns_at_start: bool
    """False where the robot must leave its spot straight ahead or back before it can turn."""
    comfortable: float
    """Clearance beyond which more is not worth a detour [m]."""

    def path_to(self, index: int) -> NDArray[np.float64] | None:
        """(P, 2) way points from the robot to a point, straightened [m]; None if there is no way."""
        if not np.isfinite(self.metres[index]):
            return None
        steps = [index]
        while self.before[steps[-1]] >= 0:
            steps.append(int(self.before[steps[-1]]))
        return self._straightened(self.points[steps[::-1]])

    def _straightened(self, path: NDArray[np.float64]) -> NDArray[np.float64]:
        """Leave out way points where the straight leg is as clear as the way round, or comfortably clear."""
        legs = _leg_clearance(self.grid, path[:-1], path[1:])
        kept = [0]
        while kept[-1] < len(path) - 1:
            first = kept[-1]
            ends = np.arange(first + 1, len(path))
            shortcut = _leg_clearance(self.grid, np.broadcast_to(path[first], (len(ends), 2)), path[ends])
            enough = np.minimum(np.minimum.accumulate(legs[first:]), self.comfortable)
            allowed = shortcut >= enough - 1e-6
            allowed[0] = True
            if first == 0 and not self.turns_at_start:
                allowed[1:] = False
            kept.append(int(ends[allowed][-1]))
        return path[kept]


def road_map(
    grid: OccupancyGrid,
    world_from_base: NDArray[np.float64],
    *,
    footprint: Footprint,
    goals: NDArray[np.float64] | None = None,
    within: NDArray[np.float64] | None = None,
    parameters: NavigationParameters | None = None,
) -> RoadMap:
    """Find the turning points and the ways to them.

    If the robot cannot turn where it stands, it first moves straight ahead or back to the nearest spot where it can;
    failing that it turns in place, provided that nothing known stands in its disc; failing that it moves straight past
    what is unknown in its disc.

    Args:
        world_from_base: (4, 4) pose of the robot.
        footprint: Of the robot.
        goals: (G, 2) further points wanted on the map, after the robot's own and before the raster; one whose disc is
            not free gets no way.
        within: (P, 2) polygon around the points of the raster [m]; everywhere by default.
    """
    parameters = parameters or NavigationParameters()
    turning, needed = footprint.half_diagonal + parameters.margin, footprint.width / 2 + parameters.margin
    goals = np.empty((0, 2)) if goals is None else np.asarray(goals, dtype=np.float64).reshape(-1, 2)
    start = np.asarray(world_from_base, dtype=np.float64)[:2, 3]
    turns_at_start = bool(grid.clearance_at(start) >= turning)
    escape = np.empty((0, 2)) if turns_at_start else _way_out(grid, world_from_base, footprint, parameters)
    if not turns_at_start and len(escape) == 0:
        grid = _trusting(grid, start, turning)
        turns_at_start = bool(grid.clearance_at(start) >= turning)
        if not turns_at_start:
            escape = _way_out(grid, world_from_base, footprint, parameters)
    raster = _roomiest_points(grid, parameters.spacing, turning)
    if within is not None:
        raster = raster[within_polygon(raster, within)]
    points = np.concatenate([start[None], goals, raster, escape])

    usable = np.flatnonzero(grid.clearance_at(points) >= turning)
    first, second, clear = _legs(grid, points, usable, longest=parameters.max_leg, needed=needed)
    if len(escape):
        first, second = np.append(first, 0), np.append(second, len(points) - 1)
        clear = np.append(clear, np.float32(needed))
    metres, before = _shortest(
        points, first, second, price=_price(clear, needed, parameters), per_leg=parameters.turn_cost
    )
    return RoadMap(
        points=points,
        metres=metres,
        before=before,
        grid=grid,
        turns_at_start=turns_at_start,
        comfortable=needed + parameters.comfort,
    )


def plan_path(
    grid: OccupancyGrid,
    world_from_base: NDArray[np.float64],
    goal: NDArray[np.float64],
    *,
    footprint: Footprint,
    parameters: NavigationParameters | None = None,
) -> NDArray[np.float64] | None:
    """(P, 2) way points from the robot's position to a (2,) goal [m]; None if there is no way.

    The goal must leave room to turn. Arguments as in `road_map`.
    """
    roads = road_map(grid, world_from_base, footprint=footprint, goals=np.asarray(goal)[None], parameters=parameters)
    return roads.path_to(1)


def _roomiest_points(grid: OccupancyGrid, spacing: float, needed: float) -> NDArray[np.float64]:
    """(K, 2) the cell of the greatest clearance in each square of the raster, where that is enough."""
    side = max(round(spacing / grid.resolution), 1)
    rows, columns = grid.cells.shape
    padded = np.pad(grid.clearance, ((0, -rows % side), (0, -columns % side)))
    squares = padded.reshape(padded.shape[0] // side, side, -1, side).swapaxes(1, 2)
    best = squares.reshape(*squares.shape[:2], -1).argmax(axis=2)
    row = np.arange(squares.shape[0])[:, None] * side + best // side
    column = np.arange(squares.shape[1])[None, :] * side + best % side
    enough = padded[row, column] >= needed
    return grid.origin + (np.stack([column[enough], row[enough]], axis=-1) + 0.5) * grid.resolution


def _way_out(
    grid: OccupancyGrid,
    world_from_base: NDArray[np.float64],
    footprint: Footprint,
    parameters: NavigationParameters,
) -> NDArray[np.float64]:
    """(0 or 1, 2) the nearest point straight ahead or back where the robot can turn."""
    start, ahead = world_from_base[:2, 3], world_from_base[:2, 0] / np.hypot(*world_from_base[:2, 0])
    steps = np.arange(0.0, parameters.escape + 1e-9, grid.resolution)
    ways = start + steps[:, None] * np.array([1.0, -1.0])[:, None, None] * ahead  # (2, steps, 2): ahead and back
    clear = grid.clearance_at(ways)
    # The spot itself may be tighter than the margin: leaving it must not make that worse.
    tightest = max(min(footprint.width / 2 + parameters.margin, clear[0, 0]), footprint.width / 2 - grid.resolution)
    passable = np.logical_and.accumulate(clear >= tightest - 1e-6, axis=1)
    reached = passable & (clear >= footprint.half_diagonal + parameters.margin)
    found = sorted(np.argwhere(reached).tolist(), key=lambda way_and_step: way_and_step[1])
    return np.array([ways[way, step] for way, step in found[:1]]).reshape(-1, 2)


def _trusting(grid: OccupancyGrid, start: NDArray[np.float64], turning: float) -> OccupancyGrid:
    """The grid with the unknown cells of the robot's own turning disc taken for free.

    The flanks of the robot lie in no sensor's view; where they are all that keeps it from turning, it turns, and the
    Hokuyos watch.
    """
    offsets = grid.centres() - start
    disc = np.hypot(offsets[..., 0], offsets[..., 1]) <= turning + 2 * grid.resolution
    return replace(grid, cells=np.where(disc & (grid.cells == Cell.UNKNOWN), np.uint8(Cell.FREE), grid.cells))


def _legs(
    grid: OccupancyGrid, points: NDArray[np.float64], usable: NDArray[np.intp], *, longest: float, needed: float
) -> tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.float32]]:
    """Both ends (L,), (L,) and the clearance (L,) [m] of every leg between usable points whose band is free."""
    from scipy.spatial import cKDTree

    pairs = np.empty((0, 2), np.intp)
    if len(usable) > 1:
        pairs = cKDTree(points[usable]).query_pairs(longest, output_type="ndarray")
        pairs = usable[pairs[np.lexsort(pairs.T)]]
    clear = _leg_clearance(grid, points[pairs[:, 0]], points[pairs[:, 1]])
    allowed = clear >= needed
    return pairs[allowed, 0], pairs[allowed, 1], clear[allowed]


def _leg_clearance(grid: OccupancyGrid, starts: NDArray[np.float64], ends: NDArray[np.float64]) -> NDArray[np.float32]:
    """(L,) the least clearance along each straight leg between (L, 2) starts and ends [m]."""
    if len(starts) == 0:
        return np.empty(0, np.float32)
    longest = np.hypot(*(ends - starts).T).max()
    share = np.linspace(0, 1, int(np.ceil(longest / grid.resolution)) + 2)
    chunks = range(0, len(starts), 20_000)
    return np.concatenate(
        [
            grid.clearance_at(a[:, None] + share[:, None] * (b - a)[:, None]).min(axis=1)
            for a, b in ((starts[i : i + 20_000], ends[i : i + 20_000]) for i in chunks)
        ]
    )


def _price(clear: NDArray[np.float32], needed: float, parameters: NavigationParameters) -> NDArray[np.float64]:
    """(L,) factor on a leg's length: 1 where comfortably clear, up to 2 where it only just fits."""
    if parameters.comfort == 0:
        return np.ones(len(clear))
    return 2.0 - np.clip((clear.astype(np.float64) - needed) / parameters.comfort, 0.0, 1.0)


def _shortest(
    points: NDArray[np.float64],
    first: NDArray[np.intp],
    second: NDArray[np.intp],
    *,
    price: NDArray[np.float64],
    per_leg: float,
) -> tuple[NDArray[np.float64], NDArray[np.intp]]:
    """Length of the best way from point 0 to each point (K,) [m], and the point before it (K,)."""
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import dijkstra

    length = np.hypot(*(points[second] - points[first]).T)
    size = len(points)
    costs = csr_array((length * price + per_leg + 1e-9, (first, second)), shape=(size, size))
    cost, before = dijkstra(costs, directed=False, indices=0, return_predecessors=True)
    metres = np.full(size, np.inf)
    metres[0] = 0.0
    for point in np.argsort(cost, kind="stable")[1 : int(np.isfinite(cost).sum())]:
        metres[point] = metres[before[point]] + np.hypot(*(points[point] - points[before[point]]))
    return metres, np.maximum(before, -1).astype(np.intp)
