"""Legends of the images in the Rerun recording: words in the colours that they explain."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import rerun as rr

Entry = tuple[str, tuple[int, int, int]]
"""A word and its colour."""
ROW, COLUMN = 0.17, 1.0
"""Height of a row, and width of a column of a legend, in heights of the image."""


def draw_legend(rec: rr.RecordingStream, entity: str, shape: tuple[int, ...], entries: Sequence[Entry]) -> None:
    """Write a legend in a row below an image of shape (H, W); each word has room by its length."""
    height, width = shape[:2]
    lengths = np.array([len(text) + 4.0 for text, _ in entries])
    middles = (np.cumsum(lengths) - lengths / 2) / lengths.sum()
    _draw(rec, entity, entries, [(float(middle) * width, 1.01 * height) for middle in middles])


def draw_legend_column(rec: rr.RecordingStream, entity: str, shape: tuple[int, ...], entries: Sequence[Entry]) -> None:
    """Write a legend in a column on the right of an image of shape (H, W)."""
    height, width = shape[:2]
    places = [(width + COLUMN / 2 * height, 0.13 * number * height) for number in range(len(entries))]
    _draw(rec, entity, entries, places)


def _draw(
    rec: rr.RecordingStream, entity: str, entries: Sequence[Entry], places: Sequence[tuple[float, float]]
) -> None:
    labels, colours = [text for text, _ in entries], [colour for _, colour in entries]
    legend = rr.Points2D(places, labels=labels, colors=colours, radii=0.0, show_labels=True)  # labels hang from places
    rec.log(f"{entity}/legend", legend)
