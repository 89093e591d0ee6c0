"""Any MJCF in, the same scene with MoPAD in it out."""

from __future__ import annotations

import logging
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import mujoco
import numpy as np

import assets
from sim.doors import Door, DoorTruth, find_doors, measure_door, measure_opening, put_doors
from sim.errors import SimError
from sim.leaves import bodies_below
from sim.obstacles import Obstacle, Obstacles, add_obstacles, obstacle_bodies
from sim.rays import Rays, geom_name
from sim.start import freest_spot, pose_on_floor, require_surroundings, set_down_poses

log = logging.getLogger(__name__)

ROBOT_PREFIX = "mopad/"
FOOTPRINT = (0.97, 0.57)
"""Length and width of MoPAD over everything: the chassis, and the outside of the tracks with 4 mm each side [m]."""

_GROUND = f"{ROBOT_PREFIX}ground"
_GROUND_BIT, _LEAF_BIT = 1 << 30, 1 << 29
"""Collision bits of the plane that carries MoPAD where the scene's floor does not, and of leaves; MoPAD has all."""
_ORIGIN_SITE = "beam_origin"
_GRAVITY = (0.0, 0.0, -9.81)
_LONGEST_STEP = 0.004
_SINKING = 0.02
"""Deeper contacts than this at the start mean that the robot stands in something [m]."""


@dataclass(frozen=True)
class Scene:
    """A compiled scene with MoPAD at its start pose and the doors where they were asked to be."""

    model: mujoco.MjModel
    """The scene and the robot, compiled once."""
    data: mujoco.MjData
    """Their state; everything that moves, moves here."""
    name: str
    """File name of the scene, such as `room.xml`."""
    xml: str
    """The scene with the robot as one MJCF text."""
    doors: tuple[Door, ...]
    """What closes which opening; found once."""
    world_from_base: np.ndarray
    """(4, 4) start pose of the robot's base."""
    set_downs: dict[str, np.ndarray]
    """(4, 4) poses of the base at which an operator sets the robot down where no way leads on, by site, in order."""
    robot_bodies: frozenset[int]
    """Ids of the robot's bodies: its own sensors do not see them."""
    robot_prefix: str
    """Of the names of the robot's bodies, joints, sites and actuators."""
    obstacles: Obstacles
    """What will get in the robot's way."""

    def true_doors(self) -> tuple[DoorTruth, ...]:
        """The doors as they stand now: the truth, for the evaluation only."""
        return tuple(measure_door(self.model, self.data, door) for door in self.doors)

    def true_openings(self) -> np.ndarray:
        """(D,) how far each of `doors` stands open now [rad or m]: the truth, for the record only."""
        return np.array([measure_opening(self.model, self.data, door) for door in self.doors])


def load_scene(
    path: Path,
    *,
    door_angles: Mapping[str, float] | None = None,
    keyframe: str | None = None,
    obstacles: Sequence[Obstacle] = (),
) -> Scene:
    """Load any MJCF, put MoPAD into it and set the doors.

    The state is the keyframe's of that name, else the first keyframe, else qpos0. MoPAD starts at a site named
    `start`, else at the freest spot inside a room; a scene that already holds a MoPAD keeps it where it is; sites
    `start_2`, `start_3`... say where it may be set down again. Doors stay where they are put, as if wedged. The scene's
    own options stay, except for what driving needs: the earth's gravity (where there was none, the scene's own bodies
    go on floating) and no water, contacts at the surface and actuation, the implicitfast integrator and a solver that
    converges, at most 4 ms a step, and a plane to drive on where the floor is a picture only.

    Args:
        path: the MJCF file.
        door_angles: opening of doors from closed [rad], by the name of the leaf's joint or body.
        keyframe: name of the keyframe to start from.
        obstacles: what is put in the robot's way later on.

    Raises:
        SimError: one line that says what is wrong with scene, keyframe, doors, start or an obstacle, and where.
    """
    mujoco.set_mju_user_warning(_warn)  # MuJoCo's own way is a file in the user's folder
    spec = _read(path)
    held = _robot_prefix(spec)
    prefix = _attach_robot(spec) if held is None else held
    _make_drivable(spec, prefix)
    add_obstacles(spec, obstacles)

    model = _compile(spec, path)
    data = mujoco.MjData(model)
    _reset(model, data, keyframe, path)
    doors = find_doors(model, data)
    put_doors(model, data, doors, door_angles or {})
    robot_bodies = bodies_below(model, model.body(f"{prefix}base").id)
    try:
        parked = obstacle_bodies(model, obstacles)
        pose = _start_pose(model, data, prefix, robot_bodies.union(parked), held is not None)
        set_base(model, data, prefix, pose)
        leaves = frozenset[int]().union(*(bodies_below(model, one.leaf.body) for door in doors for one in door.leaves))
        _free_from_hulls(model, data, robot_bodies | leaves)
        _free_to_swing(model, data, leaves)
        _let_stand(model, data, robot_bodies, pose)
        _require_free(model, data, robot_bodies, pose)
        set_downs = set_down_poses(model, data, Rays(model, data, robot_bodies), FOOTPRINT)
        coming = Obstacles(model, data, obstacles, floor_height=float(pose[2, 3]))
    except SimError as error:
        raise SimError(f"scene {path}: {error}") from None
    return Scene(model, data, path.name, spec.to_xml(), doors, pose, set_downs, robot_bodies, prefix, coming)


