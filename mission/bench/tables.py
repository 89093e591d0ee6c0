"""Tables as text: for the terminal, for documents, for recordings."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class BenchTable:
    """A table as text."""

    title: str
    header: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]

    def markdown(self) -> str:
        """For documents."""
        lines = [self.header, ("---", *["---:"] * (len(self.header) - 1)), *self.rows]
        return f"## {self.title}\n\n" + "\n".join(f"| {' | '.join(line)} |" for line in lines) + "\n"
