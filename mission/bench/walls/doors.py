"""Doors as joiners make them: frame, leaves on real joints, mouldings, glass and handles. All in the wall's frame."""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np

from mission.bench.walls.finishes import GLASS, Finish
from mission.bench.walls.kit import Body, Hole, Kit
from mission.bench.walls.plans import DoorPlan

LEAF_THICKNESS = 0.04
WIDEST_OPENING = np.radians(110.0)
_HANDLE_HEIGHT = 1.03
_HANDLE_INSET = 0.07
_SEAL = 0.002
"""How far the strip that a leaf closes against reaches before or behind it [m]."""


def build_door(kit: Kit, wall: Body, door: DoorPlan, thickness: float, name: str) -> tuple[str, ...]:
    """Add a door to a wall whose slab has the hole for it.

    Args:
        kit: the world.
        wall: body of the wall.
        door: what to build.
        thickness: of the wall [m].
        name: of the leaf; the leaves of a double door are told apart by `left` and `right`.

    Returns:
        The names of the leaves' bodies, left to right.
    """
    _build_frame(kit, wall, door, thickness)
    if door.slides:
        return (_build_slide(kit, wall, door, name),)
    leaves: list[_Leaf] = [_Leaf(name, door.left, door.right, door.hinge == "left", door.openings[0])]
    if door.leaves == 2:
        middle = (door.left + door.right) / 2
        first = _Leaf(f"{name} left", door.left, middle - door.gap / 2, True, door.openings[0])
        leaves = [first, _Leaf(f"{name} right", middle + door.gap / 2, door.right, False, door.openings[1])]
    for leaf in leaves:
        _build_leaf(kit, wall, door, leaf)
    return tuple(leaf.name for leaf in leaves)


@dataclass(frozen=True)
class _Leaf:
    name: str
    left: float
    right: float
    hinged_left: bool
    opening: float


def _build_frame(kit: Kit, wall: Body, door: DoorPlan, thickness: float) -> None:
    frame, hole = door.frame, door.hole
    inner = Hole(door.left - door.gap, 0, door.right + door.gap, door.height + door.gap)
    if frame.style == "architrave":
        _surround(kit, wall, inner, 0.02, (0.0, thickness), frame.finish)
        shown = Hole(inner.left - 0.006, 0, inner.right + 0.006, inner.top + 0.006)
        _surround(kit, wall, shown, frame.width, (-frame.proud, 0.0), frame.finish)
        _surround(kit, wall, shown, frame.width, (thickness, thickness + frame.proud), frame.finish)
    elif frame.style == "block":
        _surround(kit, wall, inner, hole.right - inner.right, (-frame.proud, min(0.09, thickness)), frame.finish)
    if not door.slides:
        _build_seal(kit, wall, door, inner)
    sill = frame.finish if frame.style != "none" else door.metal
    kit.box(wall, (hole.left, 0.0, -0.02), (hole.right, thickness, 0.001), sill)


def _build_seal(kit: Kit, wall: Body, door: DoorPlan, inner: Hole) -> None:
    """What the leaf closes against: behind it if it opens inward, else before it."""
    seal = Hole(door.left + _SEAL, 0, door.right - _SEAL, door.height - _SEAL)
    back = door.recess + LEAF_THICKNESS + 0.001
    depths = (back, back + 0.012)
    if door.opens == "outward" and door.recess > 0.016:
        depths = (door.recess - 0.013, door.recess - 0.001)
    finish = door.frame.finish if door.frame.style != "none" else door.finish
    _surround(kit, wall, seal, inner.right - seal.right, depths, finish)


def _surround(kit: Kit, wall: Body, inner: Hole, width: float, depths: tuple[float, float], finish: Finish) -> None:
    """Two posts and a head round an opening."""
    near, far = depths
    top = inner.top + width
    kit.box(wall, (inner.left - width, near, 0), (inner.left, far, top), finish)
    kit.box(wall, (inner.right, near, 0), (inner.right + width, far, top), finish)
    kit.box(wall, (inner.left, near, inner.top), (inner.right, far, top), finish)


def _build_leaf(kit: Kit, wall: Body, door: DoorPlan, leaf: _Leaf) -> None:
    inward, name, opening = door.opens == "inward", leaf.name, leaf.opening
    hinge = leaf.left if leaf.hinged_left else leaf.right
    face = door.recess if inward else door.recess + LEAF_THICKNESS
    turn = -1.0 if leaf.hinged_left == inward else 1.0  # about z, to open
    body = wall.add_body(name=name, pos=[hinge, face, 0], quat=[np.cos(opening / 2), 0, 0, turn * np.sin(opening / 2)])
    body.add_joint(
        name=f"{name} hinge",
        type=mujoco.mjtJoint.mjJNT_HINGE,
        axis=[0, 0, turn],
        range=[0, max(WIDEST_OPENING, opening)],
        limited=True,
        ref=opening,
        damping=2.0,
        frictionloss=0.5,
        armature=0.02,
    )
    width = leaf.right - leaf.left
    near = 0.0 if inward else -LEAF_THICKNESS
    span = (0.0, width) if leaf.hinged_left else (-width, 0.0)
    _build_panel(kit, body, door, span, near)
    edge, along = (width, 1.0) if leaf.hinged_left else (-width, -1.0)
    _build_handle(kit, body, door, edge, along, near)
    for height in (0.2, door.height / 2, door.height - 0.2):
        out = -0.004 if inward else 0.004
        kit.cylinder(body, (0, out, height - 0.045), (0, out, height + 0.045), 0.007, door.metal)


