"""Slide what is to hide doors along the walls until it hides as much as it should, and measure what it hides."""

from __future__ import annotations

from collections.abc import Mapping

import mujoco
import numpy as np
from numpy.typing import NDArray

from mission.bench.walls.building import Building
from mission.bench.walls.floor_plans import side_lengths
from mission.bench.walls.hidden import Hidden, hidden_shares
from mission.bench.walls.plans import DoorPlan, Occluder, WallPlan
from sim.rays import Rays

MOST_HIDDEN = Hidden(panel=0.40, frame=0.50)
"""By section 7.4 of the paper."""

_TRIES = 10
"""Places on each side of a door that are tried for an occluder."""
_CORNER = 0.9
"""Kept free at the right end of a wall, so that things do not meet round the corner [m]."""


def fit_occluders(building: Building, origins: NDArray[np.float64]) -> Mapping[tuple[int, int], Hidden]:
    """Move the occluders of a building to where they hide most nearly what they should, within the paper's limits.

    Args:
        building: its occluders are moved.
        origins: (K, 3) of the beams of all scans in world [m].

    Returns:
        What is hidden of each door, by the numbers of wall and door.
    """
    model = building.kit.spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    rays = Rays(model, data, _passed(building, model))
    lengths = side_lengths(building.plan.corners)
    for (number, index), body in building.occluders.items():
        wall = building.plan.walls[number]
        occluder = wall.occluders[index]
        errors = {}
        for x in places_for(wall, occluder, float(lengths[number])):
            model.body(body.name).pos[0] = x
            mujoco.mj_kinematics(model, data)
            hidden = hidden_shares(rays, _face(data, number, wall.doors[occluder.door]), origins)
            if hidden.panel <= MOST_HIDDEN.panel and hidden.frame <= MOST_HIDDEN.frame:
                errors[x] = abs(hidden.panel - occluder.share)
        if not errors:
            raise ValueError(f"no place for the occluder of door {occluder.door + 1} in wall {number + 1}")
        x = min(errors, key=lambda x: errors[x])
        model.body(body.name).pos[0] = x
        body.pos = [x, *body.pos[1:]]
    mujoco.mj_kinematics(model, data)
    doors = {(number, index): building.plan.walls[number].doors[index] for number, index in building.leaves}
    return {key: hidden_shares(rays, _face(data, key[0], door), origins) for key, door in doors.items()}


def places_for(wall: WallPlan, occluder: Occluder, length: float) -> list[float]:
    """Where the middle of an occluder may stand along its wall [m]: partly before its door, and before no other."""
    door, half = wall.doors[occluder.door], occluder.thing.width / 2
    others = [other.reach for other in wall.doors if other is not door]
    found = []
    for covered in np.linspace(0.05, occluder.most, _TRIES) * door.width:
        for x in (float(door.left + covered - half), float(door.right - covered + half)):
            free = all(x + half < low or x - half > high for low, high in others)
            if free and x - half > 0.02 and x + half < length - _CORNER:
                found.append(x)
    return found


def _passed(building: Building, model: mujoco.MjModel) -> frozenset[int]:
    """Bodies that are no furniture."""
    walls = (f"wall {number + 1}" for number in range(len(building.plan.walls)))
    leaves = (name for names in building.leaves.values() for name in names)
    return frozenset(model.body(name).id for name in ("building", *walls, *leaves))


def _face(data: mujoco.MjData, number: int, door: DoorPlan) -> NDArray[np.float64]:
    """(4, 3) corners of a closed door's face in world, seen from inside: bottom left, bottom right, top right, left."""
    depth = min(door.recess, 0.0)
    low, high = door.bottom, door.height
    corners = np.array(
        [[door.left, depth, low], [door.right, depth, low], [door.right, depth, high], [door.left, depth, high]]
    )
    wall = data.body(f"wall {number + 1}")
    return np.asarray(corners @ wall.xmat.reshape(3, 3).T + wall.xpos)
