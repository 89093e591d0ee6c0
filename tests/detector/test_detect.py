"""From a room to its doors: simulated scans of 0.3 deg with 3 mm of noise and 2 mm of registration error."""

from __future__ import annotations

import os
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from pydantic import ValidationError

from detector.detect import detect_doors
from detector.metrics import overlap
from detector.parameters import DetectorParameters
from detector.result import Rectangle, WallResult
from detector.room import DetectorError, Room, View, Wall
from tests.detector.conftest import COARSE, DOORS, STEP_DEG
from tests.detector.synthetic import Box, DoorSpec, Layout, make_room

LEAST = 0.94
"""Precision and recall with pixels of 1 cm: four pixels and the gap round the leaf are 5.4 % of a door of 0.8 m."""


def quality(result: WallResult, spec: DoorSpec) -> tuple[float, float]:
    truth = Rectangle(spec.left, 0, spec.right, spec.height)
    best = max((overlap(d.rectangle, truth) for d in result.doors), key=lambda o: o.true_positive)
    return best.precision, best.recall


def test_three_doors_of_an_oblique_wall_are_found_where_they_are(three_doors: WallResult) -> None:
    assert len(three_doors.doors) == 3
    for spec in DOORS:
        assert min(quality(three_doors, spec)) > LEAST


def test_a_framed_door_is_reported_without_its_frame(three_doors: WallResult) -> None:
    door = three_doors.doors[0].rectangle
    frame = DOORS[0].frame
    assert door.left > DOORS[0].left - frame / 2 and door.top < DOORS[0].height + frame / 2


def test_states_hinges_and_angles_are_those_of_the_leaves(three_doors: WallResult) -> None:
    assert [d.state for d in three_doors.doors] == ["closed", "semi-open", "semi-open"]
    leaves = [d.leaves[0] for d in three_doors.doors]
    assert [leaf.hinge for leaf in leaves] == ["none", "left", "right"]
    assert [leaf.opens for leaf in leaves] == [None, "inward", "outward"]
    angles = [np.rad2deg(d.opening_angle) for d in three_doors.doors]
    assert angles == pytest.approx([0, 35, 70], abs=0.5)


def test_every_intermediate_product_has_the_walls_shape(three_doors: WallResult) -> None:
    shape = (270, 600)
    search, openings = three_doors.search, three_doors.openings
    images = [v.depth for v in three_doors.views] + [h.regions for h in three_doors.highlights]
    images += [three_doors.merged.depth, openings.trinary, openings.visibility, three_doors.wall_area.clusters]
    images += [search.colour_edges, search.depth_edges, search.edges]
    assert {i.shape for i in images} == {shape} and three_doors.view_numbers == (0, 1, 2)
    assert (search.edges == (search.colour_edges | search.depth_edges)).all()
    assert sum(c.rejected_by is None for c in search.candidates) == 3


def test_the_openings_at_the_floor_are_the_open_doors(three_doors: WallResult) -> None:
    middles = sorted((r.left + r.right) / 2 for r, d in zip(*_openings(three_doors), strict=True) if d)
    assert len(middles) == 2 and abs(middles[1] - 4.75) < 0.1


def _openings(result: WallResult) -> tuple:
    return result.openings.rectangles, result.openings.is_door


def test_window_poster_and_cupboards_are_no_doors(no_doors: WallResult) -> None:
    assert no_doors.doors == ()


def test_the_window_is_an_opening_off_the_floor(no_doors: WallResult) -> None:
    rectangles, is_door = _openings(no_doors)
    assert is_door == (False,)
    window = overlap(rectangles[0], Rectangle(3.2, 0.9, 4.4, 2.1))
    assert min(window.precision, window.recall) > 0.9


def test_a_panelled_door_is_one_door_and_not_its_panel() -> None:
    spec = DoorSpec(left=2.5, width=0.9, frame=0.07, panels=True)
    result = detect_doors(make_room(Layout(doors=[spec]), step_deg=STEP_DEG), COARSE)[0]
    assert len(result.doors) == 1 and min(quality(result, spec)) > LEAST


