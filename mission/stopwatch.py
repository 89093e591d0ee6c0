"""Wall clock time per stage."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import perf_counter


class Stopwatch:
    """Adds up the wall clock time of each stage, and tells a listener which stage has begun."""

    def __init__(self, on_stage: Callable[[str], None] = lambda stage: None) -> None:
        """Start at zero.

        Args:
            on_stage: Called with the name of a stage when it begins.
        """
        self._on_stage = on_stage
        self.seconds: dict[str, float] = {}
        """Time of each stage, in the order of their first beginnings [s]."""

    @contextmanager
    def __call__(self, stage: str) -> Iterator[None]:
        """Count the time inside the `with` for a stage."""
        self._on_stage(stage)
        start = perf_counter()
        try:
            yield
        finally:
            self.seconds[stage] = self.seconds.get(stage, 0.0) + perf_counter() - start
