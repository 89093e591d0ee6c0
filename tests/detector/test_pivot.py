"""The hinge side of a door of 0.9 x 2.0 m that stands open into the room; leaf of 4 cm, noise of 1 mm."""

from __future__ import annotations

from typing import Literal

import numpy as np
import pytest

from detector.pivot import hinge_side
from detector.result import Leaf, Rectangle

DOORWAY = Rectangle(1.0, 0.0, 1.9, 2.0)
BEFORE_IT, BESIDE_IT = np.array([1.6, 1.3, 2.0]), np.array([0.2, 1.3, 2.0])
"""Cameras on the side of a leaf hung on the left that looks into the doorway, and on the other."""


def leaf_face(angle_deg: float, *, inner: bool) -> np.ndarray:
    """(N, 3) points of a face of the leaf that hangs on the left at u = 1: its back, or the other one."""
    rng = np.random.default_rng(1 + inner)
    along = np.array([np.cos(np.deg2rad(angle_deg)), np.sin(np.deg2rad(angle_deg))])
    to_inner = np.array([along[1], -along[0]]) * (0.04 if inner else 0.0)
    plan = [1.0, 0.0] + rng.uniform(0.02, 0.9, (3000, 1)) * along + to_inner
    points = np.column_stack([plan[:, 0], rng.uniform(0, 2, 3000), plan[:, 1]])
    return (points + rng.normal(0, 0.001, points.shape)).astype(np.float32)


def found(face: np.ndarray, angle_deg: float, opens: Literal["inward", "outward"] = "inward") -> Leaf:
    return Leaf("left", float(np.deg2rad(angle_deg)), 1e-4, opens, face[:, [0, 2]])


@pytest.mark.parametrize("angle_deg", [86.0, 90.0, 105.0])
@pytest.mark.parametrize("side", [0.993, 1.0, 1.008])
@pytest.mark.parametrize("fitted_inner", [False, True])
def test_both_faces_of_a_leaf_tell_the_hinge_side_to_a_millimetre(
    angle_deg: float, side: float, fitted_inner: bool
) -> None:
    faces = [leaf_face(angle_deg, inner=inner) for inner in (False, True)]
    leaf = found(faces[fitted_inner], angle_deg)
    settled = hinge_side(Rectangle(side, 0.0, 1.9, 2.0), leaf, np.concatenate(faces), [BEFORE_IT, BESIDE_IT])
    assert settled.left == pytest.approx(1.0, abs=0.001) and settled.right == 1.9


def test_where_the_doorway_was_found_at_the_leafs_inner_face_it_goes_on_behind_the_leaf() -> None:
    faces = [leaf_face(95, inner=inner) for inner in (False, True)]
    settled = hinge_side(Rectangle(1.04, 0.0, 1.9, 2.0), found(faces[1], 95), np.concatenate(faces), [BEFORE_IT])
    assert settled.left == pytest.approx(1.0, abs=0.001)


def test_of_one_face_the_cameras_tell_which_it_is() -> None:
    # a leaf is usually 4 cm thick, as this one is
    inner, back = leaf_face(90, inner=True), leaf_face(90, inner=False)
    seen_from_before = hinge_side(Rectangle(1.005, 0.0, 1.9, 2.0), found(inner, 90), inner, [BEFORE_IT])
    seen_from_beside = hinge_side(Rectangle(1.005, 0.0, 1.9, 2.0), found(back, 90), back, [BESIDE_IT])
    assert (seen_from_before.left, seen_from_beside.left) == pytest.approx((1.0, 1.0), abs=0.001)


def test_one_face_that_cameras_on_both_sides_may_have_seen_tells_nothing() -> None:
    face, doorway = leaf_face(90, inner=True), Rectangle(1.005, 0.0, 1.9, 2.0)
    assert hinge_side(doorway, found(face, 90), face, [BEFORE_IT, BESIDE_IT]) == doorway


def test_a_side_well_away_from_the_leaf_is_kept() -> None:
    # hung on a pivot 2 cm inside the doorway: neither face is at the side
    faces, doorway = [leaf_face(90, inner=inner) for inner in (False, True)], Rectangle(0.98, 0.0, 1.9, 2.0)
    assert hinge_side(doorway, found(faces[0], 90), np.concatenate(faces), [BEFORE_IT]) == doorway


@pytest.mark.parametrize(("angle_deg", "opens"), [(75.0, "inward"), (90.0, "outward")])
def test_leaves_that_do_not_stand_in_the_room_at_the_wall_tell_nothing(
    angle_deg: float, opens: Literal["inward", "outward"]
) -> None:
    face = leaf_face(angle_deg, inner=True)
    assert hinge_side(DOORWAY, found(face, angle_deg, opens), face, [BEFORE_IT]) == DOORWAY


def test_a_leaf_that_hangs_on_the_right_is_the_mirror_image() -> None:
    mirror = np.array([-1, 1, 1], np.float32)
    faces = [leaf_face(95, inner=inner) * mirror + np.float32([2.9, 0, 0]) for inner in (False, True)]
    leaf = Leaf("right", float(np.deg2rad(95)), 1e-4, "inward", faces[1][:, [0, 2]])
    settled = hinge_side(Rectangle(1.0, 0.0, 1.907, 2.0), leaf, np.concatenate(faces), [np.array([1.3, 1.3, 2.0])])
    assert (settled.left, settled.right) == pytest.approx((1.0, 1.9), abs=0.001)
