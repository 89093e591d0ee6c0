"""Writes MJCF: the walls benchmark's furniture and doors draw with it as they do with its kit."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import Any, cast
from xml.etree import ElementTree

import numpy as np

from mission.bench.scenes.finishes import KNOWN, MATT, Named, Texture
from mission.bench.walls.finishes import Finish
from mission.bench.walls.kit import Body, Hole, Kit, Point
from mission.bench.walls.plans import Thing


class Node:
    """A body in the file; of the methods of MuJoCo's own `MjsBody` those that are needed."""

    def __init__(self, element: ElementTree.Element, *, is_leaf: bool = False) -> None:
        self.element = element
        self.is_leaf = is_leaf
        """Whether it is, or is fixed to, the leaf of a door."""

    def add_body(
        self, *, name: str | None = None, pos: Sequence[float] = (0, 0, 0), quat: Sequence[float] = (1, 0, 0, 0)
    ) -> Node:
        """A body in this one, turned about the vertical only."""
        element = ElementTree.SubElement(self.element, "body")
        if name:
            element.set("name", name.replace(" ", "_"))
        element.set("pos", numbers(pos))
        turn = 2 * np.degrees(np.arctan2(quat[3], quat[0]))
        if abs(turn) > 1e-6:
            element.set("euler", numbers([0, 0, turn]))
        return Node(element, is_leaf=self.is_leaf)

    def add_joint(
        self, *, name: str, axis: Sequence[float], range: Sequence[float], ref: float, **_common: Any
    ) -> None:
        """Makes this body the leaf of a door; what all doors have in common is in the file's defaults."""
        self.is_leaf = True
        self.element.set("childclass", "leaf")
        joint = ElementTree.SubElement(self.element, "joint", name=name.replace(" ", "_"), axis=numbers(axis))
        joint.set("range", numbers(np.degrees(range)))
        if ref:
            joint.set("ref", numbers([np.degrees(ref)]))

    def comment(self, text: str) -> None:
        """A remark before what comes next."""
        self.element.append(ElementTree.Comment(f" {text} "))


class Pen:
    """Adds geoms to bodies and collects the materials that they need."""

    def __init__(self) -> None:
        self.materials: dict[str, Finish] = {MATT.name: MATT}
        self.textures: dict[str, Texture] = {}
        self.of_meshes: set[str] = set()
        """Names of materials that meshes have."""
        self._names: Counter[str] = Counter()

    def place(self, thing: Thing, parent: Node, pos: Sequence[float], *, turned: float, owner: str) -> None:
        """Build a thing in a body of its own, which is named after it.

        Args:
            thing: What to build.
            parent: Body in whose frame it stands.
            pos: (x, y, z) of the middle of its back [m].
            turned: Anticlockwise [rad].
            owner: The room that has it.
        """
        kind = f"{owner}_{type(thing).__name__.lower()}"
        self._names[kind] += 1
        name = kind if self._names[kind] == 1 else f"{kind}_{self._names[kind]}"
        body = parent.add_body(name=name, pos=pos, quat=[np.cos(turned / 2), 0, 0, np.sin(turned / 2)])
        thing.build(cast(Kit, self), cast(Body, body))

    def box(self, body: Node, lower: Point, upper: Point, finish: Finish) -> None:
        """An upright box between two corners in the body's frame [m]."""
        low, high = np.array(lower), np.array(upper)
        self._geom(body, finish, pos=(low + high) / 2, size=(high - low) / 2)

    def slab(self, body: Node, lower: Point, upper: Point, finish: Finish, holes: Sequence[Hole] = ()) -> None:
        """A box with rectangular holes through it along y: as few boxes as there are steps along x."""
        kind = "leaf_panel" if body.is_leaf else "upright"
        for left, right, bottom, top in _solid(lower, upper, holes):
            low, high = np.array([left, lower[1], bottom]), np.array([right, upper[1], top])
            half = (high - low) / 2
            self._geom(body, finish, kind=kind, pos=(low + high) / 2, size=half[[0, 2, 1]])

    def tube(self, body: Node, start: Point, end: Point, radius: float, finish: Finish) -> None:
        """A round bar with round ends."""
        self._geom(body, finish, type="capsule", fromto=[*start, *end], size=[radius])

    def cylinder(self, body: Node, start: Point, end: Point, radius: float, finish: Finish) -> None:
        """A round bar with flat ends; an upright one on a leaf is its hinge, which its frame has room for."""
        is_hinge = body.is_leaf and start[:2] == end[:2]
        self._geom(body, finish, "hinge" * is_hinge, type="cylinder", fromto=[*start, *end], size=[radius])

    def ball(self, body: Node, centre: Point, radii: Point, finish: Finish) -> None:
        """An ellipsoid along the body's axes."""
        self._geom(body, finish, type="ellipsoid", pos=centre, size=radii)

    def mesh(self, body: Node, name: str, finish: Finish) -> None:
        """A mesh of the file; nothing collides with it, since MuJoCo would fill its bays."""
        element = ElementTree.SubElement(body.element, "geom", {"class": "visual", "name": name, "mesh": name})
        element.set("material", self.material(finish))
        self.of_meshes.add(self.material(finish))

    def material(self, finish: Finish) -> str:
        """The name of a finish that has one, which gets into the file; "" for others."""
        name = finish.name if isinstance(finish, Named) else KNOWN.get(finish, "")
        if name:
            self.materials.setdefault(name, finish)
            if isinstance(finish, Named) and finish.texture:
                self.textures.setdefault(finish.texture.name, finish.texture)
        return name

    def _geom(self, body: Node, finish: Finish, kind: str = "", type: str = "", **shape: Any) -> None:
        element = ElementTree.SubElement(body.element, "geom", {"class": kind} if kind else {})
        if type:
            element.set("type", type)
        for key, values in shape.items():
            element.set(key, numbers(values))
        if name := self.material(finish):
            element.set("material", name)
        else:
            element.set("rgba", numbers([*finish.colour, finish.alpha], digits=2))


def numbers(values: Sequence[float] | np.ndarray, digits: int = 4) -> str:
    """Numbers as people write them."""
    return " ".join(f"{round(float(value), digits) + 0.0:.10g}" for value in values)


def _solid(lower: Point, upper: Point, holes: Sequence[Hole]) -> list[tuple[float, float, float, float]]:
    """Left, right, bottom and top of upright pieces of a wall round its holes."""
    cuts = {lower[0], upper[0], *(x for hole in holes for x in (hole.left, hole.right) if lower[0] < x < upper[0])}
    pieces: list[tuple[float, float, float, float]] = []
    ordered = sorted(cuts)
    for left, right in zip(ordered[:-1], ordered[1:], strict=True):
        middle, bottom = (left + right) / 2, lower[2]
        here = sorted((hole for hole in holes if hole.left < middle < hole.right), key=lambda hole: hole.bottom)
        for hole in here:
            if hole.bottom > bottom:
                pieces.append((left, right, bottom, hole.bottom))
            bottom = max(bottom, hole.top)
        if upper[2] > bottom:
            pieces.append((left, right, bottom, upper[2]))
    return pieces
