"""The walls benchmark as a Rerun recording: its tables and figures, and every wall with what was found in it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import rerun as rr
import rerun.blueprint as rrb

from detector.result import Rectangle
from mission.recording.blueprint import tabbed

if TYPE_CHECKING:
    from mission.bench.walls.judging import WallJudgement, WallPicture

APPLICATION = "door-mission-bench"
TABLES = "/tables"
FIGURES = "/figures"
WALLS = "/walls"
TRUE, FOUND = (40, 90, 255), (235, 30, 30)
"""The paper's colours: the truth is blue, the detection red."""
COLUMNS = 3


def write_bench(
    path: Path, judgements: Sequence[WallJudgement], *, tables: str, figures: Sequence[Path], name: str
) -> None:
    """Write the recording; seeds are its timeline.

    Args:
        path: Of the .rrd file, which is overwritten.
        judgements: All walls of all seeds.
        tables: Markdown.
        figures: PNG files.
        name: Of the recording.
    """
    strict = rr.strict_mode()  # it is global, and not ours
    rr.set_strict_mode(True)
    rec = rr.RecordingStream(APPLICATION, recording_id=name)
    try:
        rec.set_log_time_enabled(False)
        rec.save(path, default_blueprint=_blueprint(judgements, figures))
        rec.send_recording_name(name)
        rec.log(TABLES, rr.TextDocument(tables, media_type="text/markdown"), static=True)
        for figure in figures:
            image = rr.EncodedImage(contents=figure.read_bytes(), media_type="image/png")
            rec.log(f"{FIGURES}/{figure.stem}", image, static=True)
        for judgement in judgements:
            rec.set_time("seed", sequence=judgement.seed)
            for number, picture in enumerate(judgement.pictures):
                _draw(rec, _entity(judgement, number), picture)
    finally:
        rec.flush()
        rec.disconnect()  # writes the footer
        rr.set_strict_mode(strict)


def _entity(judgement: WallJudgement, number: int) -> str:
    return f"{WALLS}/{judgement.wall.replace(' ', '_')}/{number}"


def _draw(rec: rr.RecordingStream, entity: str, picture: WallPicture) -> None:
    rec.log(f"{entity}/colour", rr.EncodedImage(contents=picture.jpeg, media_type="image/jpeg"))
    _draw_boxes(rec, f"{entity}/true", picture, picture.true, colour=TRUE, on_top=False)
    _draw_boxes(rec, f"{entity}/found", picture, picture.found, colour=FOUND, on_top=True)
    places = [(r.left + r.width / 2, picture.height - r.bottom - r.height / 2) for r in picture.found]
    rec.log(
        f"{entity}/labels",
        rr.Points2D(
            [(x / picture.pixel_size, y / picture.pixel_size) for x, y in places],
            labels=picture.labels,
            colors=FOUND,
            radii=0.0,
            show_labels=True,
        ),
    )


def _draw_boxes(
    rec: rr.RecordingStream,
    entity: str,
    picture: WallPicture,
    rectangles: Sequence[Rectangle],
    *,
    colour: tuple[int, int, int],
    on_top: bool,
) -> None:
    """Boxes on the image; those on top are thinner, so that the others show."""
    pixel = picture.pixel_size
    mins = [(r.left / pixel, (picture.height - r.top) / pixel) for r in rectangles]
    sizes = [(r.width / pixel, r.height / pixel) for r in rectangles]
    radius = rr.Radius.ui_points(1.0 if on_top else 2.5)
    rec.log(entity, rr.Boxes2D(mins=mins, sizes=sizes, colors=colour, radii=radius, draw_order=21 if on_top else 20))


def _blueprint(judgements: Sequence[WallJudgement], figures: Sequence[Path]) -> rrb.Blueprint:
    """A tab of results, then one a category with all its walls."""
    pictures = [rrb.Spatial2DView(origin=f"{FIGURES}/{figure.stem}", name=figure.stem) for figure in figures]
    results = rrb.Horizontal(
        rrb.TextDocumentView(origin=TABLES, name="Tables"),
        rrb.Vertical(*pictures),
        column_shares=[3, 2],
        name="Results",
    )
    tabs: list[rrb.Container] = [results]
    for category in dict.fromkeys(judgement.category for judgement in judgements):
        origins = {
            _entity(judgement, number): judgement.wall
            for judgement in judgements
            if judgement.category == category
            for number in range(len(judgement.pictures))
        }
        views = [rrb.Spatial2DView(origin=origin, name=wall) for origin, wall in origins.items()]
        tabs.append(rrb.Grid(*views, grid_columns=COLUMNS, name=category))
    return tabbed(tabs, timeline="seed")
