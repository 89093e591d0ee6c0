"""Wall clock times of things that are compared: measured in turns, so that a busy machine is busy for all of them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from time import perf_counter

import numpy as np

REPEATS = 5
"""Measurements of everything, after one that warms up."""


@dataclass(frozen=True)
class Timing:
    """Repeated measurements of one thing."""

    seconds: tuple[float, ...]

    @property
    def median(self) -> float:
        """[s]"""
        return float(np.median(self.seconds))

    @property
    def spread(self) -> float:
        """Half of what lies between the quartiles, relative to the median."""
        low, high = np.percentile(self.seconds, [25, 75])
        return float((high - low) / 2 / self.median)

    def scaled(self, factor: float) -> Timing:
        """The time of `factor` times as much work of the same kind."""
        return Timing(tuple(factor * seconds for seconds in self.seconds))


def in_turns(contenders: Mapping[str, Callable[[], object]], repeats: int = REPEATS) -> dict[str, Timing]:
    """Time each contender `repeats` times, all of them once a turn; a first turn is not counted."""
    seconds: dict[str, list[float]] = {name: [] for name in contenders}
    for turn in range(repeats + 1):
        for name, run in contenders.items():
            start = perf_counter()
            run()
            if turn:
                seconds[name].append(perf_counter() - start)
    return {name: Timing(tuple(times)) for name, times in seconds.items()}


def growth_exponent(sizes: Sequence[float], seconds: Sequence[float]) -> float:
    """Slope of the line through (log size, log seconds): 1 where time grows in proportion."""
    return float(np.polyfit(np.log(sizes), np.log(seconds), 1)[0])
