"""Pictures: a value lies where the axes say, and outlines where the doors are."""

from __future__ import annotations

from io import BytesIO
from pathlib import Path

from PIL import Image

from detector.result import Rectangle
from mission.bench.chart import Axis, Chart
from mission.bench.walls.figures import FOUND, TRUE, annotated, failures_over_value, reliability_curve
from mission.bench.walls.judging import WallPicture
from mission.bench.walls.statistics import ReliabilityBin

RED = (200, 0, 0)


def test_a_point_lies_where_the_axes_say(tmp_path: Path) -> None:
    axis = Axis("share", 0.0, 1.0, [0.0, 1.0])
    chart = Chart("title", axis, axis, size=(840, 600))
    chart.points([(0.5, 0.25)], colour=RED, label="one")
    chart.save(tmp_path / "chart.png")
    with Image.open(tmp_path / "chart.png") as image:
        # the frame goes from x = 80 to 840 - 190 = 650 and from y = 50 to 600 - 65 = 535
        assert image.getpixel((365, 535 - 485 // 4)) == RED
        assert image.getpixel((365, 50 + 485 // 4)) == (255, 255, 255)


def test_the_truth_is_outlined_in_blue_and_the_detection_in_red() -> None:
    grey = BytesIO()
    Image.new("RGB", (400, 200), (128, 128, 128)).save(grey, "JPEG")
    picture = WallPicture(
        jpeg=grey.getvalue(),
        pixel_size=0.01,
        width=4.0,
        height=2.0,
        true=(Rectangle(1.0, 0.0, 2.0, 1.5),),
        found=(Rectangle(1.2, 0.0, 2.2, 1.5),),
        labels=("single",),
    )
    image = annotated(picture)
    assert image.size == (520, 260)  # 130 pixels a metre
    assert image.getpixel((131, 150)) == TRUE  # left side at 1.0 m
    assert image.getpixel((156, 150)) == FOUND  # and at 1.2 m
    assert image.getpixel((200, 66)) == FOUND  # both upper sides at 2 - 1.5 m, the detection on top
    assert image.getpixel((140, 66)) == TRUE


def test_curves_are_written(tmp_path: Path) -> None:
    failures_over_value(tmp_path / "alpha1.png", "alpha1", [(0.1 * k, 0.05 * k) for k in range(1, 10)])
    failures_over_value(tmp_path / "sigma.png", "sigma", [(0.05 * k, 0.0) for k in range(1, 10)])  # the paper has none
    reliability_curve(tmp_path / "reliability.png", [ReliabilityBin(0.5, 0.4, 10), ReliabilityBin(0.9, 1.0, 25)])
    for path in tmp_path.iterdir():
        with Image.open(path) as image:
            assert image.size == (840, 600)
