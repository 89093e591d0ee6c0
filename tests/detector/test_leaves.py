"""What stands in a doorway (section 6): one of 0.9 x 2.0 m in a wall of 3 x 2.5 m, seen with 3 mm of noise."""

from __future__ import annotations

import numpy as np

from detector.leaves import describe_door
from detector.openings import Visibility
from detector.parameters import DetectorParameters
from detector.result import Door, Orthoimage, Rectangle

DOORWAY = Rectangle(1.0, 0.0, 1.9, 2.0)
HEIGHT = 2.5
PX = 0.01


def described(pane: Rectangle) -> Door:
    """The door whose closed leaf, 1 cm behind the wall's face, has a pane of glass that the beams cross."""
    rng = np.random.default_rng(0)
    u, v = (np.arange(n) * PX + PX / 2 for n in (300, 250))
    u, v = np.meshgrid(u, v[::-1])
    glass = (u > pane.left) & (u < pane.right) & (v > pane.bottom) & (v < pane.top)
    on_leaf = (u > DOORWAY.left) & (u < DOORWAY.right) & (v < DOORWAY.top)
    depth = np.where(on_leaf, -0.01, 0.0) + rng.normal(0, 0.003, u.shape)
    depth = np.where(glass, np.nan, depth).astype(np.float32)
    seen = np.where(glass, Visibility.THROUGH, Visibility.DATA).astype(np.uint8)
    image = Orthoimage(np.full((*u.shape, 3), 128, np.uint8), ~glass, depth, PX)
    points = np.stack([u[~glass], v[~glass], depth[~glass]], axis=1).astype(np.float32)
    return describe_door(DOORWAY, image, seen, points, HEIGHT, DetectorParameters())


def test_a_closed_leaf_with_a_large_pane_is_closed() -> None:
    # 0.6 of 0.9 m of width and 1.6 of 2.0 m of height are glass: two thirds of the columns hold a fifth of points
    door = described(Rectangle(1.15, 0.2, 1.75, 1.8))
    assert (door.kind, door.state, len(door.leaves)) == ("single", "closed", 1)
    assert (door.leaves[0].hinge, door.leaves[0].opens, door.opening_angle) == ("none", None, 0.0)
