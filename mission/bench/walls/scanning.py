"""Scans of a benchmark room, made ready for the detector by the mission's own stages.

Nothing here imports the mission's configuration or the detector's stages: what this module depends on decides which
scans can be taken from the cache, see `cache.py`.
"""

from __future__ import annotations

import zlib
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import mujoco
import numpy as np
from numpy.typing import NDArray

import assets
from detector.room import Room, Wall
from mission.colouring import colour_scan
from mission.errors import MissionError
from mission.registration import Registrar
from mission.rigid import Pose, from_rotation_vector
from mission.samples import PosedSample, place, sample_scan
from mission.structure import find_structure
from mission.views import ColouredScan, Views
from mission.voxels import label_voxels, room_from
from sim.camera import Camera, Photo
from sim.doors import DoorTruth, true_doors
from sim.errors import SimError
from sim.rays import Rays
from sim.render import Renderer
from sim.scanner import Scan, Scanner
from sim.start import pose_on_floor

if TYPE_CHECKING:
    from mission.bench.walls.rooms import BenchRoom
    from mission.config import MissionConfig

ODOMETRY_ERROR = 0.05, float(np.deg2rad(2.0))
"""The guess of a scan's pose is off by up to this: along x and y [m], and in heading [rad]."""
STAGES = ("scanner", "camera", "samples", "registration", "structure", "voxels")
"""Parts of the configuration that a scanned room depends on."""


@dataclass(frozen=True, eq=False)
class JudgedScan(ColouredScan):
    """A coloured scan, and what it shows of gloss."""

    gloss: NDArray[np.uint8]
    """(N,) levels by which the mirror image of the flash brightens the photograph that coloured each return. Truth: the
    detector never sees it."""


@dataclass(frozen=True, eq=False)
class ScannedRoom:
    """A benchmark room as the mission would hand it to the detector."""

    scans: tuple[JudgedScan, ...]
    walls: tuple[Wall, ...]
    """That the mission found."""
    floor_height: float
    """World z [m]."""
    ceiling_height: float | None
    """World z [m]; None where there is none."""
    pose_errors: NDArray[np.float64]
    """(scans,) distance of each registered pose from the true one [m]."""

    def room(self) -> Room:
        """As the detector takes it."""
        return Room(
            views=Views(self.scans),
            walls=self.walls,
            floor_height=self.floor_height,
            ceiling_height=self.ceiling_height,
        )


def load(room: BenchRoom) -> tuple[mujoco.MjModel, mujoco.MjData]:
    """The compiled room with its doors where the MJCF has them.

    Raises:
        SimError: The MJCF does not compile.
    """
    try:
        model = mujoco.MjModel.from_xml_string(room.xml, dict(room.assets))
    except ValueError as error:
        raise SimError(f"room {room.name}: does not compile: {error}") from None
    data = mujoco.MjData(model)
    if model.nkey:
        mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_forward(model, data)
    return model, data


def judged_doors(room: BenchRoom) -> dict[frozenset[str], DoorTruth]:
    """The truth about the room's judged doors from its joints, by the names of their leaves.

    Raises:
        SimError: A door that is to be judged is none for `sim.doors`, or does not stand where it should.
    """
    model, data = load(room)
    truths = {frozenset(truth.leaf_names): truth for truth in true_doors(model, data)}
    for door in (door for wall in room.walls for door in wall.doors):
        if frozenset(door.bodies) not in truths:
            known = ", ".join(truth.name for truth in truths.values()) or "none"
            raise SimError(f"room {room.name}: no door {'+'.join(door.bodies)!r}; its doors: {known}")
        for body, position in zip(door.bodies, door.qpos, strict=True):
            stands = float(data.qpos[model.jnt_qposadr[model.body(body).jntadr[0]]])
            if abs(stands - position) > 1e-4:  # MJCF has six digits
                raise SimError(f"room {room.name}: {body!r} stands at {stands:.4f}, not at {position:.4f}")
    return truths


