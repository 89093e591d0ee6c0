"""A synthetic room with one wall of interest: boxes, analytic ray casting, flash light, honest voxel labels.

Everything is laid out in the wall's coordinates: u along the wall, v up, d into the room, [m].
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from detector.room import Room, View, VoxelLabel, Wall

WALL_THICKNESS = 0.12
SCANNERS = ((1.6, 1.2, 2.4), (3.2, 1.2, 3.0), (4.6, 1.2, 2.2))
WALL_COLOUR = (0.84, 0.82, 0.76)


@dataclass(frozen=True)
class Box:
    """An upright box, turned by `yaw` about its vertical axis."""

    centre: tuple[float, float, float]
    half: tuple[float, float, float]
    colour: tuple[float, float, float] = WALL_COLOUR
    yaw: float = 0.0
    gloss: float = 0.0
    stripes: float = 0.0
    """Relative amplitude of a texture along u."""


@dataclass(frozen=True)
class DoorSpec:
    """A doorway with its leaf. The truth is the rectangle [left, left + width] x [0, height] and the angle."""

    left: float
    width: float = 0.9
    height: float = 2.05
    angle_deg: float = 0.0
    hinge: str = "left"
    inward: bool = True
    recess: float = 0.008
    """Depth of the closed leaf's room face behind the wall's face."""
    colour: tuple[float, float, float] = (0.5, 0.35, 0.2)
    frame: float = 0.0
    """Width of the architrave, 0 for none."""
    frame_colour: tuple[float, float, float] = (0.95, 0.95, 0.95)
    has_leaf: bool = True
    panels: bool = False

    @property
    def right(self) -> float:
        return self.left + self.width


@dataclass(frozen=True)
class Layout:
    """What stands where."""

    doors: Sequence[DoorSpec] = ()
    extra: Sequence[Box] = ()
    holes: Sequence[tuple[float, float, float, float]] = ()
    """Windows: left, bottom, right, top."""
    width: float = 6.0
    height: float = 2.7
    wall_gloss: float = 0.0
    wall_colour: tuple[float, float, float] = WALL_COLOUR
    scanners: Sequence[tuple[float, float, float]] = SCANNERS
    corridor: bool = True
    """A wall 1.5 m behind; else there is nothing there and the beams do not return."""
    extra_behind: Sequence[Box] = field(default=())


def boxes_of(layout: Layout) -> list[Box]:
    """All boxes of a layout."""
    boxes = [
        *wall_boxes(layout),
        *layout.extra,
        Box((3, -0.1, 0), (12, 0.1, 12), (0.5, 0.5, 0.5)),
        Box((-0.1, 1.35, 3), (0.1, 1.35, 3.5)),
        Box((layout.width + 0.1, 1.35, 3), (0.1, 1.35, 3.5)),
    ]
    if layout.corridor:
        boxes.append(Box((3, 1.5, -1.7), (8, 1.5, 0.1), (0.7, 0.7, 0.75)))
    for door in layout.doors:
        boxes += door_boxes(door)
    return boxes


def wall_boxes(layout: Layout) -> list[Box]:
    """The wall round its holes: columns between hole edges, filled where no hole is."""
    holes = [(d.left - 0.003, -1.0, d.right + 0.003, d.height + 0.003) for d in layout.doors] + list(layout.holes)
    us = sorted({0.0, layout.width, *(h[0] for h in holes), *(h[2] for h in holes)})
    boxes = []
    for a, b in zip(us[:-1], us[1:], strict=True):
        inside = sorted((h[1], h[3]) for h in holes if h[0] <= a and h[2] >= b)
        low = 0.0
        for bottom, top in [*inside, (layout.height, layout.height)]:
            if bottom > low:
                boxes.append(
                    _from_to((a, low, -WALL_THICKNESS), (b, bottom, 0.0), layout.wall_colour, layout.wall_gloss)
                )
            low = max(low, top)
    return boxes


def _from_to(low: tuple, high: tuple, colour: tuple, gloss: float = 0.0) -> Box:
    a, b = np.array(low, float), np.array(high, float)
    return Box(tuple((a + b) / 2), tuple((b - a) / 2), colour, gloss=gloss)


def door_boxes(door: DoorSpec) -> list[Box]:
    """Leaf, panels and frame of a door. The hinge's axis is on the face of the leaf on the side it opens to."""
    boxes = []
    if door.frame:
        f, t = door.frame, 0.018
        left, right, top = door.left - 0.003, door.right + 0.003, door.height + 0.003
        boxes += [
            _from_to((left - f, 0, 0), (left, top + f, t), door.frame_colour),
            _from_to((right, 0, 0), (right + f, top + f, t), door.frame_colour),
            _from_to((left, top, 0), (right, top + f, t), door.frame_colour),
        ]
    if not door.has_leaf:
        return boxes
    thick = 0.04
    # the axis is on the leaf's face on the side that it opens to
    axis_d = -door.recess if door.inward else -door.recess - thick
    sign = 1.0 if door.hinge == "left" else -1.0
    axis_u = door.left if door.hinge == "left" else door.right
    angle = np.deg2rad(door.angle_deg) * (1 if door.inward else -1)
    parts = [
        (
            (door.width / 2, door.height / 2 + 0.004, 0.0),
            (door.width / 2, door.height / 2 - 0.004, thick / 2),
            door.colour,
        )
    ]
    if door.panels:
        darker = tuple(0.93 * c for c in door.colour)
        for low, high in ((0.25, 0.95), (1.1, door.height - 0.14)):
            parts.append(
                (
                    (door.width / 2, (low + high) / 2, 0.0),
                    (door.width / 2 - 0.13, (high - low) / 2, thick / 2 + 0.004),
                    darker,
                )
            )
    for (along, v, _), half, colour in parts:
        across = -thick / 2 if door.inward else thick / 2
        u = axis_u + sign * (along * np.cos(angle) - across * np.sin(angle))
        d = axis_d + along * np.sin(angle) + across * np.cos(angle)
        boxes.append(Box((float(u), v, float(d)), half, colour, yaw=float(sign * angle)))
    return boxes


