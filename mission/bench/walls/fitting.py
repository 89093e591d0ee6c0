"""Slide what is to hide doors along the walls until it hides as much as it should, and measure what it hides."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from mission.bench.walls.building import BURIED, Building
from mission.bench.walls.floor_plans import side_lengths
from mission.bench.walls.hidden import Hidden, hidden_shares
from mission.bench.walls.kit import Body
from mission.bench.walls.plans import DoorPlan, WallPlan
from sim.openings import fit
from sim.rays import Rays

MOST_PANEL_HIDDEN, MOST_FRAME_HIDDEN = 0.40, 0.50
"""By section 7.4 of the paper."""
MOST_SIDE_HIDDEN = 0.60
"""Of each of the frame's sides. Section 6.2 of the paper permits 40 %, with which no half of a frame could be hidden;
with more, or with an upper corner hidden, nothing in the scans would tell where the side is."""

_STEP = 0.07
"""Between the places that are tried for an occluder [m]."""
_MOST_OFF = 0.25
"""Between what is hidden of panel and frame together and what should be."""
_ROUNDS = 3
"""How often an occluder is moved that hides too much together with those put up after it."""
CORNER = 0.9
"""Kept free at the right end of a wall, so that things do not meet round the corner [m]."""


class NoPlaceError(ValueError):
    """An occluder leaves too little of its door in sight, wherever it stands."""


def fit_occluders(building: Building, origins: NDArray[np.float64]) -> Mapping[tuple[int, int], Hidden]:
    """Put up each occluder of a building in the size and place in which it hides most nearly what it should.

    Args:
        building: its occluders are moved, and those of other sizes deleted.
        origins: (K, 3) of the beams of all scans in world [m].

    Returns:
        What is hidden of each door, by the numbers of wall and door.

    Raises:
        NoPlaceError: a door would not be fair, see `is_fair`, or too little of it free to count as one.
    """
    model = building.kit.spec.compile()
    data = mujoco.MjData(model)
    leaves = frozenset(model.body(name).id for names in building.leaves.values() for name in names)
    past_walls = Rays(model, data, leaves | _walls(building, model))
    trial = _Trial(building, model, data, past_walls, Rays(model, data, leaves), origins)
    chosen: dict[tuple[int, int], int] = {}
    unfair = list(building.occluders)
    for _ in range(_ROUNDS):
        chosen |= {key: _fit(trial, *key) for key in unfair}
        unfair = [key for key in building.occluders if not trial.is_good(*key)]
    if unfair:
        raise NoPlaceError(f"occluders of {len(unfair)} doors are in each other's way")
    for key, size in chosen.items():
        bodies = building.occluders[key]
        for body in bodies[:size] + bodies[size + 1 :]:
            building.kit.spec.delete(body)
    return {(number, index): trial.hidden(number, index) for number, index in building.leaves}


@dataclass(frozen=True, eq=False)
class _Trial:
    """A building whose occluders can be moved."""

    building: Building
    model: mujoco.MjModel
    data: mujoco.MjData
    past_walls: Rays
    """Against furniture."""
    past_leaves: Rays
    """Against all but the doors."""
    origins: NDArray[np.float64]

    def put(self, body: Body, place: tuple[float, float, float]) -> None:
        body.pos = self.model.body(body.name).pos[:] = place

    def is_good(self, number: int, index: int) -> bool:
        """Whether the door of a wall's occluder is fair, and one that the simulator's truth knows as a door."""
        return is_fair(self.hidden_by(number, index)) and self.is_doorway(number, index)

    def is_doorway(self, number: int, index: int) -> bool:
        """Whether the door of a wall's occluder has enough free way before it to count as one."""
        mujoco.mj_kinematics(self.model, self.data)
        wall = self.building.plan.walls[number]
        return fit(self.past_leaves, _face(self.data, number, wall.doors[wall.occluders[index].door])).closes

    def hidden_by(self, number: int, index: int) -> Hidden:
        """What is hidden of the door of a wall's occluder."""
        return self.hidden(number, self.building.plan.walls[number].occluders[index].door)

    def hidden(self, number: int, index: int) -> Hidden:
        """What is hidden of a wall's door."""
        mujoco.mj_kinematics(self.model, self.data)
        door = self.building.plan.walls[number].doors[index]
        return hidden_shares(self.past_walls, _face(self.data, number, door), self.origins)


def _fit(trial: _Trial, number: int, index: int) -> int:
    """Put an occluder where it fits best among all others, and say in which size."""
    wall = trial.building.plan.walls[number]
    occluder = wall.occluders[index]
    bodies = trial.building.occluders[number, index]
    length = float(side_lengths(trial.building.plan.corners)[number])
    errors: dict[tuple[int, float], float] = {}
    for size, (thing, body) in enumerate(zip(occluder.sizes, bodies, strict=True)):
        for x in places_for(wall, occluder.door, thing.width, length):
            trial.put(body, (x, -occluder.away, 0.0))
            hidden = trial.hidden_by(number, index)
            error = abs(hidden.panel - occluder.panel_share) + abs(hidden.frame - occluder.frame_share)
            if is_fair(hidden) and error < _MOST_OFF:
                errors[size, x] = error
        trial.put(body, (0.0, 0.0, -BURIED))
    for size, x in sorted(errors, key=lambda key: errors[key]):
        trial.put(bodies[size], (x, -occluder.away, 0.0))
        if trial.is_doorway(number, index):
            return size
        trial.put(bodies[size], (0.0, 0.0, -BURIED))
    raise NoPlaceError(f"no place for the occluder of door {occluder.door + 1} in wall {number + 1}")


def is_fair(hidden: Hidden) -> bool:
    """Whether enough of a door is in sight to tell where all its sides are."""
    return (
        hidden.panel <= MOST_PANEL_HIDDEN
        and hidden.frame <= MOST_FRAME_HIDDEN
        and max(hidden.sides) <= MOST_SIDE_HIDDEN
        and hidden.corners_seen
    )


def places_for(wall: WallPlan, number: int, width: float, length: float) -> list[float]:
    """Where the middle of something so wide may stand along a wall: partly before a door, and before no other [m]."""
    door, half = wall.doors[number], width / 2
    others = [other.reach for other in wall.doors if other is not door]
    found = []
    for x in np.arange(door.left - half + _STEP, door.right + half, _STEP).tolist():
        free = all(x + half < low or x - half > high for low, high in others)
        if free and x - half > 0.02 and x + half < length - CORNER:
            found.append(x)
    return found


def _walls(building: Building, model: mujoco.MjModel) -> frozenset[int]:
    """Bodies of what is built of stone."""
    walls = (f"wall {number + 1}" for number in range(len(building.plan.walls)))
    return frozenset(model.body(name).id for name in ("building", *walls))


def _face(data: mujoco.MjData, number: int, door: DoorPlan) -> NDArray[np.float64]:
    """(4, 3) corners of a closed door's face in world, seen from inside: bottom left, bottom right, top right, left."""
    depth = min(door.recess, 0.0)
    low, high = door.bottom, door.height
    corners = np.array(
        [[door.left, depth, low], [door.right, depth, low], [door.right, depth, high], [door.left, depth, high]]
    )
    wall = data.body(f"wall {number + 1}")
    return np.asarray(corners @ wall.xmat.reshape(3, 3).T + wall.xpos)