def _warn(text: str) -> None:
    log.warning("MuJoCo: %s", text)


def _read(path: Path) -> mujoco.MjSpec:
    if not path.is_file():
        raise SimError(f"scene {path}: no such file")
    try:
        return mujoco.MjSpec.from_file(str(path))
    except ValueError as error:
        text = _one_line(error)
        not_xml = ("XML parse error", "ParseXML", "could not find decoder")
        raise SimError(
            f"scene {path}: {'is not XML' if text.startswith(not_xml) else 'does not compile'}: {text}"
        ) from None


def _compile(spec: mujoco.MjSpec, path: Path) -> mujoco.MjModel:
    try:
        return spec.compile()
    except ValueError as error:
        raise SimError(f"scene {path}: does not compile: {_one_line(error)}") from None


def _one_line(error: Exception) -> str:
    return ", ".join(part.strip() for part in str(error).splitlines() if part.strip())


def _robot_prefix(spec: mujoco.MjSpec) -> str | None:
    """The prefix of a MoPAD that the scene already holds, known by its scanner's beam origin above its base."""
    names = {body.name for body in spec.bodies}
    for site in spec.sites:
        prefix = site.name.removesuffix(_ORIGIN_SITE)
        if site.name.endswith(_ORIGIN_SITE) and {f"{prefix}base", f"{prefix}vz400"} <= names:
            return prefix
    return None


def _attach_robot(spec: mujoco.MjSpec) -> str:
    taken = [body.name for body in spec.bodies]
    prefix = ROBOT_PREFIX
    while any(name.startswith(prefix) for name in taken):
        prefix = f"_{prefix}"
    robot = mujoco.MjSpec.from_file(str(assets.FOLDER / "mopad" / "mopad.xml"))
    spec.attach(robot, prefix=prefix, frame=spec.worldbody.add_frame())
    return prefix


def _make_drivable(spec: mujoco.MjSpec, prefix: str) -> None:
    """Give the physics what a robot that drives on earth needs, and leave everything else as the user has it."""
    bits = mujoco.mjtDisableBit
    no_gravity = bool(spec.option.disableflags & bits.mjDSBL_GRAVITY) or spec.option.gravity[2] > -1.0
    if no_gravity:
        log.info("the scene has no gravity: MoPAD gets it, the scene's own bodies go on floating")
        for body in spec.bodies[1:]:
            if not body.name.startswith(prefix):
                body.gravcomp = 1.0
    spec.option.gravity = _GRAVITY
    spec.option.density = spec.option.viscosity = 0.0
    needed = (
        bits.mjDSBL_GRAVITY,
        bits.mjDSBL_CONTACT,
        bits.mjDSBL_CONSTRAINT,
        bits.mjDSBL_ACTUATION,
        bits.mjDSBL_LIMIT,
        bits.mjDSBL_FRICTIONLOSS,
        bits.mjDSBL_DAMPER,
    )
    for bit in needed:
        spec.option.disableflags &= ~int(bit)
    spec.option.enableflags &= ~int(mujoco.mjtEnableBit.mjENBL_OVERRIDE)
    usual = mujoco.MjSpec()  # with fewer iterations than MuJoCo's own the tracks slip
    spec.option.solver = usual.option.solver
    spec.option.iterations = max(spec.option.iterations, usual.option.iterations)
    spec.option.ls_iterations = max(spec.option.ls_iterations, usual.option.ls_iterations)
    spec.option.tolerance = min(spec.option.tolerance, usual.option.tolerance)
    spec.compiler.settotalmass = usual.compiler.settotalmass  # of the scene: the robot would become lighter, too
    if spec.option.integrator != mujoco.mjtIntegrator.mjINT_IMPLICIT:
        spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    spec.option.timestep = min(spec.option.timestep, _LONGEST_STEP)
    for geom in spec.geoms:
        geom.margin = 0.0  # the robot would hover over its start by as much
    if _GROUND not in {geom.name for geom in spec.geoms}:
        plane = mujoco.mjtGeom.mjGEOM_PLANE
        last = spec.worldbody.add_body(name=_GROUND)  # after all others, so that the scene's geoms keep their numbers
        last.add_geom(name=_GROUND, type=plane, size=[0, 0, 1], group=3, contype=0, conaffinity=0)


