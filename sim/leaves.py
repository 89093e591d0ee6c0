"""Door leaves by their geometry: which bodies are slabs of a door's size on a vertical hinge or a horizontal slide."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import mujoco
import numpy as np

from sim.shapes import triangles_in_world

HEIGHTS = (1.6, 2.6)
"""Least and greatest height of a door leaf [m]."""
WIDTHS = (0.5, 1.5)
"""Least and greatest width of a door leaf [m]."""
NARROWEST_SECOND = 0.25
"""Least width of the second, usually bolted leaf of a double door [m]."""
THICKEST = 0.15
"""Greatest thickness of a door leaf, handles left out [m]."""
_AXIS_TOLERANCE = np.radians(5.0)
_LEAST_FILL = 0.3
_PARALLEL = np.cos(np.radians(5.0))


@dataclass(frozen=True)
class Slab:
    """The flat part of a leaf, where it is now."""

    corners_in_world: np.ndarray
    """(4, 3) on the mid-plane: hinge bottom, free bottom, free top, hinge top [m]; for a slide, start and end of it."""
    thickness: float
    """[m]."""


@dataclass(frozen=True)
class Leaf:
    """A body that is a leaf by its size and its joint, whether or not it closes an opening."""

    kind: Literal["hinged", "sliding"]
    body: int
    joint: int
    name: str
    """Of the body, else of the joint, else made up."""
    joint_name: str
    slab: Slab
    anchor: np.ndarray
    """(3,) a point of the joint's axis in world [m]."""
    axis: np.ndarray
    """(3,) unit vector of the joint's axis in world."""
    value: float
    """The joint's position at which `slab` was measured [rad or m]."""

    @property
    def is_door_wide(self) -> bool:
        """Whether it can be a door of its own, not just the narrow leaf of a double door."""
        first, second = self.slab.corners_in_world[:2]
        return float(np.linalg.norm(second - first)) >= WIDTHS[0]

    def corners_at(self, value: float) -> np.ndarray:
        """The slab's corners (4, 3) in world with the joint at a position [rad or m]."""
        change = value - self.value
        if self.kind == "sliding":
            return self.slab.corners_in_world + change * self.axis
        quaternion, rotation = np.zeros(4), np.zeros(9)
        mujoco.mju_axisAngle2Quat(quaternion, self.axis, change)
        mujoco.mju_quat2Mat(rotation, quaternion)
        return (self.slab.corners_in_world - self.anchor) @ rotation.reshape(3, 3).T + self.anchor


def find_leaves(model: mujoco.MjModel, data: mujoco.MjData) -> list[Leaf]:
    """All leaves of a scene, in the order of their joints; the positions of `data` must be up to date."""
    leaves = (_leaf(model, data, joint) for joint in range(model.njnt))
    return [leaf for leaf in leaves if leaf is not None]


def bodies_below(model: mujoco.MjModel, top: int) -> frozenset[int]:
    """Ids of a body and of all its descendants."""
    bodies = {top}
    for body in range(top + 1, model.nbody):
        if int(model.body_parentid[body]) in bodies:
            bodies.add(body)
    return frozenset(bodies)


def _leaf(model: mujoco.MjModel, data: mujoco.MjData, joint: int) -> Leaf | None:
    body = int(model.jnt_bodyid[joint])
    alone_on_static = model.body_jntnum[body] == 1 and model.body_weldid[model.body_parentid[body]] == 0
    upright = abs(float(data.xaxis[joint][2]))
    kind: Literal["hinged", "sliding"]
    if model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_HINGE and upright > np.cos(_AXIS_TOLERANCE):
        kind = "hinged"
    elif model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_SLIDE and upright < np.sin(_AXIS_TOLERANCE):
        kind = "sliding"
    else:
        return None
    if not alone_on_static:
        return None
    anchor, axis = data.xanchor[joint].copy(), data.xaxis[joint].copy()
    slab = _slab(model, data, body, anchor, axis if kind == "sliding" else None)
    if slab is None:
        return None
    joint_name = str(model.joint(joint).name)
    name = str(model.body(body).name) or joint_name or f"door {joint}"
    return Leaf(kind, body, joint, name, joint_name, slab, anchor, axis, float(data.qpos[model.jnt_qposadr[joint]]))


