"""What the Rerun recording shows to a person."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rerun.chunk import RrdReader

from detector.result import Candidate, Rectangle
from mission import events
from mission.events import Cost, DoorsEvaluated, Drove, Labelled, MissionStarted, Planned, RoomEntered
from mission.recording.blueprint import outlook
from mission.recording.rerun_doors import label_of
from mission.recording.rerun_figures import column_heights
from mission.recording.rerun_walls import SHOWN_CANDIDATES, shown_candidates
from tests.mission import recording_room as made
from tests.mission.recording_room import ESTIMATE, JOINT
from tests.mission.recording_story import story
from tests.mission.rerun_file import column, event_of, points, record


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return record(tmp_path_factory.mktemp("rrd") / "mission.rrd", story())


@pytest.mark.parametrize(
    "entity",
    [
        "/world/robot/body",
        "/world/scans/001/points",
        "/world/scans/002/points",
        "/world/ceiling/001",
        "/world/path/driven/0009",
        "/world/path/planned",
        "/world/candidates/all",
        "/world/candidates/chosen",
        "/world/map/voxels",
        "/world/map/grid",
        "/world/map/ceiling_voxels",
        "/world/walls/1/outlines",
        "/world/doors/1.2/1.2-a/leaf",
        "/world/truth/doors/hall\\/door\\ 1",
        "/world/camera/photo",
        "/world/shots/1.2/photo",
        "/walls/1.2/view/0/highlights/regions",
        "/walls/1.2/view/0/inpainted",
        "/walls/1.2/merged/depth",
        "/walls/1.2/openings/trinary",
        "/walls/1.2/wall_area/clusters",
        "/walls/1.2/edges/classes",
        "/walls/1.2/candidates/boxes",
        "/walls/1.4/merged/colour",
        "/plots/angle/estimate/1.2-a",
        "/plots/coverage/1/walls",
        "/plots/coverage/1/structure",
        "/activity",
        "/door/1.2-a",
        "/report/summary",
        "/report/configuration",
        "/report/key",
    ],
)
def test_the_tree_has(recording: Path, entity: str) -> None:
    assert entity in {chunk.entity_path for chunk in RrdReader(recording).store().stream().to_chunks()}


def test_there_is_a_tab_for_the_mission_for_each_wall_with_doors_and_for_the_results(recording: Path) -> None:
    reader, shown = RrdReader(recording), {}
    for blueprint in reader.blueprints():
        for chunk in reader.store(store=blueprint).stream().to_chunks():
            batch = chunk.to_record_batch()
            if "ContainerBlueprint:display_name" in batch.schema.names:
                (name,) = batch.column("ContainerBlueprint:display_name").to_pylist()[0]
                visible = "ContainerBlueprint:visible" in batch.schema.names
                shown[name] = not visible or batch.column("ContainerBlueprint:visible").to_pylist()[0] == [True]
    assert {name for name, visible in shown.items() if visible} >= {"Mission", "Wall 1.2", "Wall 1.3", "Results"}
    assert {name for name, visible in shown.items() if not visible} == {"Wall 1.1", "Wall 1.4"}


def test_estimates_and_joints_are_those_of_the_event(recording: Path) -> None:
    estimates = column(recording, "/plots/angle/estimate/1.2-a", "Measurements:values")
    joints = column(recording, "/plots/angle/joint/hall\\/door\\ 1", "Scalars:scalars")
    assert {value for row in estimates for value in row} == {np.degrees(ESTIMATE)}
    assert {value for row in joints for value in row} == {np.degrees(JOINT)}
    (error,) = column(recording, "/table/doors/1.2-a", "error_deg")
    assert error == pytest.approx([-1.0])  # 30 deg measured, the joint at 31


def test_the_errors_are_labelled_with_two_decimals(recording: Path) -> None:
    assert column(recording, "/figures/angle_error/labels", "Points2D:labels")[-1][0] == "1.2-a: -1.00 deg"


def test_walls_and_structure_are_two_lines_of_what_was_seen(recording: Path) -> None:
    labelled = [event.voxels.coverage for event in story() if isinstance(event, Labelled)]
    planned = [event.plan.coverage for event in story() if isinstance(event, Planned)]
    colours = []
    for what, shares in (("walls", labelled), ("structure", planned)):
        entity = f"/plots/coverage/1/{what}"
        values = [value for row in column(recording, entity, "Scalars:scalars") for value in row]
        assert values == pytest.approx([100 * share for share in shares])
        assert column(recording, entity, "SeriesLines:names") == [[f"room 1: {what} seen [%]"]]
        colours += column(recording, entity, "SeriesLines:colors")
    assert colours[0] != colours[1]


def test_what_is_written_beside_a_figure_is_in_lines_of_their_own() -> None:
    few, many = (np.diff(column_heights(count, top=-118.0)) for count in (4, 26))
    assert few == pytest.approx([12.0] * 3)
    assert many == pytest.approx([5.0] * 25)  # 130 / 26


def test_angles_are_written_with_their_deviation_beside_the_joint(recording: Path) -> None:
    labels = column(recording, "/figures/angle_against_joint/labels", "Points2D:labels")[-1]
    assert labels[0] == "1.2-a: 30.0 ± 0.4 deg (joint 31.0)"


def test_coverage_is_drawn_scan_by_scan(recording: Path) -> None:
    shares = [event.voxels.coverage for event in story() if isinstance(event, Labelled)]
    (strip,) = column(recording, "/figures/coverage/lines", "LineStrips2D:strips")[-1]
    expected = [(100 * scan / len(shares), -100 * share) for scan, share in enumerate(shares, start=1)]
    np.testing.assert_allclose(strip, expected, rtol=1e-6)


def test_a_door_is_drawn_where_it_was_found_and_labelled_with_its_joint(recording: Path) -> None:
    evaluation = event_of(DoorsEvaluated).doors[0]
    (leaf,) = column(recording, "/world/doors/1.2/1.2-a/leaf", "LineStrips3D:strips")
    np.testing.assert_allclose(leaf[0][:4], evaluation.leaf_corners_in_world[0], atol=1e-6)
    assert column(recording, "/world/doors/1.2/1.2-a/label", "Points3D:labels") == [["1.2-a: 30.0 deg (joint 31.0)"]]


def test_the_robot_moves_through_every_pose_of_its_way(recording: Path) -> None:
    rows = column(recording, "/world/robot", "Transform3D:translation")
    way = event_of(Drove).world_from_base[:, :3, 3]
    driven = np.array([row[0] for row in rows])
    distances = np.linalg.norm(driven[:, None] - way[None], axis=2).min(axis=0)
    assert distances.max() < 1e-6


def test_the_ceiling_is_apart_so_that_one_sees_into_the_room(recording: Path) -> None:
    below, above = points(recording, "/world/scans/001/points")[-1], points(recording, "/world/ceiling/001")[-1]
    assert below[:, 2].max() < 2.6 < above[:, 2].min() + 0.01  # the ceiling is 2.7 m high


def test_without_a_ceiling_the_cloud_is_whole(tmp_path: Path) -> None:
    events = story()[:7]
    structured = events[6]
    events[6] = replace(structured, structure=replace(structured.structure, ceiling_height=None))  # type: ignore[call-arg]
    path = record(tmp_path / "open air.rrd", events)
    assert points(path, "/world/scans/001/points")[-1][:, 2].max() == pytest.approx(2.7, abs=0.002)


def test_the_summary_quotes_every_door_and_every_miss(recording: Path) -> None:
    text = column(recording, "/report/summary", "TextDocument:text")[-1][0]
    assert "| 1.2-a | single | semi-open | 0.90 x 2.10 | 30.0 ± 0.40 | 31.0 | -1.00 |" in text
    assert "missed: `lift`" in text
    assert "**completed**: one room; 2.0 m driven in 2 min 52 s" in text


def judged(left: float, support: float, rejected_by: str | None) -> Candidate:
    return Candidate(Rectangle(left, 0, left + 1, 2), 1.0, 1.0, (support, 1.0, 1.0, 1.0), 0.0, rejected_by)


def test_accepted_candidates_are_all_drawn_and_rejected_ones_by_how_far_they_came() -> None:
    candidates = [judged(0, 0.9, None)] + [judged(i, i / 100, "sides") for i in range(50)]
    shown = shown_candidates(candidates)
    assert len(shown) == SHOWN_CANDIDATES + 1
    assert shown[-1].rejected_by is None  # drawn last, on top
    assert min(c.side_support[0] for c in shown[:-1]) == (50 - SHOWN_CANDIDATES) / 100


def test_rejected_candidates_that_look_the_same_are_drawn_once() -> None:
    shown = shown_candidates([judged(0, 0.5, "sides"), judged(0.02, 0.6, "size"), judged(0.5, 0.4, "size")])
    assert [c.side_support[0] for c in shown] == [0.6, 0.4]  # 0.98 / 1.02 of the first two is common


def test_the_eye_looks_down_on_the_middle_of_the_room() -> None:
    seen = outlook(np.array([[10.0, -7, 0], [16, -2.5, 2.7]]))
    assert seen.target == pytest.approx([13, -4.75, 1.35])
    assert seen.eye[2] > 2.7


def test_what_is_measured_in_a_room_is_drawn_where_the_room_lies(tmp_path: Path) -> None:
    """Room 2 is entered 10 cm aside, and a link moves it to 20 cm."""
    told = story()[:-1]

    def tell(kind: type[events.Event], **changes: Any) -> None:
        like = next(event for event in reversed(told) if isinstance(event, kind))
        told.append(replace(like, step=len(told), time=told[-1].time, **changes))

    tell(events.RoomEntered, room=2, how="door", door="1.2-a", world_from_room=made.pose(0.1, 0))
    tell(events.Photographed, room=2, scan_number=3)
    tell(events.Registered, room=2, scan_number=3)
    tell(events.Coloured, room=2, scan_number=3)
    tell(events.RoomsTied, room=2, world_from_room={1: np.eye(4), 2: made.pose(0.2, 0)})
    path = record(tmp_path / "two rooms.rrd", told)
    for entity, places in {"/world/scans/003": [0.1, 0.2], "/world/map": [0.0, 0.0, 0.1, 0.2]}.items():
        assert [x[0][0] for x in column(path, entity, "Transform3D:translation")] == pytest.approx(places)
    registered = next(event for event in told if isinstance(event, events.Registered) and event.room == 2)
    shot = made.pose(0.1, 0) @ registered.world_from_scanner @ made.photo().scanner_from_camera
    np.testing.assert_allclose(column(path, "/world/camera", "Transform3D:translation")[-1][0], shot[:3, 3], atol=1e-6)


def test_a_later_scan_adds_what_earlier_ones_did_not_show(tmp_path: Path) -> None:
    """The second scan sees the first one's points again, and ten new ones outside, 1 m apart."""
    told = [event for event in story() if isinstance(event, events.MissionStarted | events.RoomEntered)]
    first = next(event for event in story() if isinstance(event, events.Coloured))
    view = first.view
    points_in_world = np.concatenate(
        [view.points_in_world, np.array([[20.0 + x, 0, 0] for x in range(10)], np.float32)]
    )
    count = len(points_in_world)
    more = replace(
        view,
        points_in_world=points_in_world,
        colours=np.full((count, 3), 9, np.uint8),
        coloured=np.append(view.coloured, np.ones(10, bool)),
    )
    second = replace(first, scan_number=first.scan_number + 1, view=more)
    path = record(tmp_path / "two.rrd", [*told, first, second])
    (added,) = points(path, f"/world/scans/{second.scan_number:03d}/points")
    assert added[:, 0] == pytest.approx(np.arange(20.0, 30.0))


