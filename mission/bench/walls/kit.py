"""Building with MjSpec: boxes, slabs with holes and round things in given finishes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

import cv2
import mujoco
import numpy as np
from numpy.typing import NDArray

from mission.bench.walls.finishes import Finish

Body: TypeAlias = mujoco.MjsBody
Point = tuple[float, float, float]


@dataclass(frozen=True)
class Hole:
    """A rectangle left out of a slab."""

    left: float
    bottom: float
    right: float
    top: float


class Kit:
    """A world under construction, with its materials and pictures."""

    def __init__(self) -> None:
        self.spec = mujoco.MjSpec()
        self.spec.compiler.degree = False
        self.assets: dict[str, bytes] = {}
        """PNG files that the world names."""
        self._materials: dict[Finish, str] = {}
        self._meshes = 0

    def box(self, body: Body, lower: Point, upper: Point, finish: Finish) -> None:
        """An upright box between two corners in the body's frame [m]."""
        if finish.painter:
            self.slab(body, lower, upper, finish)
            return
        low, high = np.array(lower), np.array(upper)
        body.add_geom(
            type=mujoco.mjtGeom.mjGEOM_BOX, pos=(low + high) / 2, size=(high - low) / 2, material=self._material(finish)
        )

    def slab(self, body: Body, lower: Point, upper: Point, finish: Finish, holes: Sequence[Hole] = ()) -> None:
        """A box with rectangular holes through it along y."""
        vertices, coordinates = slab_quads(lower, upper, holes, finish.period)
        self._mesh(body, vertices, coordinates, finish)

    def prism(self, body: Body, corners: NDArray[np.float64], bottom: float, top: float, finish: Finish) -> None:
        """A level slab over a polygon (P, 2), clockwise seen from above, star-shaped about its first corner [m]."""
        inner = range(1, len(corners) - 1)
        quads = [
            [[*corners[k], z] for k in side]
            for i in inner
            for z, side in ((top, (0, i + 1, i)), (bottom, (0, i, i + 1)))
        ]
        triangles = np.array(quads)
        around = np.concatenate([corners, corners[:1]])
        sides = [
            [[*a, bottom], [*a, top], [*b, top], [*b, bottom]] for a, b in zip(around[:-1], around[1:], strict=True)
        ]
        vertices = np.concatenate([triangles[:, [0, 1, 2, 2]], np.array(sides)])
        self._mesh(body, vertices, vertices[..., :2] / finish.period, finish)

    def tube(self, body: Body, start: Point, end: Point, radius: float, finish: Finish) -> None:
        """A round bar with round ends."""
        self._bar(mujoco.mjtGeom.mjGEOM_CAPSULE, body, start, end, radius, finish)

    def cylinder(self, body: Body, start: Point, end: Point, radius: float, finish: Finish) -> None:
        """A round bar with flat ends."""
        self._bar(mujoco.mjtGeom.mjGEOM_CYLINDER, body, start, end, radius, finish)

    def _bar(self, kind: mujoco.mjtGeom, body: Body, start: Point, end: Point, radius: float, finish: Finish) -> None:
        body.add_geom(type=kind, fromto=[*start, *end], size=[radius, 0, 0], material=self._material(finish))

    def ball(self, body: Body, centre: Point, radii: Point, finish: Finish) -> None:
        """An ellipsoid along the body's axes."""
        body.add_geom(type=mujoco.mjtGeom.mjGEOM_ELLIPSOID, pos=centre, size=radii, material=self._material(finish))

    def _mesh(self, body: Body, quads: NDArray[np.float64], coordinates: NDArray[np.float64], finish: Finish) -> None:
        """A closed surface of quadrangles (Q, 4, 3) with texture coordinates (Q, 4, 2); nothing collides with it,
        since MuJoCo would fill its holes."""
        name = f"mesh {self._meshes}"
        self._meshes += 1
        first = 4 * np.arange(len(quads))[:, None]
        triangles = np.concatenate([first + [0, 1, 2], first + [0, 2, 3]])
        flat = (quads[:, 2] == quads[:, 3]).all(axis=1)  # a triangle
        triangles = np.concatenate([triangles[: len(quads)], triangles[len(quads) :][~flat]])
        mesh = self.spec.add_mesh(name=name)
        mesh.uservert, mesh.userface = quads.ravel(), triangles.ravel()
        mesh.usertexcoord = coordinates.ravel()
        mesh.userfacetexcoord = triangles.ravel()
        body.add_geom(
            type=mujoco.mjtGeom.mjGEOM_MESH, meshname=name, material=self._material(finish), contype=0, conaffinity=0
        )

    def _material(self, finish: Finish) -> str:
        if finish in self._materials:
            return self._materials[finish]
        name = self._materials[finish] = f"finish {len(self._materials)}"
        colour = (1.0, 1.0, 1.0) if finish.painter else finish.colour
        material = self.spec.add_material(
            name=name, rgba=[*colour, finish.alpha], specular=finish.specular, roughness=finish.roughness
        )
        if finish.painter:
            picture = finish.painter(np.random.default_rng(finish.seed), finish.colour, finish.variation)
            file = f"{name.replace(' ', '_')}.png"
            self.assets[file] = _png(picture)
            self.spec.add_texture(name=name, type=mujoco.mjtTexture.mjTEXTURE_2D, file=file)
            material.textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = name
        return name


