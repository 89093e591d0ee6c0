"""From a room on paper to MJCF."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mission.bench.walls.doors import build_door
from mission.bench.walls.floor_plans import grown, reflex_corners, side_lengths
from mission.bench.walls.kit import Body, Kit
from mission.bench.walls.plans import Occluder, RoomPlan, WallPlan
from mission.bench.walls.shell import build_beyond, build_shell

_UNDER_WALLS = 0.05
"""How far floor and ceiling reach into the walls, so that no light falls between [m]."""
BURIED = 20.0
"""Below the floor, where nothing is seen [m]."""


@dataclass(frozen=True, eq=False)
class Building:
    """A room under construction: geometry is there, occluders may still be moved."""

    kit: Kit
    plan: RoomPlan
    position: tuple[float, float]
    """Of the plan's origin in the world [m]."""
    turn: float
    """Of the plan in the world [rad]."""
    leaves: dict[tuple[int, int], tuple[str, ...]]
    """Names of the bodies of the leaves by the numbers of wall and door."""
    occluders: dict[tuple[int, int], tuple[Body, ...]]
    """In all sizes, below the floor until one is fitted, by the numbers of wall and occluder."""

    def to_world(self, points: np.ndarray) -> np.ndarray:
        """Points (..., 2) of the plan in the world [m]."""
        c, s = np.cos(self.turn), np.sin(self.turn)
        return np.asarray(points @ np.array([[c, s], [-s, c]]) + self.position)


def build(plan: RoomPlan, rng: np.random.Generator) -> Building:
    """Build a room somewhere in the world, turned by chance."""
    kit = Kit()
    position = (float(rng.uniform(-30, 30)), float(rng.uniform(-30, 30)))
    turn = float(rng.uniform(-np.pi, np.pi))
    room = kit.spec.worldbody.add_body(name="building", pos=[*position, 0], quat=_about_z(turn))
    _build_floor_and_ceiling(kit, room, plan)
    leaves: dict[tuple[int, int], tuple[str, ...]] = {}
    occluders: dict[tuple[int, int], tuple[Body, ...]] = {}
    lengths, reflex = side_lengths(plan.corners), reflex_corners(plan.corners)
    for number, wall in enumerate(plan.walls):
        body = _add_wall_body(room, plan, number)
        beyond = [0.0 if reflex[k % len(reflex)] else 0.25 for k in (number, number + 1)]
        size = (float(lengths[number]), plan.height)
        build_shell(kit, body, wall, size, (beyond[0], beyond[1]))
        for index, door in enumerate(wall.doors):
            leaves[number, index] = build_door(kit, body, door, wall.thickness, f"door {number + 1}.{index + 1}")
        if wall.doors or wall.windows:
            build_beyond(kit, body, wall, size, rng)
        _build_things(kit, body, wall)
        for index, occluder in enumerate(wall.occluders):
            occluders[number, index] = _build_sizes(kit, body, occluder, f"occluder {number + 1}.{index + 1}")
    for x, y, turned, thing in plan.stood:
        thing.build(kit, room.add_body(pos=[x, y, 0], quat=_about_z(turned)))
    kit.spec.assets = kit.assets
    return Building(kit, plan, position, turn, leaves, occluders)


def _add_wall_body(room: Body, plan: RoomPlan, number: int) -> Body:
    start, end = plan.corners[number], plan.corners[(number + 1) % len(plan.corners)]
    turn = float(np.arctan2(end[1] - start[1], end[0] - start[0]))
    return room.add_body(name=f"wall {number + 1}", pos=[*start, 0], quat=_about_z(turn))


def _build_floor_and_ceiling(kit: Kit, room: Body, plan: RoomPlan) -> None:
    first = int(reflex_corners(plan.corners).argmax())
    corners = np.roll(grown(plan.corners, _UNDER_WALLS), -first, axis=0)
    kit.prism(room, corners, -0.1, 0.0, plan.floor)
    kit.prism(room, corners, plan.height, plan.height + 0.1, plan.ceiling)


def _build_things(kit: Kit, body: Body, wall: WallPlan) -> None:
    for hung in wall.hung:
        hung.thing.build(kit, body.add_body(pos=[hung.x, 0, hung.z]))
    for stood in wall.stood:
        thing = body.add_body(pos=[stood.x, -stood.away, 0], quat=_about_z(stood.turned))
        stood.thing.build(kit, thing)


def _build_sizes(kit: Kit, wall: Body, occluder: Occluder, name: str) -> tuple[Body, ...]:
    bodies = []
    for size, thing in enumerate(occluder.sizes, start=1):
        bodies.append(wall.add_body(name=f"{name} size {size}", pos=[0.0, 0.0, -BURIED]))
        thing.build(kit, bodies[-1])
    return tuple(bodies)


def _about_z(turn: float) -> list[float]:
    return [float(np.cos(turn / 2)), 0.0, 0.0, float(np.sin(turn / 2))]
