"""Pictures of a benchmark run: precision over recall (Figure 22), failures over a value, reliability, all walls."""

from __future__ import annotations

import math
from collections.abc import Sequence
from io import BytesIO
from pathlib import Path

from PIL import Image, ImageDraw, ImageFont

from mission.bench.chart import COLOURS, Axis, Chart
from mission.bench.walls import paper
from mission.bench.walls.judging import WallJudgement, WallPicture
from mission.bench.walls.rooms import CATEGORIES
from mission.bench.walls.rows import DoorRow
from mission.bench.walls.statistics import OPEN_DEG, ReliabilityBin

TRUE, FOUND = (40, 90, 255), (235, 30, 30)
"""The paper's colours: the truth is blue, the detection red."""
GREY = (150, 150, 150)
CELL, COLUMNS, GAP = 520, 3, 14
"""Width of a wall on the contact sheet [px], walls in a row, space between them [px]."""
TALLEST = 300
"""Height of its picture at most [px]."""
LINE = 19
"""Height of a line of text [px]."""
_INK, _PAPER = (30, 30, 30), (255, 255, 255)


def precision_recall(path: Path, rows: Sequence[DoorRow]) -> None:
    """Precision over recall of all found doors, as in Figure 22."""
    doors = [row for row in rows if row.precision is not None and row.recall is not None]
    low = math.floor(10 * min([0.9, *(min(row.precision or 0, row.recall or 0) for row in doors)])) / 10
    step = 0.02 if low >= 0.9 else 0.1
    ticks = [low + step * k for k in range(round((1 - low) / step) + 1)]
    margin = step / 4
    x, y = (Axis(name, low - margin, 1 + margin, ticks) for name in ("recall", "precision"))
    chart = Chart(f"Precision and recall of {len(doors)} doors", x, y)
    for colour, category in zip(COLOURS, CATEGORIES, strict=False):
        points = [(row.recall or 0.0, row.precision or 0.0) for row in doors if row.category == category]
        if points:
            chart.points(points, colour=colour, label=category)
    chart.save(path)


def failures_over_value(path: Path, name: str, ours: Sequence[tuple[float, float]]) -> None:
    """Share of missed doors over the values of a parameter, beside the paper's."""
    values = [value for value, _ in ours]
    theirs = paper.TABLE_6.get(name)
    told = list(zip(theirs.values, theirs.failures, strict=True)) if theirs else []
    highest = max([0.4, *(share for _, share in [*ours, *told])])
    top = math.ceil(10 * highest) / 10
    chart = Chart(
        f"Doors missed over {name}",
        Axis(name, min(values) - 0.05 * max(values), 1.05 * max(values), values),
        Axis("share of doors missed", -0.02 * top, 1.02 * top, [0.1 * k for k in range(round(10 * top) + 1)]),
    )
    if told:
        chart.line(told, colour=GREY, label="paper, Table 6")
    chart.line(ours, colour=COLOURS[0], label="this detector")
    chart.save(path)


def reliability_curve(path: Path, bins: Sequence[ReliabilityBin]) -> None:
    """Share of detections that are doors over their confidence."""
    ticks = [0.2 * k for k in range(6)]
    axes = Axis("confidence", -0.03, 1.03, ticks), Axis("share that are doors", -0.03, 1.03, ticks)
    chart = Chart("Reliability of the confidence", *axes)
    chart.line([(0, 0), (1, 1)], colour=GREY)
    chart.line([(b.confidence, b.true) for b in bins], colour=COLOURS[0], label="detections")
    chart.save(path)


def contact_sheet(path: Path, judgements: Sequence[WallJudgement]) -> None:
    """Every wall with its truth in blue and its detections in red."""
    sheet: list[Image.Image] = []
    for category in dict.fromkeys(judgement.category for judgement in judgements):
        cells = [_cell(judgement) for judgement in judgements if judgement.category == category]
        sheet.append(_text(category, size=24))
        sheet += [_beside(cells[k : k + COLUMNS]) for k in range(0, len(cells), COLUMNS)]
    width = COLUMNS * (CELL + GAP) + GAP
    image = Image.new("RGB", (width, sum(strip.height + GAP for strip in sheet) + GAP), _PAPER)
    y = GAP
    for strip in sheet:
        image.paste(strip, (GAP, y))
        y += strip.height + GAP
    image.save(path)


def annotated(picture: WallPicture) -> Image.Image:
    """The merged orthoimage with outlines, at most `CELL` wide and `TALLEST` high."""
    image = Image.open(BytesIO(picture.jpeg)).convert("RGB")
    scale = min(CELL / image.width, TALLEST / image.height)
    image = image.resize((round(scale * image.width), round(scale * image.height)), Image.Resampling.BOX)
    pen = ImageDraw.Draw(image)
    metre = image.width / picture.width
    for rectangles, colour, thick in ((picture.true, TRUE, 4), (picture.found, FOUND, 2)):
        for r in rectangles:
            corners = (r.left, picture.height - r.top, r.right, picture.height - r.bottom)
            pen.rectangle([round(metre * c) for c in corners], outline=colour, width=thick)
    return image


def _cell(judgement: WallJudgement) -> Image.Image:
    pictures = [annotated(picture) for picture in judgement.pictures]
    lines = [(judgement.wall, _INK), *(_caption(row) for row in judgement.rows)]
    if judgement.remark:
        lines.append((judgement.remark[:75], FOUND))
    height = sum(picture.height + GAP for picture in pictures)
    cell = Image.new("RGB", (CELL, height + LINE * len(lines)), _PAPER)
    y = 0
    for picture in pictures:
        cell.paste(picture, (0, y))
        y += picture.height + GAP
    pen, font = ImageDraw.Draw(cell), ImageFont.load_default(14)
    for k, (text, colour) in enumerate(lines):
        pen.text((0, y - GAP // 2 + LINE * k), text, fill=colour, font=font)
    return cell


def _caption(row: DoorRow) -> tuple[str, tuple[int, int, int]]:
    """A door in one line, and its colour: red for what is wrong."""
    measured = f"{row.kind}, {row.state}{_at(row.angle_deg, row.opened_fraction)}"
    if row.is_false_positive:
        return f"false positive: {measured}", FOUND
    hidden = f", {row.panel_hidden:.0%} hidden" if row.panel_hidden and row.panel_hidden >= 0.005 else ""
    truth = f"{row.true_kind}{_at(row.true_angle_deg, row.true_opened_fraction)}{hidden}"
    if not row.found:
        return f"missed: {truth}", FOUND
    return f"P {row.precision:.3f}  R {row.recall:.3f}   {measured}   (truth: {truth})", _INK


def _at(angle_deg: float | None, opened_fraction: float | None) -> str:
    """An angle that is worth a word, or how far a sliding door is open."""
    if opened_fraction is not None:
        return f", {opened_fraction:.0%} open"
    return f" at {angle_deg:.1f} deg" if angle_deg and angle_deg > OPEN_DEG else ""


def _text(text: str, *, size: int) -> Image.Image:
    image = Image.new("RGB", (CELL, size + 8), _PAPER)
    ImageDraw.Draw(image).text((0, 0), text, fill=_INK, font=ImageFont.load_default(size))
    return image


def _beside(cells: Sequence[Image.Image]) -> Image.Image:
    strip = Image.new("RGB", (COLUMNS * (CELL + GAP), max(cell.height for cell in cells)), _PAPER)
    for k, cell in enumerate(cells):
        strip.paste(cell, (k * (CELL + GAP), 0))
    return strip