def _png(picture: NDArray[np.uint8]) -> bytes:
    return bytes(cv2.imencode(".png", picture[..., ::-1], [cv2.IMWRITE_PNG_COMPRESSION, 1])[1])  # RGB to BGR


def slab_quads(
    lower: Point, upper: Point, holes: Sequence[Hole], period: tuple[float, float]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The surface of a box with holes through it along y: quadrangles (Q, 4, 3) anticlockwise seen from outside [m],
    and their texture coordinates (Q, 4, 2), which grow by 1 a period to the right and down."""
    xs = _cuts(lower[0], upper[0], [x for hole in holes for x in (hole.left, hole.right)])
    zs = _cuts(lower[2], upper[2], [z for hole in holes for z in (hole.bottom, hole.top)])
    solid = np.zeros((len(xs) + 1, len(zs) + 1), bool)  # with a rim of nothing
    solid[1:-1, 1:-1] = True
    for hole in holes:
        inside_x = (xs[:-1] >= hole.left - 1e-5) & (xs[1:] <= hole.right + 1e-5)
        inside_z = (zs[:-1] >= hole.bottom - 1e-5) & (zs[1:] <= hole.top + 1e-5)
        solid[1:-1, 1:-1] &= ~(inside_x[:, None] & inside_z[None])
    near, far = lower[1], upper[1]
    quads = []
    for i, k in zip(*np.nonzero(solid), strict=True):
        (x0, x1), (z0, z1) = xs[i - 1 : i + 1], zs[k - 1 : k + 1]
        quads.append([(x0, near, z0), (x1, near, z0), (x1, near, z1), (x0, near, z1)])
        quads.append([(x1, far, z0), (x0, far, z0), (x0, far, z1), (x1, far, z1)])
        if not solid[i - 1, k]:
            quads.append([(x0, far, z0), (x0, near, z0), (x0, near, z1), (x0, far, z1)])
        if not solid[i + 1, k]:
            quads.append([(x1, near, z0), (x1, far, z0), (x1, far, z1), (x1, near, z1)])
        if not solid[i, k - 1]:
            quads.append([(x0, far, z0), (x1, far, z0), (x1, near, z0), (x0, near, z0)])
        if not solid[i, k + 1]:
            quads.append([(x0, near, z1), (x1, near, z1), (x1, far, z1), (x0, far, z1)])
    vertices = np.array(quads)
    # the picture starts in the upper left corner, its first row on top, and bends round the edges
    level = np.ptp(vertices[..., 2], axis=1) == 0
    u = vertices[..., 0] - lower[0] + np.where(level, 0, 1)[:, None] * (vertices[..., 1] - near)
    v = upper[2] - vertices[..., 2] + np.where(level, 1, 0)[:, None] * (vertices[..., 1] - near)
    return vertices, np.stack([u / period[0], v / period[1]], axis=-1)


def _cuts(low: float, high: float, between: Sequence[float]) -> NDArray[np.float64]:
    return np.unique(np.round(np.clip([low, high, *between], low, high), 6))