def cast(origin: NDArray, directions: NDArray, boxes: Sequence[Box]) -> tuple[NDArray, NDArray, NDArray]:
    """Range (inf for none), box number and normal (N, 3) of the first hit of each ray."""
    best = np.full(len(directions), np.inf, np.float32)
    number = np.full(len(directions), -1)
    normals = np.zeros((len(directions), 3), np.float32)
    for k, box in enumerate(boxes):
        c, s = np.cos(box.yaw), np.sin(box.yaw)
        axes = np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])  # rows: the box's axes in (u, v, d)
        o = (axes @ (origin - np.array(box.centre))).astype(np.float32)
        d = directions if box.yaw == 0 else directions @ axes.T.astype(np.float32)
        half = np.array(box.half, np.float32)
        with np.errstate(divide="ignore", invalid="ignore"):
            t1, t2 = (-half - o) / d, (half - o) / d
        low, high = np.fmin(t1, t2), np.fmax(t1, t2)
        enter, leave = low.max(axis=1), high.min(axis=1)
        hit = (enter < leave) & (enter > 0.05) & (enter < best)
        axis = low[hit].argmax(axis=1)
        best[hit], number[hit] = enter[hit], k
        normals[hit] = axes[axis] * -np.sign(d[hit][np.arange(hit.sum()), axis])[:, None]
    return best, number, normals


def scan(layout: Layout, position: Sequence[float], step_deg: float, rng: np.random.Generator) -> tuple:
    """Points (u, v, d), colours and origins of one scan towards the wall."""
    boxes = boxes_of(layout)
    elevations = np.deg2rad(np.arange(60, -40, -step_deg))
    azimuths = np.deg2rad(np.arange(-89, 89, step_deg))
    e, a = np.meshgrid(elevations, azimuths, indexing="ij")
    directions = np.stack([np.cos(e) * np.sin(a), np.sin(e), -np.cos(e) * np.cos(a)], axis=-1).reshape(-1, 3)
    directions = directions.astype(np.float32)
    origin = np.array(position, float)
    ranges, number, normals = cast(origin, directions, boxes)
    hit = np.isfinite(ranges)
    directions, ranges, number, normals = directions[hit], ranges[hit], number[hit], normals[hit]
    noisy = ranges + rng.normal(0, 0.003, len(ranges)).astype(np.float32)
    camera = origin + (0, 0.2, 0)
    exact = origin + directions * ranges[:, None]
    colours = shade(exact, normals, number, camera, boxes, rng)
    return (origin + directions * noisy[:, None]).astype(np.float32), colours, origin, camera


