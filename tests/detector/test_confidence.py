"""How sure the detector is, on a door of 0.9 x 2.0 m in a grey wall of 3 x 2.5 m with pixels of 1 cm."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from detector.candidates import Scene
from detector.confidence import WEIGHTS, confidence, measure
from detector.edges import Edges
from detector.leaves import closed_leaf, join_leaves
from detector.openings import Visibility
from detector.result import Candidate, Door, Evidence, Rectangle, WallResult
from tests.detector.conftest import plain_image

HEIGHT = 2.5
SHAPE = (250, 300)
DOORWAY = Rectangle(1.0, 0.0, 1.9, 2.0)
INSIDE = np.s_[50:, 100:190]


def scene(*, step: int, hidden: float = 0.0) -> Scene:
    """A door brighter than the wall by grey values, with a share of it hidden from the floor up."""
    merged = plain_image(SHAPE)
    merged.colour[INSIDE] += np.uint8(step)
    none, wall = np.zeros(SHAPE, bool), np.ones(SHAPE, bool)
    wall[INSIDE] = False
    visible = np.ones(SHAPE, bool)
    visible[250 - round(200 * hidden) :, 100:190] = False
    edges = Edges(*[none] * 8)
    seen = np.full(SHAPE, Visibility.DATA, np.uint8)
    return Scene(merged, seen, edges, wall, wall, visible, ~visible, floor_row=250, lowest_row=250, protrusion=0.06)


def candidate(**changes: object) -> Candidate:
    return replace(Candidate(DOORWAY, 0.9, 0.8, (1.0, 0.7, 0.85, 1.0), 0.02, None, 0.95), **changes)


def test_evidence_is_what_was_measured_on_the_rectangle() -> None:
    # a step of 13 of 255 is half of a clear one, 0.1
    found = measure(candidate(), scene(step=13, hidden=0.25), HEIGHT)
    assert found.outline == pytest.approx((1.0 + 0.7 + 0.85) / 3)
    assert found.weakest_side == 0.7
    assert found.one_surface == 0.8
    assert found.apart == 1  # whatever wall area is in it: it is brighter than the wall on all sides
    assert found.wall_round == 0.95
    assert found.visible == pytest.approx(0.75, abs=0.01)
    assert found.contrast == pytest.approx(0.51, abs=0.01)


def test_wall_inside_counts_against_what_is_like_the_wall() -> None:
    # of 0.1, which is too much, 0.02 is a fifth
    assert measure(candidate(), scene(step=0), HEIGHT).apart == pytest.approx(0.8)
    assert measure(candidate(wall_share=0.4), scene(step=0), HEIGHT).apart == 0


@pytest.mark.parametrize(("beside", "shared"), [(90, 10 / 25.5), (110, 0.0)])
def test_the_contrast_is_what_all_sides_share(beside: int, shared: float) -> None:
    # the door is brighter than the wall by 100 grey values; on its right is something as bright but for 10
    bright = scene(step=100)
    bright.merged.colour[50:, 190:200] += np.uint8(beside)
    assert measure(candidate(), bright, HEIGHT).contrast == pytest.approx(shared, abs=0.01)


@pytest.mark.parametrize("name", Evidence._fields)
def test_more_evidence_never_makes_less_sure(name: str) -> None:
    faint = Evidence(*[0.5] * len(Evidence._fields))
    assert getattr(WEIGHTS, name) >= 0
    assert confidence(faint._replace(**{name: 1.0})) >= confidence(faint)


def test_a_clear_door_is_nearly_certain_and_a_piece_of_wall_is_none() -> None:
    assert confidence(Evidence(*[1.0] * len(Evidence._fields))) > 0.95
    assert confidence(Evidence(0.6, 0.5, 0.9, 0.0, 1.0, 1.0, 0.1)) < 0.1


def test_all_doors_have_a_confidence(three_doors: WallResult) -> None:
    assert all(0.9 < door.confidence <= 1 and door.evidence is not None for door in three_doors.doors)


def test_a_double_door_is_as_sure_as_its_less_certain_half() -> None:
    halves = [
        Door(Rectangle(left, 0.0, left + 0.8, 2.0), "single", "closed", (closed_leaf(),), sure)
        for left, sure in ((1.0, 0.9), (1.8, 0.6))
    ]
    (door,) = join_leaves(halves)
    assert (door.kind, door.confidence) == ("double", 0.6)
