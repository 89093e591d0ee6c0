"""A chart with two axes as a PNG, drawn with Pillow, which scikit-image brings along anyway."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from PIL import Image, ImageDraw, ImageFont

INK, GRID, PAPER = (40, 40, 40), (225, 225, 225), (255, 255, 255)
COLOURS = ((31, 119, 180), (214, 96, 20), (44, 140, 60), (190, 40, 50), (130, 90, 170), (110, 80, 70))
"""Of series, told apart by people who see few colours, too: dark and light take turns."""
FINE = 2
"""Drawn so many times larger, then shrunk: smooth lines."""


@dataclass(frozen=True)
class Axis:
    """One axis."""

    label: str
    low: float
    high: float
    ticks: Sequence[float]

    def share(self, value: float) -> float:
        """Where a value lies, 0 to 1 from the low to the high end."""
        return (value - self.low) / (self.high - self.low)


class Chart:
    """Series of points in a frame; save it when all are drawn."""

    def __init__(self, title: str, x: Axis, y: Axis, *, size: tuple[int, int] = (840, 600)) -> None:
        """Draw the empty frame.

        Args:
            title: Above the frame.
            x: To the right.
            y: Upwards.
            size: Width and height [px].
        """
        self._x, self._y = x, y
        self._image = Image.new("RGB", (FINE * size[0], FINE * size[1]), PAPER)
        self._pen = ImageDraw.Draw(self._image)
        self._font = ImageFont.load_default(FINE * 15)
        self._left, self._top = FINE * 80, FINE * 50
        self._right, self._bottom = FINE * (size[0] - 190), FINE * (size[1] - 65)
        self._labels = 0
        self._draw_frame(title)

    def points(self, values: Sequence[tuple[float, float]], *, colour: tuple[int, int, int], label: str) -> None:
        """Draw a dot for each pair (x, y)."""
        self._label(label, colour)
        for x, y in values:
            self._dot(*self._place(x, y), colour)

    def line(self, values: Sequence[tuple[float, float]], *, colour: tuple[int, int, int], label: str = "") -> None:
        """Draw a line with dots through pairs (x, y)."""
        self._pen.line([self._place(x, y) for x, y in values], fill=colour, width=FINE * 2)
        if label:
            self.points(values, colour=colour, label=label)

    def save(self, path: Path) -> None:
        """Write it as a PNG."""
        self._image.resize((self._image.width // FINE, self._image.height // FINE), Image.Resampling.LANCZOS).save(path)

    def _place(self, x: float, y: float) -> tuple[float, float]:
        return (
            self._left + self._x.share(x) * (self._right - self._left),
            self._bottom + self._y.share(y) * (self._top - self._bottom),
        )

    def _dot(self, x: float, y: float, colour: tuple[int, int, int]) -> None:
        r = FINE * 4.5
        self._pen.ellipse((x - r, y - r, x + r, y + r), fill=colour, outline=PAPER, width=FINE)

    def _label(self, text: str, colour: tuple[int, int, int]) -> None:
        y = self._top + FINE * (12 + 24 * self._labels)
        self._dot(self._right + FINE * 18, y, colour)
        self._write((self._right + FINE * 30, y), text, anchor="lm")
        self._labels += 1

    def _write(self, place: tuple[float, float], text: str, *, anchor: str) -> None:
        self._pen.text(place, text, fill=INK, font=self._font, anchor=anchor)

    def _draw_frame(self, title: str) -> None:
        self._write((self._left, FINE * 24), title, anchor="lm")
        for value in self._x.ticks:
            x, _ = self._place(value, self._y.low)
            self._pen.line([(x, self._top), (x, self._bottom)], fill=GRID, width=FINE)
            self._write((x, self._bottom + FINE * 8), f"{value:g}", anchor="mt")
        for value in self._y.ticks:
            _, y = self._place(self._x.low, value)
            self._pen.line([(self._left, y), (self._right, y)], fill=GRID, width=FINE)
            self._write((self._left - FINE * 8, y), f"{value:g}", anchor="rm")
        self._pen.rectangle((self._left, self._top, self._right, self._bottom), outline=INK, width=FINE)
        middle = (self._left + self._right) / 2
        self._write((middle, self._bottom + FINE * 42), self._x.label, anchor="mm")
        label = Image.new("RGB", (FINE * 300, FINE * 24), PAPER)
        ImageDraw.Draw(label).text((FINE * 150, FINE * 12), self._y.label, fill=INK, font=self._font, anchor="mm")
        turned = label.rotate(90, expand=True)
        self._image.paste(turned, (FINE * 8, (self._top + self._bottom - turned.height) // 2))
