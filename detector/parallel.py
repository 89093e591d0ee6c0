"""Work on all processors: walls share nothing, nor do the views of one wall."""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from typing import Any, Generic, TypeVar
from weakref import ref

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
    work = _Work(function, items)
    helpers = min(processors() - 1, len(work.waiting) - 1)
    helping = [_POOL.submit(_help, ref(work)) for _ in range(helpers)]
    try:
        work.do(work.waiting.pop)
        for helper in helping:
            if not helper.cancel():
                helper.result()
    finally:
        work.waiting.clear()
    return [work.results[i] for i in range(len(work.results))]


class _Work(Generic[Item, Result]):
    """What one call is about: the items that nobody has begun, and the results of the others."""

    def __init__(self, function: Callable[[Item], Result], items: Iterable[Item]) -> None:
        self._function = function
        self.waiting = deque(enumerate(items))
        self.results: dict[int, Result] = {}

    def do(self, take: Callable[[], tuple[int, Item]]) -> None:
        """Do items, taken one by one from either end, until none is waiting."""
        while self.waiting:
            try:
                i, item = take()
            except IndexError:  # another thread was faster
                return
            self.results[i] = self._function(item)


def _help(work: ref[_Work[Any, Any]]) -> None:
    """Take part in a call, unless it is over: threads come late, and what waits for them must keep no image alive."""
    called = work()
    if called is not None:
        called.do(called.waiting.popleft)


def bands(rows: int) -> list[slice]:
    """The rows of an image in parts whose temporary arrays stay in a processor's cache."""
    return [slice(start, min(start + BAND, rows)) for start in range(0, rows, BAND)]


_POOL = ThreadPoolExecutor(max(1, processors() - 1), "detector")
