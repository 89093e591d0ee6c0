"""From detections to rows, means and tables: every number by mental arithmetic."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from small_room import small_room

from detector.metrics import overlap
from detector.result import Door, Leaf, Orthoimage, Rectangle
from mission.bench.walls import judging
from mission.bench.walls.glossy import NONE, HighlightCount, compare, highlights_in
from mission.bench.walls.judging import WallJudgement, WallPicture, judge_room
from mission.bench.walls.rows import DoorRow, door_rows
from mission.bench.walls.scanning import judged_doors
from mission.bench.walls.statistics import failures, metrics, reliability, stage_times
from mission.bench.walls.tables import table_4, table_5, table_6, wall_table
from mission.bench.walls.variants import SWEEPS, configured, variants
from mission.config import MissionConfig
from mission.errors import MissionError
from mission.evaluation import DoorEvaluation

NORTH = small_room().walls[0]
TRUE = Rectangle(2.0, 0.0, 2.9, 2.1)


def detection(rectangle: Rectangle, *, truth: str | None, angle_deg: float = 0.0) -> DoorEvaluation:
    """A detected door in the north wall, where x runs along the wall."""
    leaf = Leaf("left", np.radians(angle_deg), 0.0, "inward", np.zeros((0, 2), np.float32))
    r = rectangle
    corners = np.array([[r.left, 4, r.bottom], [r.right, 4, r.bottom], [r.right, 4, r.top], [r.left, 4, r.top]])
    return DoorEvaluation(
        door_id="1.1-a",
        wall=1,
        door=Door(rectangle, "single", "closed", (leaf,)),
        corners_in_world=corners,
        leaf_corners_in_world=(),
        true_name=truth,
        true_angle=0.0 if truth else None,
        overlap=overlap(rectangle, TRUE) if truth else None,
        true_leaf_corners_in_world=(),
    )


def rows_for(*evaluations: DoorEvaluation) -> tuple[DoorRow, ...]:
    """Rows of the north wall."""
    truth = judged_doors(small_room())[frozenset({"north_leaf"})]
    return door_rows(NORTH, 0, [(NORTH.doors[0], truth)], evaluations)


def judgement(*rows: DoorRow, seconds: float = 0.0, remark: str | None = None) -> WallJudgement:
    """Of one wall of 10 m2."""
    return WallJudgement(
        seed=0,
        category=rows[0].category,
        wall=rows[0].wall,
        rows=rows,
        pictures=(WallPicture(b"", 0.005, 4.0, 2.5, (), (), ()),),
        stage_seconds={"doors": seconds},
        area=10.0,
        highlights=NONE,
        pose_error=0.0,
        remark=remark,
        peak_bytes=0,
    )


def row(**fields: object) -> DoorRow:
    """A found door."""
    usual: dict[str, object] = {
        "seed": 0,
        "category": "simple",
        "wall": "simple 1.1",
        "door": "a",
        "true_kind": "single",
    }
    measured = {name: 1.0 for name in ("precision", "recall", "e_abs", "e_rel", "f05", "f1", "f2")}
    return DoorRow(**(usual | measured | {"found": True} | fields))  # type: ignore[arg-type]


MISSED = DoorRow(seed=0, category="simple", wall="simple 1.1", door="b", true_kind="single")
FALSE = DoorRow(seed=0, category="simple", wall="simple 1.1", door=None, found=True, confidence=0.3)


def test_a_found_door_has_the_papers_measures() -> None:
    # half a door: 0.9 m2 of 1.89 m2 are found, nothing beside it
    (found,) = rows_for(detection(Rectangle(2.0, 0.0, 2.45, 2.1), truth="north_leaf"))
    assert found.found
    assert (found.precision, found.recall, found.e_rel) == pytest.approx((1.0, 0.5, 0.5))
    assert found.e_abs == pytest.approx(0.945)
    assert found.f1 == pytest.approx(2 / 3)  # 2 * 1 * 0.5 / 1.5
    assert found.panel_hidden == 0


def test_a_row_of_a_sliding_door_has_the_share_that_is_open() -> None:
    # 0.27 m of a doorway of 0.9 m
    seen = detection(TRUE, truth="north_leaf")
    leaf = replace(seen.door.leaves[0], slid=0.27)
    (found,) = rows_for(replace(seen, door=replace(seen.door, kind="sliding", leaves=(leaf,))))
    assert (found.kind, found.opened_fraction) == ("sliding", pytest.approx(0.3))
    assert found.true_opened_fraction is None  # this one hangs on hinges
    assert rows_for(seen)[0].opened_fraction is None


def test_a_door_without_a_detection_is_missed() -> None:
    (missed,) = rows_for()
    assert (missed.door, missed.found, missed.precision) == ("north_leaf", False, None)


def test_a_detection_without_a_door_is_a_false_positive() -> None:
    true, false = rows_for(
        detection(TRUE, truth="north_leaf"), detection(Rectangle(0.5, 0, 1.4, 2), truth=None, angle_deg=20)
    )
    assert true.door == "north_leaf"
    assert false.is_false_positive
    assert false.precision is None
    assert false.angle_deg == pytest.approx(20)


def test_what_is_found_beyond_the_judged_face_is_not_judged() -> None:
    assert len(rows_for(detection(Rectangle(5.2, 0, 6.1, 2), truth=None))) == 1  # the face is 5 m long


def test_a_room_that_the_mission_makes_nothing_of_has_missed_doors(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object, **__: object) -> None:
        raise MissionError("no floor found under the scanner")

    monkeypatch.setattr(judging, "cached_scan", fail)
    north, east = judge_room(small_room(), MissionConfig(), seed=0, cache=tmp_path)
    assert north.remark == east.remark == "no floor found under the scanner"
    assert [row.found for row in (*north.rows, *east.rows)] == [False, False]


def test_means_are_over_the_found_doors() -> None:
    values = metrics([row(precision=0.9, recall=1.0), row(precision=1.0, recall=0.8), MISSED, FALSE])
    assert (values["doors"], values["found"], values["false_positives"]) == (3, 2, 1)
    assert (values["precision"], values["recall"]) == pytest.approx((0.95, 0.9))
    assert failures([row(), row(), row(), MISSED]) == 0.25


def test_there_is_no_mean_of_nothing() -> None:
    assert metrics([MISSED])["precision"] is None
    assert failures([FALSE]) is None


def test_angles_count_where_a_hinged_door_stands_open_or_is_said_to() -> None:
    rows = [
        row(true_angle_deg=30.0, angle_deg=31.0, angle_error_deg=1.0),
        row(true_angle_deg=0.0, angle_deg=3.0, angle_error_deg=3.0),
        row(true_angle_deg=0.0, angle_deg=0.0, angle_error_deg=0.0),
        row(true_angle_deg=0.0, angle_deg=9.0, angle_error_deg=9.0, true_kind="sliding"),
    ]
    values = metrics(rows)
    assert values["angle_mae_deg"] == 2.0  # of 1 and 3
    assert values["angle_max_deg"] == 3.0


def test_reliability_is_the_share_of_doors_among_detections_of_like_confidence() -> None:
    low, high = reliability([row(confidence=0.34), FALSE, row(confidence=1.0), row(confidence=0.96), MISSED])
    assert (low.confidence, low.true, low.count) == pytest.approx((0.32, 0.5, 2))
    assert (high.confidence, high.true, high.count) == pytest.approx((0.98, 1.0, 2))


def test_there_is_no_reliability_without_confidences() -> None:
    assert reliability([row()]) == []


def test_times_are_per_wall_and_per_area() -> None:
    times = stage_times([judgement(row(), seconds=1.0), judgement(row(), seconds=3.0)])
    assert times == {"doors": (2000.0, 200.0)}  # 4 s in 2 walls of 10 m2


def squares(*corners: tuple[int, int, int]) -> np.ndarray:
    """(100, 100) mask of squares given by row, column and side [px]."""
    mask = np.zeros((100, 100), bool)
    for r, c, side in corners:
        mask[r : r + side, c : c + side] = True
    return mask


def test_a_highlight_is_found_if_half_of_it_is_marked() -> None:
    # pixels of 5 mm: 6 x 6 are 9 cm2, 5 x 5 are 6.25 cm2, which is not asked for
    gloss = squares((0, 0, 10), (0, 40, 6), (0, 60, 5), (40, 0, 20))
    marked = squares((0, 0, 10), (40, 12, 20), (80, 80, 10))
    # the first is marked, the second not; of the fourth 8 of 20 columns are; of the marked ones the last is false
    assert compare(gloss, gloss, marked, pixel_size=0.005) == HighlightCount(true=3, found=1, marked=3, false=1)


def test_a_region_round_a_small_glint_is_false() -> None:
    gloss = squares((10, 10, 6))
    assert compare(gloss, gloss, squares((0, 0, 20)), pixel_size=0.005).false == 1  # 36 of 400: 9 %


def test_gloss_that_is_not_asked_for_may_be_marked() -> None:
    handle = squares((0, 0, 10))
    assert compare(squares(), handle, handle, pixel_size=0.005) == HighlightCount(true=0, found=0, marked=1, false=0)


def test_a_highlight_that_the_gap_round_a_door_cuts_counts_once() -> None:
    gloss = squares((40, 40, 20))
    gloss[:, 48:52] = False  # 20 mm
    assert compare(gloss, gloss, gloss, pixel_size=0.005) == HighlightCount(true=1, found=1, marked=1, false=0)


def flat(depth: float = 0.0) -> Orthoimage:
    """(100, 100) pixels of 5 mm."""
    colour, coloured = np.zeros((100, 100, 3), np.uint8), np.ones((100, 100), bool)
    return Orthoimage(colour, coloured, np.full((100, 100), depth, np.float32), 0.005)


def test_a_highlight_brightens_what_is_flat_by_five_percent() -> None:
    levels = np.where(squares((40, 40, 20)), np.uint8(13), np.uint8(12))  # 5 % of 255 are 12.75
    for depth in (0.0, -0.06, 0.02):  # the wall, a door in its reveal, a frame
        found = highlights_in(levels, flat(depth))
        assert found[44:56, 44:56].all()  # a square loses its corners
        assert not found[~squares((40, 40, 20))].any()


def test_gloss_on_furniture_handles_and_strips_is_no_highlight_of_the_wall() -> None:
    shiny = np.full((100, 100), 100, np.uint8)
    assert not highlights_in(shiny, flat(0.1)).any()
    tube = flat()
    tube.depth[:, 48:54] = 0.05  # 30 mm wide
    assert not highlights_in(np.where(tube.depth > 0, shiny, np.uint8(0)), tube).any()
    edge = np.where(abs(np.arange(100) - 49.5) < 2, shiny, np.uint8(0))  # 20 mm wide
    assert not highlights_in(edge, flat()).any()


def test_gloss_round_a_handle_is_its_plate() -> None:
    door = flat()
    door.depth[30:36, 40:60] = 0.05
    plate = np.where(squares((26, 40, 10)), np.uint8(100), np.uint8(0))
    assert not highlights_in(plate, door).any()
    assert highlights_in(plate, flat()).any()


def test_counts_of_highlights_add_up() -> None:
    assert HighlightCount(1, 2, 3, 4) + HighlightCount(1, 1, 1, 1) == HighlightCount(2, 3, 4, 5)


def test_the_papers_row_stands_below_ours() -> None:
    table = table_4([judgement(row(precision=0.9), MISSED, FALSE)])
    assert table.rows[0][:5] == ("simple", "2", "1", "1", "0.900")
    assert table.rows[1][:5] == ("  paper", "10", "-", "-", "0.995")
    assert table.rows[-1][:4] == ("  paper", "35", "34", "2")


def test_a_door_that_is_lost_without_correction_says_no() -> None:
    table = table_5([judgement(row())], [judgement(replace(MISSED, door="a"))])
    assert table.rows[0][:2] == ("simple 1.1", "yes")
    assert table.rows[0][6:8] == ("no", "-")


def test_a_sweep_stands_beside_the_papers_values() -> None:
    table = table_6("alpha1", {0.5: [judgement(row())], 0.9: [judgement(row(), MISSED)]})
    assert table.header == ("alpha1", "0.5", "0.9")
    assert table.rows[0] == ("failures", "0 %", "50 %")
    assert table.rows[1] == ("  paper", "0 %", "33 %")


def test_walls_with_something_wrong_are_listed() -> None:
    table = wall_table([judgement(row()), judgement(MISSED, FALSE, remark="dark")])
    assert table.rows == (("simple 1.1", "0", "b", "1", "dark"),)


def test_a_sweep_tries_nine_values_of_the_paper() -> None:
    configs = variants(MissionConfig(), ablate=None, sweep="alpha3")
    assert list(configs) == [0.01, 0.02, 0.03, 0.04, 0.05, 0.06, 0.07, 0.08, 0.09]
    assert [config.detector.alpha3 for config in configs.values()] == list(configs)


@pytest.mark.parametrize("name", list(SWEEPS))
def test_a_sweep_passes_the_value_that_is_configured(name: str) -> None:
    config = MissionConfig()
    configs = variants(config, ablate=None, sweep=name)
    assert configs[configured(config, name)] == config


def test_an_ablation_leaves_one_stage_out() -> None:
    plain, without = variants(MissionConfig(), ablate="highlights", sweep=None).values()
    assert plain == MissionConfig()
    assert without == plain.model_copy(
        update={"detector": plain.detector.model_copy(update={"correct_highlights": False})}
    )
