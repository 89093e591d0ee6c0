"""What is scanned: a scene of the user's kind, and one of 200 meshes with 200 000 triangles."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from mission.rigid import Pose
from mission.scene_file import find_scene
from sim.render import Renderer
from sim.robot import Robot, RobotParameters
from sim.scene import load_scene

MESHES, RINGS, SIDES = 200, 21, 25
"""Boulders, and the rings and sides of each: 2 x 20 x 25 = 1000 triangles."""
HALL = 12.0, 9.0, 3.0
"""The hall they float in [m]."""


@dataclass(frozen=True, eq=False)
class World:
    """A world to scan from one place."""

    name: str
    model: mujoco.MjModel
    data: mujoco.MjData
    renderer: Renderer
    world_from_scanner: Pose
    hidden_bodies: frozenset[int] = frozenset()
    """That the sensors do not see."""


@contextmanager
def scene_world(name: str) -> Iterator[World]:
    """A scene, from the scanner on the robot at its start."""
    scene = load_scene(find_scene(name))
    robot = Robot(scene, RobotParameters(), np.random.default_rng(0))
    pose = robot.true_world_from_base @ robot.base_from_scanner
    with Renderer(scene.model, hidden_bodies=scene.robot_bodies) as renderer:
        yield World(name, scene.model, scene.data, renderer, pose, scene.robot_bodies)


@contextmanager
def cluttered_world() -> Iterator[World]:
    """A hall of 12 x 9 m full of boulders of 1000 triangles each, seen from its middle."""
    model = mujoco.MjModel.from_xml_string(cluttered_xml())
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    pose = np.eye(4)
    pose[:3, 3] = 0.1, 0.2, 1.4
    with Renderer(model) as renderer:
        yield World(f"{MESHES} meshes", model, data, renderer, pose)


def cluttered_xml(seed: int = 0) -> str:
    """The MJCF of the hall; boulders keep 1.6 m away from the place in its middle."""
    rng = np.random.default_rng(seed)
    length, width, height = HALL
    walls = "".join(
        f'<geom type="box" pos="{x} {y} {z}" size="{a} {b} {c}"/>'
        for x, y, z, a, b, c in (
            (0, 0, -0.1, length / 2, width / 2, 0.1),
            (0, 0, height + 0.1, length / 2, width / 2, 0.1),
            *((s * (length / 2 + 0.1), 0, height / 2, 0.1, width / 2, height / 2) for s in (-1, 1)),
            *((0, s * (width / 2 + 0.1), height / 2, length / 2, 0.1, height / 2) for s in (-1, 1)),
        )
    )
    meshes, geoms = [], []
    for number in range(MESHES):
        while True:
            place = rng.uniform((-length / 2, -width / 2, 0), (length / 2, width / 2, height))
            if np.hypot(*place[:2]) > 1.6:
                break
        vertices, faces = _boulder(rng)
        meshes.append(f'<mesh name="m{number}" inertia="shell" vertex="{_words(vertices)}" face="{_words(faces)}"/>')
        geoms.append(
            f'<geom type="mesh" mesh="m{number}" pos="{_words(place)}" rgba="{_words(rng.uniform(0.2, 0.9, 3))} 1" '
            'contype="0" conaffinity="0"/>'
        )
    return f"<mujoco><asset>{''.join(meshes)}</asset><worldbody>{walls}{''.join(geoms)}</worldbody></mujoco>"


def _boulder(rng: np.random.Generator) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Vertices (V, 3) [m] and faces (1000, 3) of a bumpy ball, closed at the poles by its first and last ring."""
    polar = np.linspace(0.05, np.pi - 0.05, RINGS)[:, None]
    around = np.arange(SIDES) * 2 * np.pi / SIDES
    radius = rng.uniform(0.1, 0.35) * (1 + rng.uniform(-0.12, 0.12, (RINGS, SIDES)))
    x, y, z = radius * np.sin(polar) * np.cos(around), radius * np.sin(polar) * np.sin(around), radius * np.cos(polar)
    ring, side = (index.ravel() for index in np.indices((RINGS - 1, SIDES)))
    a, b = ring * SIDES + side, ring * SIDES + (side + 1) % SIDES
    faces = np.concatenate([np.stack([a, a + SIDES, b], 1), np.stack([b, a + SIDES, b + SIDES], 1)])
    return np.stack([x, y, z], axis=-1).reshape(-1, 3), faces


def _words(numbers: NDArray[np.generic]) -> str:
    return " ".join(f"{number:.5g}" for number in np.ravel(numbers))
