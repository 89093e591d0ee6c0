"""Where MoPAD starts: at a site, or at the freest spot inside a room of a scene that says nothing about it."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace

import mujoco
import numpy as np

from sim.errors import SimError
from sim.rays import Rays, horizontal

WALL_REACH = 15.0
"""A start without anything as high as the scanner within this distance is not in a building [m]."""
FLOOR_REACH = 3.0
"""A site may hover this high above the floor that it means [m]."""
HEADROOM = 1.5
"""Free height that MoPAD needs: the camera's top is at 1.43 m [m]."""
TURNING_RADIUS = 0.6
"""Half the diagonal of the footprint is 0.56 m [m]."""

_BODY_HEIGHTS = (0.06, 0.15, 0.3, 0.45, 0.65, 0.9, 1.15, 1.4)
_WALL_HEIGHTS = (1.15, 1.45)
_SLOPES = np.radians([10, 20, 30, 40, 50, 60, 70, 80])
_COARSE = (12, (0.3, 0.9))
_FINE = (120, _BODY_HEIGHTS)
_FREE_ENOUGH = 4.0
"""Where nothing stands nearer than this, no place is freer than another [m]."""
_MAX_COLUMNS = 8_000
_MOST_ASSESSED = 400
_FINEST_GRID = 0.4
_REFINED = 5


@dataclass(frozen=True)
class Spot:
    """A place on a floor, and how it suits a scanning robot."""

    position: np.ndarray
    """(3,) on the floor, in world [m]."""
    enclosure: float
    """Share of the horizontal directions in which something as high as the scanner stands within 15 m."""
    covered: bool
    """Whether there is a ceiling overhead."""
    clearance: float = 0.0
    """Horizontal distance to the nearest thing at any height of the robot, at most 4 m [m]."""
    heading: float = 0.0
    """Direction with the longest free way [rad]."""

    @property
    def indoors(self) -> int:
        """How surely this is inside a room: a courtyard or a lawn beside the house comes after any room."""
        return 2 * (self.enclosure >= 0.8) + (self.enclosure >= 0.6) + self.covered


def pose_on_floor(rays: Rays, position: np.ndarray, heading: np.ndarray) -> np.ndarray:
    """World pose (4, 4) of the robot's base on the floor below a point (3,), facing along a direction (3,).

    Raises:
        SimError: there is no floor under the point.
    """
    floor = rays.floor_below(position + [0, 0, 0.3], FLOOR_REACH + 0.3)
    if floor is None:
        raise SimError(f"no floor under the start: nothing within {FLOOR_REACH:.0f} m below {_at(position)}")
    return upright_pose(np.array([*position[:2], floor]), float(np.arctan2(heading[1], heading[0])))