def _slab(
    model: mujoco.MjModel, data: mujoco.MjData, body: int, anchor: np.ndarray, slide: np.ndarray | None
) -> Slab | None:
    """Measure the flat part of a leaf from its large parallel faces, so that handles and hinges do not count."""
    geoms = np.flatnonzero(np.isin(model.geom_bodyid, sorted(bodies_below(model, body))))
    per_geom = [corners for corners in triangles_in_world(model, data, geoms.tolist()) if len(corners)]
    if not per_geom:
        return None
    owner = np.repeat(np.arange(len(per_geom)), [len(corners) for corners in per_geom])
    corners = np.concatenate(per_geom) - anchor
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(cross, axis=1) / 2
    normals = cross / np.maximum(2 * area, 1e-12)[:, None]
    facing = _main_normal(normals, area)
    parallel = (np.abs(normals @ facing) > _PARALLEL) & (area > 0)
    if not parallel.any():  # a cone or a pyramid has no upright face
        return None
    offsets = corners.mean(1) @ facing
    back, front = _weighted_quantiles(offsets[parallel], area[parallel], (0.05, 0.95))
    flat = parallel & (offsets > back - 0.005) & (offsets < front + 0.005)
    share = np.bincount(owner[flat], area[flat], len(per_geom)) / area[flat].sum()
    panel = corners[flat & (share[owner] > 0.01)].reshape(-1, 3)
    along = np.cross([0, 0, 1.0], facing)
    u, z = panel @ along, panel[:, 2]
    width, height, thickness = np.ptp(u), np.ptp(z), front - back
    fits = NARROWEST_SECOND <= width <= WIDTHS[1] and HEIGHTS[0] <= height <= HEIGHTS[1] and thickness <= THICKEST
    if not fits or area[flat].sum() / 2 < _LEAST_FILL * width * height:
        return None
    near, far = (u.min(), u.max()) if abs(u.min()) <= abs(u.max()) else (u.max(), u.min())
    if slide is None and (abs(near) > 0.25 * width or abs((back + front) / 2) > 0.25):
        return None  # it turns about its middle, or about something far away
    if slide is not None and abs(slide @ facing) > np.sin(np.radians(20)):
        return None  # it slides out of its plane, as a drawer does
    middle = anchor + (back + front) / 2 * facing
    ends = [(near, z.min()), (far, z.min()), (far, z.max()), (near, z.max())]
    return Slab(np.array([middle + a * along + [0, 0, b] for a, b in ends]), float(thickness))


def _main_normal(normals: np.ndarray, area: np.ndarray) -> np.ndarray:
    """The horizontal direction (3,) that most of the upright surface faces, of either sign."""
    upright = np.abs(normals[:, 2]) < 0.2
    if not upright.any():
        return np.array([1.0, 0, 0])
    angles, weights = np.arctan2(normals[upright, 1], normals[upright, 0]) % np.pi, area[upright]
    bins = np.bincount((np.degrees(angles) / 2 + 0.5).astype(int) % 90, weights, 90)
    main = np.radians(2.0 * int((bins + np.roll(bins, 1) + np.roll(bins, -1)).argmax()))
    near = np.abs((angles - main + np.pi / 2) % np.pi - np.pi / 2) < np.radians(4)
    angle = main + np.average((angles - main + np.pi / 2)[near] % np.pi - np.pi / 2, weights=weights[near])
    return np.array([np.cos(angle), np.sin(angle), 0.0])


def _weighted_quantiles(values: np.ndarray, weights: np.ndarray, shares: tuple[float, float]) -> tuple[float, float]:
    order = np.argsort(values)
    reached = np.cumsum(weights[order]) / weights.sum()
    low, high = np.minimum(np.searchsorted(reached, shares), len(order) - 1)
    return float(values[order[low]]), float(values[order[high]])