def test_two_leaves_make_one_double_door() -> None:
    leaves = [
        DoorSpec(left=2.0, width=0.8, angle_deg=50, colour=(0.5, 0.5, 0.6)),
        DoorSpec(left=2.806, width=0.8, hinge="right", colour=(0.5, 0.5, 0.6)),
    ]
    (door,) = detect_doors(make_room(Layout(doors=leaves), step_deg=STEP_DEG), COARSE)[0].doors
    assert door.kind == "double" and door.state == "semi-open"
    assert [np.rad2deg(leaf.opening_angle) for leaf in door.leaves] == pytest.approx([50, 0], abs=0.7)
    assert (door.rectangle.left, door.rectangle.right) == pytest.approx((2.0, 3.606), abs=0.025)  # two pixels


def test_a_doorway_without_a_leaf_into_nowhere_is_open_with_no_angle() -> None:
    spec = DoorSpec(left=2.5, has_leaf=False)
    (door,) = detect_doors(make_room(Layout(doors=[spec], corridor=False), step_deg=STEP_DEG), COARSE)[0].doors
    assert door.state == "open" and np.isnan(door.opening_angle)


def uncoloured(view: View) -> View:
    return replace(view, colours=np.zeros_like(view.colours), coloured=np.zeros_like(view.coloured))


@pytest.fixture(scope="module")
def open_door_room() -> Room:
    return make_room(Layout(doors=[DoorSpec(left=2.5, angle_deg=60, inward=False, recess=0.07)]), step_deg=STEP_DEG)


def test_an_open_door_is_found_without_any_colour(open_door_room: Room) -> None:
    room = replace(open_door_room, views=tuple(uncoloured(v) for v in open_door_room.views))
    (door,) = detect_doors(room, COARSE)[0].doors
    assert np.rad2deg(door.opening_angle) == pytest.approx(60, abs=0.5)


def test_one_view_is_enough(open_door_room: Room) -> None:
    (door,) = detect_doors(replace(open_door_room, views=open_door_room.views[1:2]), COARSE)[0].doors
    assert door.rectangle.left == pytest.approx(2.5, abs=0.02)


def test_the_same_room_gives_the_same_result_to_the_last_bit(open_door_room: Room) -> None:
    first, second = (detect_doors(open_door_room, COARSE)[0] for _ in range(2))
    assert first.doors[0].rectangle == second.doors[0].rectangle
    assert first.doors[0].opening_angle == second.doors[0].opening_angle
    np.testing.assert_array_equal(first.merged.colour, second.merged.colour)


def test_a_wall_that_no_view_saw_has_an_empty_result(open_door_room: Room) -> None:
    wall = open_door_room.walls[0]
    far = replace(wall, origin=wall.origin + [0, 0, 50.0])
    result = detect_doors(replace(open_door_room, walls=(far,), floor_height=50.0), COARSE)[0]
    assert result.doors == () and result.views == () and not result.merged.coloured.any()


def test_a_wall_shorter_than_a_door_has_none(open_door_room: Room) -> None:
    short = replace(open_door_room.walls[0], width=0.3)
    assert detect_doors(replace(open_door_room, walls=(short,)), COARSE)[0].doors == ()


def test_a_room_without_a_view_is_refused_by_name(open_door_room: Room) -> None:
    with pytest.raises(DetectorError, match=r"Room\.views"):
        detect_doors(replace(open_door_room, views=()), COARSE)


@pytest.mark.parametrize(
    ("change", "name"),
    [({"width": -1.0}, "width"), ({"u": np.array([2.0, 0, 0])}, "u"), ({"origin": np.full(3, np.nan)}, "origin")],
)
def test_a_malformed_wall_is_refused_by_the_name_of_its_field(open_door_room: Room, change: dict, name: str) -> None:
    wall: Wall = replace(open_door_room.walls[0], **change)
    with pytest.raises(DetectorError, match=rf"Wall\.{name}"):
        detect_doors(replace(open_door_room, walls=(wall,)), COARSE)


