"""Everything in a world that light meets: triangles and round bodies."""

from __future__ import annotations

from collections.abc import Collection
from threading import Lock

import mujoco
import numpy as np
from numpy.typing import NDArray

from sim.compiled import compiled
from sim.facets import BACK, BOTH, FRONT, Triangles
from sim.render.visibility import GLASS_ALPHA, VISUAL_GROUPS, visible_geoms
from sim.round_bodies import BALL, PILL, ROD, RoundBodies
from sim.shapes import box, triangulate

Mesh = tuple[NDArray[np.generic], NDArray[np.generic]]
"""Vertices (V, 3) [m] and triangles (T, 3) of them, anticlockwise seen from outside."""

ENDLESS = 1e4
"""Half of the side of an endless plane [m], which goes where the eye goes: its end is 0.01 deg below the horizon."""

_ROUND = {
    mujoco.mjtGeom.mjGEOM_SPHERE.value: BALL,
    mujoco.mjtGeom.mjGEOM_ELLIPSOID.value: BALL,
    mujoco.mjtGeom.mjGEOM_CYLINDER.value: ROD,
    mujoco.mjtGeom.mjGEOM_CAPSULE.value: PILL,
}


class Surfaces:
    """The surfaces of one model, wherever its bodies are."""

    def __init__(self, model: mujoco.MjModel, hidden_bodies: Collection[int] = ()) -> None:
        """Collect the surfaces that light meets (`visible_geoms`).

        Args:
            model: the compiled world; shapes are taken as they are now.
            hidden_bodies: ids of bodies never met, such as the robot that carries the sensors.
        """
        seen = np.flatnonzero(visible_geoms(model, hidden_bodies))
        is_round = np.isin(model.geom_type[seen], list(_ROUND))
        self._is_box, self._half_sizes = model.geom_type == mujoco.mjtGeom.mjGEOM_BOX, model.geom_size.copy()
        self._round, flat = seen[is_round], seen[~is_round]
        is_plane = model.geom_type[flat] == mujoco.mjtGeom.mjGEOM_PLANE
        self._flat = _Parts([_flat_mesh(model, geom) for geom in flat], flat, np.where(is_plane, FRONT, BOTH))
        self._kinds = np.array([_ROUND[kind] for kind in model.geom_type[self._round]], np.int8)
        size, is_ball = model.geom_size[self._round], self._kinds == BALL
        is_ellipsoid = model.geom_type[self._round] == mujoco.mjtGeom.mjGEOM_ELLIPSOID
        endless = is_plane[:, None] & (model.geom_size[flat, :2] <= 0)
        self._endless, self._is_endless = flat[endless.any(axis=1)], endless[endless.any(axis=1)]
        self._radii = np.where(is_ellipsoid[:, None], size, size[:, :1])
        lengths = np.where(is_ball, 0, size[:, 1])
        self._half_lengths = lengths / self._radii[:, 2]
        tips = lengths + np.where(self._kinds == ROD, 0, self._radii[:, 2])
        boxes = [box(half) for half in np.column_stack([self._radii[:, :2], tips])]
        self._boxes = _Parts(boxes, np.arange(len(boxes)), np.full(len(boxes), BACK))
        self._soft = _Soft(model) if model.nflex + model.nskin else None

    def around(
        self, data: mujoco.MjData, world_from_view: NDArray[np.float64]
    ) -> tuple[Triangles, Triangles, RoundBodies]:
        """Where the surfaces are, seen from somewhere.

        Args:
            data: state of the world, after `mj_kinematics` or more.
            world_from_view: (4, 4) frame of the beams.

        Returns:
            What is flat; boxes round the round bodies, their far sides; the round bodies.
        """
        turn, eye = world_from_view[:3, :3], world_from_view[:3, 3]
        rotations = turn.T @ data.geom_xmat.reshape(-1, 3, 3)
        places = (data.geom_xpos - eye) @ turn
        places[self._endless] = _under_eye(rotations[self._endless], places[self._endless], self._is_endless)
        flat = self._flat.placed(rotations, places)
        flat = flat._replace(sides=np.where(self._outside(rotations, places)[flat.owners], FRONT, flat.sides))
        if self._soft is not None:
            flat = self._soft.added_to(flat, data, world_from_view)
        rotations, places = rotations[self._round], places[self._round]
        body_from_view = rotations.transpose(0, 2, 1) / self._radii[:, :, None]
        origins = -np.einsum("bij,bj->bi", body_from_view, places)
        bodies = RoundBodies(self._kinds, self._half_lengths, body_from_view, origins, self._round.astype(np.int32))
        return flat, self._boxes.placed(rotations, places), bodies

    def _outside(self, rotations: NDArray[np.float64], places: NDArray[np.float64]) -> NDArray[np.bool_]:
        """(ngeom,) which geoms are boxes that the view is outside of: their far sides are hidden by the near ones."""
        eye = -np.einsum("gji,gj->gi", rotations, places)
        return self._is_box & (np.abs(eye) > self._half_sizes).any(axis=1)


