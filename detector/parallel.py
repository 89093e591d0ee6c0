"""Work on all processors: walls share nothing, nor do the views of one wall."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

Item = TypeVar("Item")
Result = TypeVar("Result")
BAND = 64
"""Rows of an image that are worked on at a time."""


def processors() -> int:
    """How many processors this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def each(function: Callable[[Item], Result], items: Iterable[Item]) -> list[Result]:
    """`[function(item) for item in items]`, with idle threads taking items from the front.

    The caller works, too: from the back, on whatever no thread has begun. So a call within a call waits for nothing but
    work that is under way, and there are never more threads at work than processors. numpy and OpenCV let go of the
    interpreter while they compute.
    """
    items = list(items)
    futures = [_POOL.submit(function, item) for item in items] if processors() > 1 else []
    results = {}
    try:
        for i in reversed(range(len(items))):
            begun = bool(futures) and not futures[i].cancel()
            results[i] = futures[i].result() if begun else function(items[i])
    finally:
        for future in futures:
            future.cancel()
    return [results[i] for i in range(len(items))]


def bands(rows: int) -> list[slice]:
    """The rows of an image in parts whose temporary arrays stay in a processor's cache."""
    return [slice(start, min(start + BAND, rows)) for start in range(0, rows, BAND)]


_POOL = ThreadPoolExecutor(max(1, processors() - 1), "detector")