def _build_slide(kit: Kit, wall: Body, door: DoorPlan, name: str) -> str:
    """A leaf that slides along the wall; open, it stands beside its closed place."""
    way = -1.0 if door.hinge == "left" else 1.0
    opening = door.openings[0]
    body = wall.add_body(name=name, pos=[door.left + way * opening, door.recess, 0])
    body.add_joint(
        name=f"{name} slide",
        type=mujoco.mjtJoint.mjJNT_SLIDE,
        axis=[way, 0, 0],
        range=[0, door.width],
        limited=True,
        ref=opening,
        damping=2.0,
        frictionloss=0.5,
    )
    _build_panel(kit, body, door, (0.0, door.width), 0.0)
    edge, along = (0.0, -1.0) if way > 0 else (door.width, 1.0)
    for near, out in ((0.0, -1.0), (LEAF_THICKNESS, 1.0)):
        x = edge - along * 0.08
        face = sorted((near, near + out * 0.003))
        kit.box(body, (x - 0.02, face[0], 0.95), (x + 0.02, face[1], 1.12), door.metal)
    return name


def _build_panel(kit: Kit, body: Body, door: DoorPlan, span: tuple[float, float], near: float) -> None:
    (left, right), far = span, near + LEAF_THICKNESS
    width = right - left
    holes = _glazing(door, span)
    kit.slab(body, (left, near, door.bottom), (right, far, door.height), door.finish, holes)
    middle = near + LEAF_THICKNESS / 2
    for hole in holes:
        pane = (hole.left, middle - 0.003, hole.bottom), (hole.right, middle + 0.003, hole.top)
        kit.box(body, *pane, door.glass or GLASS)
    if door.panel == "mouldings":
        for low, high in ((0.12, 0.42), (0.52, 0.93)):
            inner = Hole(left + 0.14, low * door.height, right - 0.14, high * door.height)
            for face in ((near - 0.008, near), (far, far + 0.008)):
                _moulding(kit, body, inner, face, door.finish)
    if not door.notices:
        return
    for share, height, thing in door.notices:
        notice = body.add_body(pos=[left + share * width, near, height])
        thing.build(kit, notice)


def _glazing(door: DoorPlan, span: tuple[float, float]) -> list[Hole]:
    left, right = span
    if door.panel == "glazed":
        middle = 0.52 * door.height
        bars = [
            (0.42 * door.height, middle - 0.03),
            (middle + 0.03, 0.72 * door.height),
            (0.75 * door.height, door.height - 0.14),
        ]
        return [Hole(left + 0.13, low, right - 0.13, high) for low, high in bars[1:]]
    if door.panel == "vision":
        centre = (left + right) / 2
        return [Hole(centre - 0.11, 1.30, centre + 0.11, 1.75)]
    return []


def _moulding(kit: Kit, body: Body, inner: Hole, face: tuple[float, float], finish: Finish) -> None:
    strip = 0.025
    near, far = face
    for low, high in ((inner.bottom - strip, inner.bottom), (inner.top, inner.top + strip)):
        kit.box(body, (inner.left - strip, near, low), (inner.right + strip, far, high), finish)
    for low, high in ((inner.left - strip, inner.left), (inner.right, inner.right + strip)):
        kit.box(body, (low, near, inner.bottom), (high, far, inner.top), finish)


def _build_handle(kit: Kit, body: Body, door: DoorPlan, edge: float, along: float, near: float) -> None:
    """Handles on both faces near the free edge; `along` is the direction from the hinge to it."""
    x, z, metal = edge - along * _HANDLE_INSET, _HANDLE_HEIGHT, door.metal
    for face, out in ((near, -1.0), (near + LEAF_THICKNESS, 1.0)):
        away = face + out * 0.05
        if door.handle == "knob":
            kit.cylinder(body, (x, face, z), (x, face + out * 0.04, z), 0.012, metal)
            kit.ball(body, (x, away, z), (0.03, 0.025, 0.03), metal)
        elif door.handle == "bar":
            kit.tube(body, (x, away, z - 0.2), (x, away, z + 0.25), 0.014, metal)
            for end in (z - 0.15, z + 0.2):
                kit.cylinder(body, (x, face, end), (x, away, end), 0.008, metal)
        elif door.handle == "push bar" and out < 0:
            other = edge - along * (door.width / door.leaves - 0.09)
            kit.tube(body, (x, away, z), (other, away, z), 0.016, metal)
            for end in (x, other):
                kit.box(body, (end - 0.02, min(face, away), z - 0.06), (end + 0.02, max(face, away), z + 0.06), metal)
        else:
            plate = sorted((face, face + out * 0.006))
            kit.box(body, (x - 0.018, plate[0], z - 0.12), (x + 0.018, plate[1], z + 0.06), metal)
            kit.tube(body, (x, face, z), (x, away, z), 0.009, metal)
            kit.tube(body, (x, away, z), (x - along * 0.11, away, z), 0.009, metal)
