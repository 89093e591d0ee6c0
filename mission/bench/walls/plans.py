"""Rooms on paper: what is built where, before any geometry.

A wall's own frame has its origin in the face's bottom left corner as seen from inside, x to the right, z up, and
**y into the wall**, so that what stands in the room before it has negative y.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from mission.bench.walls.finishes import STEEL, Finish
from mission.bench.walls.kit import Body, Hole, Kit

Side = Literal["left", "right"]


class Thing(Protocol):
    """Anything that stands on the floor or hangs on a wall; it faces -y and its back is at y = 0."""

    @property
    def width(self) -> float:
        """Along x, from -width / 2 to width / 2 [m]."""

    @property
    def depth(self) -> float:
        """Along -y, from the back to the front [m]."""

    def build(self, kit: Kit, body: Body) -> None:
        """Add its geoms to a body at the middle of its back, on the floor."""


@dataclass(frozen=True)
class Frame:
    """What surrounds a doorway."""

    style: Literal["none", "architrave", "block"]
    """Plain reveal; lining with architraves on both faces; a profile set into the wall, its face in view."""
    width: float
    """Of the architrave or of the profile's face [m]."""
    proud: float
    """How far it stands out of the wall [m]."""
    finish: Finish


NO_FRAME = Frame("none", 0.0, 0.0, STEEL)


@dataclass(frozen=True)
class DoorPlan:
    """A door in its doorway, as seen from inside."""

    left: float
    """Left edge of the leaves along the wall [m]."""
    width: float
    """Of all leaves together [m]."""
    height: float
    """Of the leaves' upper edge above the floor [m]."""
    finish: Finish
    frame: Frame = NO_FRAME
    recess: float = 0.02
    """How far the leaves' face lies behind the wall's; negative if before it [m]."""
    gap: float = 0.003
    """Round the leaves [m]."""
    bottom: float = 0.006
    """Of the leaves above the floor [m]."""
    leaves: Literal[1, 2] = 1
    hinge: Side = "left"
    """Of a single leaf; for a slide, the side to which it opens."""
    opens: Literal["inward", "outward"] = "inward"
    openings: tuple[float, ...] = (0.0,)
    """Of each leaf, left to right [rad; m for a slide]."""
    slides: bool = False
    panel: Literal["flat", "mouldings", "glazed", "vision"] = "flat"
    glass: Finish | None = None
    handle: Literal["lever", "knob", "bar", "push bar"] = "lever"
    metal: Finish = STEEL
    notices: tuple[tuple[float, float, Thing], ...] = ()
    """x of the middle in parts of the width, height [m], and what hangs on the door."""

    @property
    def right(self) -> float:
        return self.left + self.width

    @property
    def hole(self) -> Hole:
        """What is left out of the wall for it."""
        around = self.gap + {"none": 0.0, "architrave": 0.02, "block": self.frame.width}[self.frame.style]
        return Hole(self.left - around, -1.0, self.right + around, self.height + around)

    @property
    def reach(self) -> tuple[float, float]:
        """Left and right end of the doorway with all that frames it [m]."""
        around = self.gap + 0.02 + self.frame.width
        return self.left - around, self.right + around


@dataclass(frozen=True)
class WindowPlan:
    """A window in a wall."""

    left: float
    width: float
    bottom: float
    height: float
    finish: Finish
    mullions: int = 1

    @property
    def hole(self) -> Hole:
        return Hole(self.left, self.bottom, self.left + self.width, self.bottom + self.height)


@dataclass(frozen=True)
class Hung:
    """Something on a wall's face."""

    x: float
    z: float
    thing: Thing


@dataclass(frozen=True)
class Stood:
    """Something on the floor before a wall."""

    x: float
    """Of its middle [m]."""
    away: float
    """Of its back from the wall [m]."""
    thing: Thing
    turned: float = 0.0
    """Anticlockwise seen from above [rad]."""


@dataclass(frozen=True)
class Occluder:
    """Something that is to hide part of a door."""

    door: int
    """Index of the door in the wall."""
    away: float
    """Of its back from the wall [m]."""
    sizes: tuple[Thing, ...]
    """The thing in several sizes; the one that fits best is taken."""
    panel_share: float
    """Of the panel that it is to hide, 0..1."""
    frame_share: float
    """Likewise of the frame's left, upper and right side together."""


@dataclass(frozen=True)
class Band:
    """A part of a wall painted in another colour, from end to end."""

    bottom: float
    """Above the floor [m]."""
    top: float
    finish: Finish


@dataclass(frozen=True)
class WallPlan:
    """One side of a room."""

    finish: Finish
    """Of all but its bands."""
    thickness: float
    doors: tuple[DoorPlan, ...] = ()
    windows: tuple[WindowPlan, ...] = ()
    hung: tuple[Hung, ...] = ()
    stood: tuple[Stood, ...] = ()
    occluders: tuple[Occluder, ...] = ()
    bands: tuple[Band, ...] = ()
    """From the floor up."""
    skirting: Finish | None = None
    skirting_height: float = 0.08
    behind: Literal["corridor", "room", "yard"] = "corridor"
    is_judged: bool = True


@dataclass(frozen=True, eq=False)
class RoomPlan:
    """A room with its walls, things and scan places."""

    category: str
    corners: NDArray[np.float64]
    """(P, 2) of the floor, clockwise seen from above: wall i goes from corner i, its left end seen from inside, to
    corner i + 1 [m]."""
    height: float
    walls: tuple[WallPlan, ...]
    """One for each side."""
    floor: Finish
    ceiling: Finish
    scan_places: tuple[tuple[float, float, float], ...]
    """x, y [m], heading [rad]."""
    stood: tuple[tuple[float, float, float, Thing], ...] = field(default=())
    """Things anywhere: x, y [m], turn [rad]."""


@dataclass(frozen=True, eq=False)
class Site:
    """Where a wall is to be built."""

    length: float
    height: float
    paint: Finish
    """Of the room."""
    feet: tuple[float, ...]
    """Places along the wall that the scanner stands square to [m]."""


Maker = Callable[[np.random.Generator, Site], WallPlan]
"""Plans a wall for a site."""


def free_spans(taken: Sequence[tuple[float, float]], length: float, least: float) -> list[tuple[float, float]]:
    """Stretches of a wall [m], at least so long, that none of the taken ones touches."""
    spans, start = [], 0.0
    for low, high in [*sorted(taken), (length, length)]:
        if low - start >= least:
            spans.append((start, low))
        start = max(start, high)
    return spans