class _Parts:
    """The meshes of many parts, each in its own frame."""

    def __init__(self, meshes: list[Mesh], owners: NDArray[np.integer], sides: NDArray[np.integer]) -> None:
        """Join (P,) meshes with the (P,) owner and side of each."""
        vertices = [np.zeros((0, 3)), *(mesh[0] for mesh in meshes)]
        corners = [np.zeros((0, 3), np.int32), *(mesh[1] for mesh in meshes)]
        first = np.cumsum([0, *map(len, vertices)])
        faces = [len(part) for part in corners[1:]]
        self._vertices = np.concatenate(vertices).astype(np.float64)
        self._corners = np.concatenate([part + start for part, start in zip(corners, first[:-1], strict=True)])
        self._corners = self._corners.astype(np.int32)
        self._sides = np.repeat(sides, faces).astype(np.int8)
        self._owners = np.repeat(owners, faces).astype(np.int32)
        self._owner_of_vertex = np.repeat(owners, np.diff(first)[1:]).astype(np.int32)

    def placed(self, rotations: NDArray[np.float64], places: NDArray[np.float64]) -> Triangles:
        """Put each part where its owner is: (O, 3, 3) rotations and (O, 3) places of all owners [m]."""
        vertices = _placed(self._vertices, self._owner_of_vertex, rotations, places)
        return Triangles(vertices, self._corners, self._sides, self._owners)


@compiled
def _placed(
    vertices: NDArray[np.float64],
    owners: NDArray[np.int32],
    rotations: NDArray[np.float64],
    places: NDArray[np.float64],
) -> NDArray[np.float64]:
    """(V, 3) vertices where their owners are."""
    placed = np.empty_like(vertices)
    for i in range(len(vertices)):
        turn, place = rotations[owners[i]], places[owners[i]]
        for k in range(3):
            placed[i, k] = (
                turn[k, 0] * vertices[i, 0] + turn[k, 1] * vertices[i, 1] + turn[k, 2] * vertices[i, 2] + place[k]
            )
    return placed


class _Soft:
    """Flexes of two and three dimensions and skins, as MuJoCo draws them."""

    def __init__(self, model: mujoco.MjModel) -> None:
        self._model = model
        self._scene = mujoco.MjvScene(model, maxgeom=model.nflex + model.nskin)
        self._option = mujoco.MjvOption()
        self._option.geomgroup[:] = self._option.sitegroup[:] = self._option.jointgroup[:] = 0
        self._option.tendongroup[:] = self._option.actuatorgroup[:] = 0
        self._flexes = (model.flex_group < VISUAL_GROUPS) & (_alpha(model, "flex") >= GLASS_ALPHA)
        self._skins = (model.skin_group < VISUAL_GROUPS) & (_alpha(model, "skin") >= GLASS_ALPHA)
        self._lock = Lock()

    def added_to(self, flat: Triangles, data: mujoco.MjData, world_from_view: NDArray[np.float64]) -> Triangles:
        """Triangles with those of the soft things added."""
        model, scene = self._model, self._scene
        categories = mujoco.mjtCatBit.mjCAT_ALL.value
        with self._lock:
            mujoco.mjv_updateScene(model, data, self._option, None, mujoco.MjvCamera(), categories, scene)
            vertices, skin_vertices = scene.flexface.reshape(-1, 3).copy(), scene.skinvert.reshape(-1, 3).copy()
        cloths = [
            vertices[3 * first : 3 * (first + used)]
            for first, used, shown in zip(scene.flexfaceadr, scene.flexfaceused, self._flexes, strict=True)
            if shown
        ]
        skins = [
            skin_vertices[first : first + count][model.skin_face[face : face + number]].reshape(-1, 3)
            for first, count, face, number, shown in zip(
                *(model.skin_vertadr, model.skin_vertnum, model.skin_faceadr, model.skin_facenum, self._skins),
                strict=True,
            )
            if shown
        ]
        points = np.concatenate([np.zeros((0, 3)), *cloths, *skins])
        points = (points - world_from_view[:3, 3]) @ world_from_view[:3, :3]
        corners = np.arange(len(points), dtype=np.int32).reshape(-1, 3) + np.int32(len(flat.vertices))
        return Triangles(
            np.concatenate([flat.vertices, points]),
            np.concatenate([flat.corners, corners]),
            np.concatenate([flat.sides, np.full(len(corners), BOTH, np.int8)]),
            np.concatenate([flat.owners, np.full(len(corners), -1, np.int32)]),
        )