def test_points_tell_their_reflectance(tmp_path: Path) -> None:
    scanned = event_of(events.Scanned)
    count = int(np.isfinite(scanned.scan.ranges).sum())
    seen = replace(event_of(events.Coloured), view=made.view(np.random.default_rng(0), count))
    path = record(tmp_path / "told.rrd", [event_of(MissionStarted), event_of(RoomEntered), scanned, seen])
    (shown,) = column(path, f"/world/scans/{seen.scan_number:03d}/points", "reflectance_db")
    assert set(shown) == {-5}  # ranges of 3.0 less 8
    assert len(shown) == len(points(path, f"/world/scans/{seen.scan_number:03d}/points")[0])


def test_two_faces_of_a_door_share_a_label() -> None:
    here, there = event_of(DoorsEvaluated).doors[0], event_of(DoorsEvaluated).doors[0]
    assert label_of(here, replace(there, door_id="2.4-a")) == "1.2-a = 2.4-a: 30.0, 30.0 deg (joint 31.0)"


def test_of_rooms_that_the_robot_has_left_the_names_remain(tmp_path: Path) -> None:
    told = story()[:-1]
    entered = event_of(RoomEntered)
    told.append(replace(entered, step=len(told), time=told[-1].time, room=2, how="door", door="1.2-a"))
    path = record(tmp_path / "left.rrd", told)
    assert column(path, "/world/walls/1/names", "Points3D:show_labels")[-1] == [False]
    assert column(path, "/world/walls/1/room", "Points3D:labels")[-1] == ["room 1"]


def test_time_and_memory_of_a_mission_are_drawn_below_timing(tmp_path: Path) -> None:
    told = [replace(event, cost=Cost((("scan", 0.04 * event.step),), 10**8 + event.step)) for event in story()[:3]]
    record(tmp_path / "run.rrd", told)
    assert column(tmp_path / "run.rrd", "/timing/mission_stages/labels", "Points2D:labels")[-1] == ["scan: 0.1 s"]
    megabytes = [value for row in column(tmp_path / "run.rrd", "/timing/memory", "Scalars:scalars") for value in row]
    assert megabytes == pytest.approx([100.0, 100.000001, 100.000002])
