"""How sure the detector is of a door: a logistic function of what was measured on it (ours).

Each piece of evidence lies in [0, 1], and more of it never counts against the door, so that a low confidence can be
explained. The weights were fitted to 96 candidates that are doors and 97 rejected ones that are none, of seeds 1 to 3
of the walls benchmark; `mission.bench.walls.calibration` does that, and prints them. The confidence decides nothing.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from detector.candidates import Boxes, Scene
from detector.result import Candidate, Door, DoorSearch, Evidence
from detector.steps import Steps, is_set_apart, steps

BIAS = -14.06
WEIGHTS = Evidence(
    outline=2.47,
    weakest_side=3.82,
    one_surface=0.98,
    apart=4.92,
    wall_round=1.61,
    visible=2.10,
    contrast=1.75,
)
CLEAR_COLOUR = 0.1
"""A step of colour that leaves no doubt, of 1."""
CLEAR_DEPTH = 0.03
"""A step of depth that leaves no doubt [m]."""
MUCH_WALL = 0.1
"""A door has less than this share of wall area in it."""


def confidence(evidence: Evidence) -> float:
    """Probability in [0, 1] that a detection with this evidence is a door."""
    return float(1 / (1 + np.exp(-BIAS - np.dot(WEIGHTS, evidence))))


def measure(candidate: Candidate, scene: Scene, height: float) -> Evidence:
    """The evidence for a candidate.

    Args:
        height: Height of the wall [m].
    """
    r, px = candidate.rectangle, scene.merged.pixel_size
    left, right, top = (np.array([x / px - 0.5]) for x in (r.left, r.right, height - r.top))
    box = Boxes(left, right, top)
    change = steps(box, scene)
    inner = np.s_[int(top[0]) + 1 : scene.lowest_row, int(left[0]) + 1 : int(right[0]) + 1]
    sides = candidate.side_support[:3]  # the fourth is the floor
    return Evidence(
        outline=float(np.mean(sides)),
        weakest_side=min(sides),
        one_surface=min(candidate.dominant_colour_share, candidate.dominant_depth_share),
        apart=1.0 if is_set_apart(box, scene) else 1 - min(candidate.wall_share / MUCH_WALL, 1.0),
        wall_round=candidate.surroundings,
        visible=float(scene.visible[inner].mean()),
        contrast=_shared(change),
    )


def _shared(change: Steps) -> float:
    """The step that all sides of a rectangle share, of a clear one; 1 where none can be compared, as in an open door.

    What is a surface of its own differs from what is round it in one way: brighter, say, or deeper. Edges that happen
    to make a rectangle do not.
    """
    sizes = np.column_stack([change.colour / CLEAR_COLOUR, change.depth / CLEAR_DEPTH])
    known = sizes[~np.isnan(sizes).any(axis=1)]
    if len(known) == 0:
        return 1.0
    return float(np.clip(np.maximum(known.min(axis=0), -known.max(axis=0)).max(), 0, 1))


def judged(doors: Sequence[Door], search: DoorSearch, scene: Scene, height: float) -> list[Door]:
    """The doors with their confidences.

    Args:
        doors: One for each accepted candidate, in their order.
        height: Height of the wall [m].
    """
    accepted = [c for c in search.candidates if c.rejected_by is None]
    result = []
    for door, candidate in zip(doors, accepted, strict=True):
        evidence = measure(candidate, scene, height)
        result.append(replace(door, confidence=confidence(evidence), evidence=evidence))
    return result
