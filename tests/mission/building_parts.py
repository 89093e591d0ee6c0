"""Doors of a made-up building, as rooms see them."""

from __future__ import annotations

from typing import Any

import numpy as np

from detector.result import Door, Leaf, Rectangle
from detector.room import Wall
from mission.door_faces import DoorFace

EMPTY = np.zeros((0, 2), np.float32)
UP = np.array([0.0, 0.0, 1.0])


def wall(x: float, y: float, yaw: float = 0.0, *, width: float = 4.0) -> Wall:
    """A wall 2.5 m high from its left end; at yaw 0 it runs along x and the room lies at smaller y."""
    u = np.array([np.cos(yaw), np.sin(yaw), 0.0])
    return Wall(np.array([x, y, 0.0]), u, UP, width, 2.5, np.ones((13, 20), np.uint8))


def leaf(angle_deg: float = 0.0, hinge: Any = "left", *, slid: float = 0.0) -> Leaf:
    return Leaf(hinge, np.radians(angle_deg), 0.001, None, EMPTY, slid)


def door(left: float, right: float, *leaves: Leaf, kind: Any = "single") -> Door:
    return Door(Rectangle(left, 0.0, right, 2.0), kind, "open", leaves or (leaf(),))


def face(room: int, where: Wall, one: Door, *, recess: float = np.nan, wall_number: int = 1) -> DoorFace:
    return DoorFace(f"{room}.{wall_number}-a", room, where, one, recess)


def both_sides(*, width: float = 0.9, thickness: float = 0.2, recesses: tuple[float, float] = (0.1, 0.06)) -> tuple[
    DoorFace, DoorFace
]:  # fmt: skip
    """A door in a wall along x: room 1 lies at y < 0, room 2 at y > the wall's thickness; its middle is at x = 2."""
    here = face(1, wall(0, 0), door(2 - width / 2, 2 + width / 2), recess=recesses[0])
    there = face(2, wall(4, thickness, np.pi), door(2 - width / 2, 2 + width / 2), recess=recesses[1])
    return here, there