def freest_spot(model: mujoco.MjModel, data: mujoco.MjData, rays: Rays) -> np.ndarray:
    """World pose (4, 4) of the robot's base on the floor with most free space around it inside a room.

    Names say nothing and floors may lie at any height, so the scene is probed: columns of downward rays give all
    surfaces that one could stand on, fans of horizontal rays say how free and how enclosed each of them is, and a
    look at the ground around tells a floor from the top of a table.

    Raises:
        SimError: no floor, no walls, or no room for the robot.
    """
    standing = _standing_points(model, data, rays)
    spots = [spot for spot in (_glance(rays, point, covered) for point, covered in standing) if spot.enclosure > 0]
    if not spots and not any(_supported(rays, point) for point, _ in standing):
        raise SimError(f"no floor under the start: the scene has no level surface with {HEADROOM} m of free height")
    if not spots:
        raise SimError(f"no wall within {WALL_REACH:.0f} m of the start: nothing as high as the scanner stands around")
    grid = _grid_step(*_bounds(model, data))
    for indoors in sorted({spot.indoors for spot in spots}, reverse=True):
        alike = [spot for spot in spots if spot.indoors == indoors]
        alike = [_assess(rays, spot, _COARSE) for spot in alike[:: 1 + len(alike) // _MOST_ASSESSED]]
        refined = [_refine(rays, spot, grid) for spot in _apart(alike, grid)]
        good = [spot for spot in refined if spot.clearance >= TURNING_RADIUS and _on_a_floor(rays, spot)]
        if good:
            best = max(good, key=lambda spot: spot.clearance)
            return upright_pose(best.position, best.heading)
    raise SimError(f"no free spot to start from: MoPAD needs {2 * TURNING_RADIUS} m of free floor inside a room")


def require_surroundings(rays: Rays, world_from_base: np.ndarray, footprint: tuple[float, float]) -> None:
    """Check that walls are near a start pose and that no furniture stands within the footprint.

    Args:
        rays: casts against the scene without the robot.
        world_from_base: (4, 4) pose on the floor.
        footprint: length and width [m].

    Raises:
        SimError: saying what is wrong and where.
    """
    position = world_from_base[:3, 3]
    azimuths = np.radians(np.arange(0, 360, 2.5))
    if not np.any(_distances(rays, position, azimuths, _WALL_HEIGHTS) < WALL_REACH):
        raise SimError(f"no wall within {WALL_REACH:.0f} m of the start at {_at(position)}")
    yaw = np.arctan2(world_from_base[1, 0], world_from_base[0, 0])
    with np.errstate(divide="ignore"):
        border = np.minimum(
            footprint[0] / 2 / np.abs(np.cos(azimuths - yaw)), footprint[1] / 2 / np.abs(np.sin(azimuths - yaw))
        )
    for height in _BODY_HEIGHTS:
        hits = rays.cast(position + [0, 0, height], horizontal(azimuths))
        inside = hits.distances < border
        if inside.any():
            raise SimError(f"the start at {_at(position)} is inside {rays.name(int(hits.geoms[inside][0]))}")
    above = rays.cast(position + [0, 0, _BODY_HEIGHTS[0]], np.array([[0.0, 0, 1]]), HEADROOM - _BODY_HEIGHTS[0])
    if np.isfinite(above.distances[0]):
        raise SimError(f"the start at {_at(position)} is inside {rays.name(int(above.geoms[0]))}")


def set_down_poses(
    model: mujoco.MjModel, data: mujoco.MjData, rays: Rays, footprint: tuple[float, float]
) -> dict[str, np.ndarray]:
    """World poses (4, 4) of the base at the sites `start_2`, `start_3`..., by their names, in the order of the numbers.

    Raises:
        SimError: there is no floor under one, no wall around it, or something in the way; says which.
    """
    named = ((model.site(site).name, site) for site in range(model.nsite))
    numbered = [(int(match[1]), site) for name, site in named if (match := re.fullmatch(r"start_(\d+)", name))]
    poses = {}
    for _, site in sorted(pair for pair in numbered if pair[0] > 1):
        name = model.site(site).name
        try:
            pose = pose_on_floor(rays, data.site_xpos[site], data.site_xmat[site].reshape(3, 3)[:, 0])
            require_surroundings(rays, pose, footprint)
        except SimError as error:
            raise SimError(f"site {name}: {error}") from None
        poses[name] = pose
    return poses


def upright_pose(position: np.ndarray, heading: float) -> np.ndarray:
    """Pose (4, 4) at a position (3,) in world, turned about the vertical by a heading [rad]."""
    cosine, sine = np.cos(heading), np.sin(heading)
    pose = np.eye(4)
    pose[:2, :2] = [[cosine, -sine], [sine, cosine]]
    pose[:3, 3] = position
    return pose


def _bounds(model: mujoco.MjModel, data: mujoco.MjData) -> tuple[np.ndarray, np.ndarray]:
    """Lowest and highest corner (3,) of everything finite in the scene."""
    finite = ~np.isin(model.geom_type, [mujoco.mjtGeom.mjGEOM_PLANE])
    if not finite.any():
        raise SimError(f"no wall within {WALL_REACH:.0f} m of the start: the scene has nothing but planes")
    rotations = data.geom_xmat.reshape(-1, 3, 3)[finite]
    centres = data.geom_xpos[finite] + np.einsum("nij,nj->ni", rotations, model.geom_aabb[finite, :3])
    halves = np.einsum("nij,nj->ni", np.abs(rotations), model.geom_aabb[finite, 3:])
    return (centres - halves).min(0), (centres + halves).max(0)


def _grid_step(lowest: np.ndarray, highest: np.ndarray) -> float:
    area = float(np.prod(np.maximum(highest - lowest, _FINEST_GRID)[:2]))
    return max(_FINEST_GRID, float(np.sqrt(area / _MAX_COLUMNS)))


def _standing_points(model: mujoco.MjModel, data: mujoco.MjData, rays: Rays) -> list[tuple[np.ndarray, bool]]:
    """Points on level surfaces with headroom, and whether something is overhead."""
    lowest, highest = _bounds(model, data)
    step = _grid_step(lowest, highest)
    points = []
    for x in np.arange(lowest[0] + step / 2, highest[0], step):
        for y in np.arange(lowest[1] + step / 2, highest[1], step):
            for height, free in rays.down(float(x), float(y), highest[2] + 1, lowest[2] - 10):
                if free >= HEADROOM:
                    points.append((np.array([x, y, height]), bool(np.isfinite(free))))
    return points


def _distances(
    rays: Rays, position: np.ndarray, azimuths: np.ndarray, heights: Sequence[float], cutoff: float = WALL_REACH
) -> np.ndarray:
    """Distances (azimuths,) [m] from above a point of the floor to what stands around, at most the cutoff."""
    directions = horizontal(azimuths)
    found = [rays.cast(position + [0, 0, height], directions, cutoff).distances for height in heights]
    return np.minimum(found, cutoff).min(0)


def _overhang(rays: Rays, position: np.ndarray, azimuths: np.ndarray) -> np.ndarray:
    """Horizontal distances (azimuths,) [m] to boards at the robot's height, which level rays pass above and below."""
    directions = np.cos(_SLOPES)[:, None, None] * horizontal(azimuths) + np.sin(_SLOPES)[:, None, None] * [0, 0, 1]
    hits = rays.cast(position + [0, 0, _BODY_HEIGHTS[0]], directions.reshape(-1, 3), _FREE_ENOUGH)
    distances = hits.distances.reshape(len(_SLOPES), -1)
    level = np.where(distances * np.sin(_SLOPES)[:, None] < HEADROOM, distances * np.cos(_SLOPES)[:, None], np.inf)
    return np.minimum(level.min(0), _FREE_ENOUGH)


def _glance(rays: Rays, position: np.ndarray, covered: bool) -> Spot:
    azimuths = np.linspace(0, 2 * np.pi, 12, endpoint=False)
    walls = _distances(rays, position, azimuths, _WALL_HEIGHTS[:1])
    return Spot(position, float(np.mean(walls < WALL_REACH)), covered)


def _assess(rays: Rays, spot: Spot, look: tuple[int, Sequence[float]]) -> Spot:
    """Add how free a spot is, seen in so many directions at such heights."""
    azimuths = np.linspace(0, 2 * np.pi, look[0], endpoint=False)
    free = _distances(rays, spot.position, azimuths, look[1], _FREE_ENOUGH)
    boards = _overhang(rays, spot.position, azimuths[:: look[0] // 12])
    return replace(spot, clearance=float(min(free.min(), boards.min())), heading=float(azimuths[free.argmax()]))


def _apart(spots: list[Spot], grid: float) -> list[Spot]:
    """The freest spots, none of them a neighbour of another."""
    chosen: list[Spot] = []
    for spot in sorted(spots, key=lambda spot: spot.clearance, reverse=True):
        if all(np.linalg.norm(spot.position - other.position) > 1.5 * grid + TURNING_RADIUS for other in chosen):
            chosen.append(spot)
        if len(chosen) == _REFINED:
            break
    return chosen


def _refine(rays: Rays, spot: Spot, step: float) -> Spot:
    """Climb to the locally freest place, with a fan dense enough to meet the leg of a chair."""
    best = _assess(rays, spot, _FINE)
    while step > 0.05:
        step /= 2
        for dx, dy in ((step, 0), (-step, 0), (0, step), (0, -step)):
            floor = rays.floor_below(best.position + [dx, dy, 0.5], 0.6)
            if floor is not None and abs(floor - best.position[2]) < 0.03:
                position = np.array([*(best.position[:2] + [dx, dy]), floor])
                best = max(best, _assess(rays, replace(spot, position=position), _FINE), key=lambda one: one.clearance)
    return best


def _on_a_floor(rays: Rays, spot: Spot) -> bool:
    """Whether the ground around a spot goes on level, as it does not around a table's or a cabinet's top."""
    azimuths = np.linspace(0, 2 * np.pi, 16, endpoint=False)
    reach = _distances(rays, spot.position, azimuths, _BODY_HEIGHTS[:2], 4.0)
    level = []
    for share in (0.3, 0.6, 0.9):
        for direction, distance in zip(horizontal(azimuths), reach, strict=True):
            floor = rays.floor_below(spot.position + share * distance * direction + [0, 0, 0.05], 1e3)
            level.append(floor is not None and abs(floor - spot.position[2]) < 0.1)
    return _supported(rays, spot.position) and float(np.mean(level)) > 0.7


def _supported(rays: Rays, position: np.ndarray) -> bool:
    """Whether the ground carries the whole robot."""
    around = 0.9 * TURNING_RADIUS * horizontal(np.linspace(0, 2 * np.pi, 16, endpoint=False)) + [0, 0, 0.05]
    return all(rays.floor_below(position + point, 0.1) is not None for point in around)


def _at(position: np.ndarray) -> str:
    return f"({position[0]:.2f}, {position[1]:.2f}, {position[2]:.2f})"