def test_an_unknown_parameter_is_refused() -> None:
    with pytest.raises(ValidationError, match="alpha4"):
        DetectorParameters(alpha4=0.1)


def test_the_defaults_are_the_papers() -> None:
    p = DetectorParameters()
    assert (p.pixel_size, p.grey_levels, p.seed_size, p.max_sigma, p.delta) == (0.005, 11, 5, 0.2, 0.7)
    assert (p.alpha1, p.alpha2, p.alpha3) == (0.5, 0.6, 0.03)


def test_the_detector_needs_neither_simulator_nor_mission() -> None:
    code = (
        "import sys, detector.detect; print(sorted({'mujoco', 'sim', 'mission', 'rerun', 'open3d'} & set(sys.modules)))"
    )
    root = os.path.dirname(os.path.dirname(os.path.dirname(__file__)))
    done = subprocess.run([sys.executable, "-c", code], cwd=root, capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_a_cupboard_before_the_wall_casts_a_shadow_and_no_door() -> None:
    cupboard = Box((3.0, 1.0, 0.4), (0.45, 1.0, 0.25), (0.7, 0.6, 0.5))
    assert detect_doors(make_room(Layout(extra=[cupboard]), step_deg=STEP_DEG), COARSE)[0].doors == ()


@pytest.mark.parametrize(("gap", "count"), [(0.0, 1), (0.1, 0)])
def test_a_panel_that_hangs_a_hand_above_the_floor_is_no_door(gap: float, count: int) -> None:
    # 0.9 m wide, 1.9 m high and 2 cm thick; a leaf on a rail where it reaches the floor, a mirror where it does not
    panel = Box((3.0, gap + 0.95, 0.01), (0.45, 0.95, 0.01), (0.3, 0.4, 0.6))
    doors = detect_doors(make_room(Layout(extra=[panel]), step_deg=STEP_DEG), COARSE)[0].doors
    assert len(doors) == count


@pytest.mark.parametrize(("bottom", "count"), [(0.0, 1), (1.15, 0)])
def test_a_picture_over_a_sofa_is_no_door_and_a_panel_behind_one_is(bottom: float, count: int) -> None:
    # 1.2 m wide, up to 1.95 m; between the picture and the sofa, 0.8 m high, wall shows
    panel = Box((3.0, (bottom + 1.95) / 2, 0.005), (0.6, (1.95 - bottom) / 2, 0.005), (0.2, 0.2, 0.22))
    sofa = Box((3.0, 0.4, 0.5), (1.0, 0.4, 0.45), (0.6, 0.2, 0.2))
    doors = detect_doors(make_room(Layout(extra=[panel, sofa]), step_deg=STEP_DEG), COARSE)[0].doors
    assert len(doors) == count


def test_two_doors_with_a_pillar_of_wall_between_are_two() -> None:
    specs = [DoorSpec(left=2.0, width=0.85, frame=0.04), DoorSpec(left=3.05, width=0.85, frame=0.04)]
    result = detect_doors(make_room(Layout(doors=specs), step_deg=STEP_DEG), COARSE)[0]
    assert [d.kind for d in result.doors] == ["single", "single"]
    assert min(min(quality(result, spec)) for spec in specs) > 0.9


def test_a_leaf_that_is_seen_on_its_edge_is_no_furniture() -> None:
    # at 90 deg into the room it stands out like the side of a cabinet, but beside its own hole
    spec = DoorSpec(left=2.4, width=0.85, height=2.0, angle_deg=90, hinge="left", inward=True, recess=0.008)
    (door,) = detect_doors(make_room(Layout(doors=[spec]), step_deg=STEP_DEG), COARSE)[0].doors
    assert np.rad2deg(door.opening_angle) == pytest.approx(90, abs=0.5)
    assert (door.rectangle.left, door.rectangle.right) == pytest.approx((2.4, 3.25), abs=0.02)
