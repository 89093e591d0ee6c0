"""What recording a mission cost: space on the disk, and time."""

from __future__ import annotations

from pathlib import Path


def recording_cost(folder: Path, *, scans: int, seconds: float, wall_clock: float) -> dict[str, float | int | None]:
    """The block `recording` of summary.json.

    Args:
        folder: With mission.rrd and mission.mcap.
        scans: That are in them.
        seconds: That the mission waited for its recordings [s].
        wall_clock: Of the mission [s].

    Returns:
        Bytes a scan of each file, None without one; and the share of the wall clock.
    """
    sizes = {kind: _size(folder / f"mission.{kind}") for kind in ("mcap", "rrd")}
    per_scan = {f"{kind}_bytes_per_scan": size // scans if scans else None for kind, size in sizes.items()}
    return {**per_scan, "logging_share": round(seconds / wall_clock, 4) if wall_clock > 0 else None}


def _size(path: Path) -> int:
    """Of a file that may not have been begun [bytes]."""
    return path.stat().st_size if path.exists() else 0
