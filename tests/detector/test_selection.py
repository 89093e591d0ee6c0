"""Condition 4 (section 6.2) on rectangles whose other conditions are given."""

from __future__ import annotations

from detector.result import Candidate, Rectangle
from detector.selection import smallest


def candidate(
    left: float, right: float, top: float = 2.0, support: float = 1.0, around: float = 1.0, wall: float = 0.0
) -> Candidate:
    """A rectangle that fulfils all other conditions."""
    return Candidate(Rectangle(left, 0, right, top), 1.0, 1.0, (support, support, 1.0, 1.0), wall, None, around)


def doors(*candidates: Candidate) -> list[tuple[float, float]]:
    """Left and right sides of what stands."""
    return [(c.rectangle.left, c.rectangle.right) for c in smallest(candidates) if c.rejected_by is None]


def test_of_frame_and_leaf_the_leaf_stands() -> None:
    assert doors(candidate(0.92, 1.98, 2.08), candidate(1.0, 1.9)) == [(1.0, 1.9)]


def test_leaves_that_meet_are_one_double_door() -> None:
    assert doors(candidate(1.0, 1.8), candidate(1.8, 2.6), candidate(1.0, 2.6)) == [(1.0, 2.6)]


def test_doors_with_wall_between_are_two() -> None:
    # 0.2 m of wall; their hull is as wide as a double door
    assert doors(candidate(1.0, 1.9), candidate(2.1, 3.0), candidate(1.0, 3.0)) == [(1.0, 1.9), (2.1, 3.0)]


def test_a_door_and_wall_beside_it_are_no_double_door() -> None:
    # 0.9 m of door and 1.0 m of wall: half of the wider rectangle is wall
    assert doors(candidate(1.0, 1.9), candidate(1.0, 2.9, wall=0.5)) == [(1.0, 1.9)]


def test_mouldings_on_a_leaf_are_no_door() -> None:
    assert doors(candidate(1.0, 1.9, 2.05), candidate(1.1, 1.9, 1.9, support=0.62)) == [(1.0, 1.9)]


def test_a_line_within_the_doorway_is_not_its_side() -> None:
    # the crease of a leaf 2 cm from the jamb: some of what is outside of it is leaf
    assert doors(candidate(2.0, 2.8, around=0.98), candidate(2.02, 2.8, around=0.8)) == [(2.0, 2.8)]