def _reset(model: mujoco.MjModel, data: mujoco.MjData, keyframe: str | None, path: Path) -> None:
    names = [model.key(index).name for index in range(model.nkey)]
    if keyframe is not None and keyframe not in names:
        have = ", ".join(map(repr, names)) or "none"
        raise SimError(f"scene {path}: no keyframe {keyframe!r}; it has {have}")
    if model.nkey:
        mujoco.mj_resetDataKeyframe(model, data, names.index(keyframe) if keyframe is not None else 0)
        data.qvel[:] = 0.0
    mujoco.mj_forward(model, data)


def _start_pose(
    model: mujoco.MjModel, data: mujoco.MjData, prefix: str, robot_bodies: frozenset[int], held: bool
) -> np.ndarray:
    """Pose (4, 4) of the base on the floor, with walls around and nothing in the way."""
    rays = Rays(model, data, robot_bodies)
    site = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_SITE, "start")
    if held:
        base = data.body(f"{prefix}base")
        pose = pose_on_floor(rays, base.xpos, base.xmat.reshape(3, 3)[:, 0])
    elif site >= 0:
        pose = pose_on_floor(rays, data.site_xpos[site], data.site_xmat[site].reshape(3, 3)[:, 0])
    else:
        pose = freest_spot(model, data, rays)
    require_surroundings(rays, pose, FOOTPRINT)
    return pose


def _let_stand(model: mujoco.MjModel, data: mujoco.MjData, robot_bodies: frozenset[int], pose: np.ndarray) -> None:
    """Put a plane under the robot where the floor is a picture only."""
    solid = Rays(model, data, robot_bodies, only_solid=True)
    if solid.floor_below(pose[:3, 3] + [0, 0, 0.3], 0.35) is None:
        log.info("the floor has no collisions: MoPAD drives on a plane at z = %.3f m", pose[2, 3])
        ground = model.geom(_GROUND).id
        model.geom_pos[ground, 2] = pose[2, 3]
        model.geom_contype[ground] = _GROUND_BIT
        model.body_contype[model.geom_bodyid[ground]] = _GROUND_BIT
    mujoco.mj_forward(model, data)


def _free_from_hulls(model: mujoco.MjModel, data: mujoco.MjData, bodies: frozenset[int]) -> None:
    """Take meshes whose convex hulls swallow the robot or a leaf out of the collisions.

    MuJoCo collides with a mesh's hull: in a room that is one mesh the robot would be inside a solid block, and a wall
    with a hole would push the leaf out of it.
    """
    for geom in sorted(set(_deep_contacts(model, data, bodies))):
        if model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_MESH and model.body_weldid[model.geom_bodyid[geom]] == 0:
            log.warning("%s would collide by its convex hull: nothing collides with it", geom_name(model, geom))
            model.geom_contype[geom] = model.geom_conaffinity[geom] = 0
    mujoco.mj_forward(model, data)


def _free_to_swing(model: mujoco.MjModel, data: mujoco.MjData, leaves: frozenset[int]) -> None:
    """Let leaves collide with the robot only: drawn a little into its frame, a leaf would be flung open or shut."""
    solid = np.isin(model.geom_bodyid, sorted(leaves)) & ((model.geom_contype != 0) | (model.geom_conaffinity != 0))
    model.geom_contype[solid], model.geom_conaffinity[solid] = _LEAF_BIT, 0
    bodies = np.unique(model.geom_bodyid[solid])
    model.body_contype[bodies], model.body_conaffinity[bodies] = _LEAF_BIT, 0
    mujoco.mj_forward(model, data)


def set_base(model: mujoco.MjModel, data: mujoco.MjData, prefix: str, world_from_base: np.ndarray) -> None:
    """Set the robot down at a pose (4, 4), at rest, and update what follows from it."""
    start = int(model.joint(f"{prefix}free").qposadr[0])
    data.qpos[start : start + 3] = world_from_base[:3, 3]
    mujoco.mju_mat2Quat(data.qpos[start + 3 : start + 7], np.ascontiguousarray(world_from_base[:3, :3]).ravel())
    robot = sorted(bodies_below(model, model.body(f"{prefix}base").id))
    data.qvel[np.isin(model.dof_bodyid, robot)] = 0.0
    mujoco.mj_forward(model, data)


def _require_free(model: mujoco.MjModel, data: mujoco.MjData, robot_bodies: frozenset[int], pose: np.ndarray) -> None:
    for geom in _deep_contacts(model, data, robot_bodies):
        x, y, z = pose[:3, 3]
        raise SimError(f"the start at ({x:.2f}, {y:.2f}, {z:.2f}) is inside {geom_name(model, geom)}")


def _deep_contacts(model: mujoco.MjModel, data: mujoco.MjData, bodies: frozenset[int]) -> list[int]:
    """Geoms of other bodies that some of these bodies are in."""
    deep = []
    for contact in data.contact:
        mine = [int(model.geom_bodyid[geom]) in bodies for geom in contact.geom]
        if contact.dist < -_SINKING and mine[0] != mine[1]:
            deep.append(int(contact.geom[0] if mine[1] else contact.geom[1]))
    return deep
