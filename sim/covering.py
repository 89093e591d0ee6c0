"""What of a closed leaf that slides shows from either side: the wall that it runs in or behind covers its edges."""

from __future__ import annotations

import numpy as np

from sim.rays import Rays

_STEP = 0.001
"""Of the search for the border of what is covered [m]."""
_REACH = 0.12
"""Nothing covers more of a leaf's edge; what does is furniture [m]."""
_BEFORE = 0.35
"""What covers a leaf lies at most this far before it: a wall's thickness [m]."""
_GRAZE = 0.002
"""What is nearer to the leaf's middle plane is what it touches, not what covers it [m]."""
_SHARES = (0.2, 0.5, 0.8)


def uncovered(rays: Rays, corners: np.ndarray, normal: np.ndarray) -> np.ndarray:
    """The part (4, 3) of a closed leaf that shows from the side that `normal` points to.

    Args:
        rays: through the building without its leaves.
        corners: (4, 3) of the leaf's middle plane in world: first bottom, second bottom, second top, first top [m].
        normal: (3,) unit normal of that plane.
    """
    along, up = corners[1] - corners[0], corners[3] - corners[0]
    across, upward = along / np.linalg.norm(along), up / np.linalg.norm(up)
    first = _covered(rays, [corners[0] + share * up for share in _SHARES], across, normal)
    second = _covered(rays, [corners[1] + share * up for share in _SHARES], -across, normal)
    top = _covered(rays, [corners[3] + share * along for share in _SHARES], -upward, normal)
    return corners + np.array([first * across, -second * across, -second * across - top * upward,
                               first * across - top * upward])  # fmt: skip


def _covered(rays: Rays, edge: list[np.ndarray], inward: np.ndarray, normal: np.ndarray) -> float:
    """How far from its edge a leaf is covered [m]: the median at some points (3,) of the edge."""
    return float(np.median([_covered_at(rays, point, inward, normal) for point in edge]))


def _covered_at(rays: Rays, point: np.ndarray, inward: np.ndarray, normal: np.ndarray) -> float:
    for step in range(1 + round(_REACH / _STEP)):
        seen_from = point + (step + 0.5) * _STEP * inward + _BEFORE * normal
        if not np.isfinite(rays.cast(seen_from, -normal[None], _BEFORE - _GRAZE).distances[0]):
            return step * _STEP
    return 0.0
