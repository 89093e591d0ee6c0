"""How deep a leaf lies in its wall, from a wall's orthoimage."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from mission.door_faces import door_faces, door_name
from tests.mission.building_parts import door, leaf, wall


def result(angle_deg: float = 0.0, *, recess: float = 0.08, noise: float = 0.003) -> Any:
    """A wall with a door from 1.0 to 1.9 m whose leaf, hinged on the left, lies in a recess and opens outward."""
    where, size = wall(0, 0), 0.005
    u, v = np.meshgrid((np.arange(800) + 0.5) * size, 2.5 - (np.arange(500) + 0.5) * size)
    within = (u > 1.0) & (u < 1.9) & (v < 2.0)
    leaf_depth = -recess - (u - 1.0) * np.tan(np.radians(angle_deg))
    depth = np.where(within, leaf_depth, 0.0) + noise * np.random.default_rng(0).standard_normal(u.shape)
    depth[(np.random.default_rng(1).random(u.shape) < 0.3)] = np.nan
    merged = SimpleNamespace(depth=depth.astype(np.float32), pixel_size=size)
    return SimpleNamespace(wall=where, merged=merged, doors=(door(1.0, 1.9, leaf(angle_deg, "left")),))


def test_doors_are_named_after_room_wall_and_a_letter() -> None:
    assert (door_name(2, 4, 0), door_name(2, 4, 25), door_name(2, 4, 26)) == ("2.4-a", "2.4-z", "2.4-aa")


@pytest.mark.parametrize("angle_deg", [0.0, 3.0])
def test_the_recess_of_a_leaf_is_measured_in_its_middle_to_a_millimetre(angle_deg: float) -> None:
    (face,) = door_faces([result(angle_deg)], room=1)
    assert face.recess == pytest.approx(0.08 + 0.45 * np.tan(np.radians(angle_deg)), abs=0.001)


def test_a_leaf_that_stands_open_has_no_recess() -> None:
    (face,) = door_faces([result(30.0)], room=1)
    assert np.isnan(face.recess)


def test_the_head_of_a_doorway_is_in_the_wall_s_plane() -> None:
    (face,) = door_faces([result()], room=1)
    np.testing.assert_allclose(face.head, [1.45, 0.0, 2.0], atol=1e-9)