def shade(points: NDArray, normals: NDArray, number: NDArray, camera: NDArray, boxes: Sequence[Box], rng) -> NDArray:
    """(N, 3) sRGB of points lit by a flash near the camera and some ambient light."""
    albedo = np.array([b.colour for b in boxes])[number]
    gloss = np.array([b.gloss for b in boxes])[number]
    stripes = np.array([b.stripes for b in boxes])[number]
    albedo = albedo * (1 + stripes * np.sin(points[:, 0] * 60) * np.sin(points[:, 0] * 37))[:, None]
    to_camera = camera - points
    distance = np.linalg.norm(to_camera, axis=1)
    cosine = np.clip((to_camera * normals).sum(axis=1) / distance, 0, 1)
    flash = cosine / distance**2
    light = albedo * (0.12 + 3.2 * flash)[:, None] + (gloss * cosine**400 * 9 / distance**2)[:, None]
    light = light * (1 + rng.normal(0, 0.02, light.shape))
    light = np.clip(light, 0, 1)
    srgb = np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)
    return np.rint(srgb * 255).astype(np.uint8)


def labels_of(layout: Layout, scans: Sequence[tuple], size: float = 0.2) -> NDArray[np.uint8]:
    """Voxel labels of the wall: points within half a voxel, else seen through or not."""
    shape = (int(np.ceil(layout.height / size)), int(np.ceil(layout.width / size)))
    labels = np.full(shape, VoxelLabel.OCCLUDED, np.uint8)
    rows, columns = np.indices(shape).reshape(2, -1)
    centres = np.stack([(columns + 0.5) * size, layout.height - (rows + 0.5) * size, np.zeros(len(rows))], axis=1)
    boxes = boxes_of(layout)
    for _, _, origin, _ in scans:
        rays = centres - origin
        distance = np.linalg.norm(rays, axis=1)
        ranges, _, _ = cast(origin, (rays / distance[:, None]).astype(np.float32), boxes)
        through = ranges > distance + 0.02
        labels[rows[through], columns[through]] = VoxelLabel.OPENING
    for points, *_ in scans:
        p = points[(np.abs(points[:, 2]) < size / 2) & (points[:, 1] > 0.02)]
        r, c = ((layout.height - p[:, 1]) / size).astype(int), (p[:, 0] / size).astype(int)
        inside = (r >= 0) & (r < shape[0]) & (c >= 0) & (c < shape[1])
        labels[r[inside], c[inside]] = VoxelLabel.OCCUPIED
    return labels


def make_room(
    layout: Layout,
    *,
    step_deg: float = 0.2,
    seed: int = 0,
    yaw: float = 0.0,
    shift=(0.0, 0.0, 0.0),
    jitter: float = 0.002,
) -> Room:
    """The room of a layout, turned by `yaw` [rad] and shifted in the world."""
    rng = np.random.default_rng(seed)
    u = np.array([np.cos(yaw), np.sin(yaw), 0.0])
    v = np.array([0.0, 0.0, 1.0])
    axes = np.stack([u, v, np.cross(u, v)])  # rows: u, v, d in the world
    origin = np.array(shift, float)
    scans = [scan(layout, position, step_deg, rng) for position in layout.scanners]
    labels = labels_of(layout, scans)
    views = []
    for points, colours, scanner, camera in scans:
        slip = rng.normal(0, jitter, 3)
        world = (points + slip) @ axes + origin
        views.append(
            View(
                points_in_world=world.astype(np.float32),
                colours=colours,
                coloured=np.ones(len(points), bool),
                scanner_in_world=(scanner + slip) @ axes + origin,
                camera_in_world=(camera + slip) @ axes + origin,
            )
        )
    wall = Wall(origin=origin, u=u, v=v, width=layout.width, height=layout.height, voxel_labels=labels)
    return Room(tuple(views), (wall,), float(origin[2]), float(origin[2]) + layout.height)
