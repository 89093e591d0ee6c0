"""Ctrl-C at safe places only."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType, TracebackType
from typing import Self


class Interrupts:
    """Holds SIGINT and SIGTERM back, save inside `raised()`, where they become KeyboardInterrupt."""

    def __init__(self) -> None:
        """Nothing is held back before the `with`."""
        self._pending = False
        self._open = False
        self._previous: dict[signal.Signals, signal.Handlers | int | None | object] = {}

    def __enter__(self) -> Self:
        for number in (signal.SIGINT, signal.SIGTERM):
            self._previous[number] = signal.signal(number, self._take)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        for number, handler in self._previous.items():
            signal.signal(number, handler)  # type: ignore[arg-type]

    def _take(self, number: int, frame: FrameType | None) -> None:
        self._pending = True
        if self._open:
            self._open = False  # a second one must not break into what follows
            raise KeyboardInterrupt

    @contextmanager
    def raised(self) -> Iterator[None]:
        """Let interrupts through inside the `with`; one that came before is raised at once."""
        try:
            self._open = True
            if self._pending:
                raise KeyboardInterrupt
            yield
        finally:
            self._open = False