def scan_room(room: BenchRoom, config: MissionConfig, *, seed: int) -> ScannedRoom:
    """Scan and photograph a room from its scan places, register, colour, and find its structure, as the mission does.

    Args:
        room: Where.
        config: The parts that `STAGES` names are used.
        seed: Of all noise, which is also the room's own.

    Raises:
        MissionError: A scan cannot be registered, or no floor or wall is found.
        SimError: The room does not compile, or has no floor under a scan place.
    """
    rngs = [np.random.default_rng(s) for s in np.random.SeedSequence([seed, zlib.crc32(room.name.encode())]).spawn(3)]
    registrar = Registrar(config.registration)
    samples: list[PosedSample] = []
    scans: list[JudgedScan] = []
    errors: list[float] = []
    for truth, scan, photos in _measurements(room, config, rngs[0], rngs[1]):
        guess = truth @ _odometry_error(rngs[2]) if scans else truth  # a mission's start pose is known
        sample = sample_scan(scan, config.samples)
        found = registrar.register(sample, guess)
        if not found.accepted:
            raise MissionError(f"room {room.name}: scan {len(scans) + 1} is not registered: {found.reason}")
        samples.append(place(sample, found.world_from_scanner))
        scans.append(_coloured(scan, photos, found.world_from_scanner))
        errors.append(float(np.linalg.norm((found.world_from_scanner - truth)[:3, 3])))
    structure = find_structure(samples, config.structure, scanner=config.scanner)
    completed = room_from(structure, label_voxels(structure, samples, config.voxels, scanner=config.scanner), ())
    return ScannedRoom(
        scans=tuple(scans),
        walls=completed.walls,
        floor_height=completed.floor_height,
        ceiling_height=completed.ceiling_height,
        pose_errors=np.array(errors),
    )


def _measurements(
    room: BenchRoom, config: MissionConfig, scanner_rng: np.random.Generator, camera_rng: np.random.Generator
) -> Iterator[tuple[Pose, Scan, tuple[Photo, ...]]]:
    """What the instruments deliver at each scan place, and the true pose of the scanner there."""
    model, data = load(room)
    with Renderer(model) as renderer:
        scanner, camera = Scanner(model, config.scanner), Camera(renderer, config.camera)
        for truth in _true_poses(room, model, data):
            yield truth, scanner.scan(data, truth, scanner_rng), camera.photograph(data, truth, camera_rng)


def _true_poses(room: BenchRoom, model: mujoco.MjModel, data: mujoco.MjData) -> list[Pose]:
    """Poses of the scanner at the scan places."""
    rays = Rays(model, data)
    floor = room.walls[0].origin[2]
    base_from_scanner = scanner_mount()
    return [
        pose_on_floor(rays, np.array([x, y, floor]), np.array([np.cos(heading), np.sin(heading), 0.0]))
        @ base_from_scanner
        for x, y, heading in room.scan_places
    ]


def scanner_mount() -> Pose:
    """(4, 4) of the scanner's beam origin in the base of MoPAD."""
    model = mujoco.MjModel.from_xml_path(str(assets.FOLDER / "mopad" / "mopad.xml"))
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    site, base = data.site("beam_origin"), data.body("base")
    mount = np.eye(4)
    mount[:3, :3] = base.xmat.reshape(3, 3).T @ site.xmat.reshape(3, 3)
    mount[:3, 3] = base.xmat.reshape(3, 3).T @ (site.xpos - base.xpos)
    return mount


def _odometry_error(rng: np.random.Generator) -> Pose:
    """What the wheels are wrong by after the way from one scan to the next."""
    shift, turn = ODOMETRY_ERROR
    return from_rotation_vector(
        np.array([0.0, 0.0, rng.uniform(-turn, turn)]), np.array([*rng.uniform(-shift, shift, 2), 0.0])
    )


def _coloured(scan: Scan, photos: tuple[Photo, ...], world_from_scanner: Pose) -> JudgedScan:
    """The scan coloured by the mission, and the truth about gloss taken along the same way as the colour."""
    view = colour_scan(scan, photos, world_from_scanner)
    gloss = [replace(photo, image=np.repeat(photo.true_gloss[..., None], 3, 2)) for photo in photos]
    return JudgedScan(
        **vars(ColouredScan.of(scan, view, world_from_scanner)),
        gloss=colour_scan(scan, gloss, world_from_scanner).colours[:, 0].copy(),
    )