def _alpha(model: mujoco.MjModel, kind: str) -> NDArray[np.float32]:
    """Opacity of each flex or skin: its material's, if it has one."""
    own = getattr(model, f"{kind}_rgba")[:, 3]
    material = getattr(model, f"{kind}_matid")[: len(own)]  # MuJoCo 4.0 shows more of flexes than there are
    return np.where(material >= 0, np.append(model.mat_rgba[:, 3], 1)[material], own)


def _under_eye(
    rotations: NDArray[np.float64], places: NDArray[np.float64], is_endless: NDArray[np.bool_]
) -> NDArray[np.float64]:
    """(P, 3) planes moved along those of their axes (P, 2) that have no end, until they lie under or over the eye."""
    along = -np.einsum("pji,pj->pi", rotations, places)[:, :2] * is_endless
    return places + np.einsum("pji,pi->pj", rotations[:, :, :2], along)


def _flat_mesh(model: mujoco.MjModel, geom: int) -> Mesh:
    """The triangles of a geom without round sides."""
    match mujoco.mjtGeom(int(model.geom_type[geom])):
        case mujoco.mjtGeom.mjGEOM_PLANE:
            half = np.where(model.geom_size[geom, :2] > 0, model.geom_size[geom, :2], ENDLESS)
            corners = np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)]) * [*half, 0]
            return corners, np.array([(0, 1, 2), (0, 2, 3)])
        case mujoco.mjtGeom.mjGEOM_HFIELD:
            return _height_field(model, int(model.geom_dataid[geom]))
    return triangulate(model, geom)


def _height_field(model: mujoco.MjModel, number: int) -> Mesh:
    """The top of a height field, in MuJoCo's triangles, its sides and its bottom."""
    rows, columns = int(model.hfield_nrow[number]), int(model.hfield_ncol[number])
    half_x, half_y, height, depth = model.hfield_size[number]
    first = model.hfield_adr[number]
    x, y = np.meshgrid(np.linspace(-half_x, half_x, columns), np.linspace(-half_y, half_y, rows))
    z = model.hfield_data[first : first + rows * columns].reshape(rows, columns) * height
    top = np.stack([x, y, z], axis=-1).reshape(-1, 3)
    number_of = np.arange(rows * columns).reshape(rows, columns)
    a, b, c, d = (number_of[r, s].ravel() for r in (np.s_[:-1], np.s_[1:]) for s in (np.s_[:-1], np.s_[1:]))
    rim = np.concatenate([number_of[0], number_of[1:, -1], number_of[-1, -2::-1], number_of[-2:0:-1, 0]])
    foot = top[rim] * [1, 1, 0] - [0, 0, depth]
    low, following = len(top) + np.arange(len(rim)), np.roll(rim, -1)
    next_low = np.roll(low, -1)
    bottom = low[[0, columns - 1, columns + rows - 2, 2 * columns + rows - 3]]
    triangles = [(a, b, d), (a, d, c), (rim, low, next_low), (rim, next_low, following)]
    flat = [np.stack(corners, axis=-1) for corners in triangles]
    return np.concatenate([top, foot]), np.concatenate([*flat, bottom[[[0, 2, 1], [0, 3, 2]]]])
