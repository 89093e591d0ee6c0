"""Pictures in bands of rows: what is worked out for a band stays in the processor's cache."""

from __future__ import annotations

_PIXELS = 45_000
"""Of a band, about: a dozen arrays of 32 bits make 2 MB."""


def bands(shape: tuple[int, ...]) -> list[slice]:
    """The rows of a picture (H, W, ...), some at a time: a multiple of four, save for the last band."""
    height, width = shape[:2]
    rows = max(4, _PIXELS // width // 4 * 4)
    return [slice(start, min(start + rows, height)) for start in range(0, height, rows)]
