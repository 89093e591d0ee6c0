"""The process's memory: how much it took at most, and giving back what is free."""

from __future__ import annotations

import ctypes
import os
import resource
import sys
from pathlib import Path

_M_ARENA_MAX = -8
"""Of glibc's malloc.h."""


def peak_memory() -> int:
    """Largest resident set of this process so far [bytes]."""
    try:  # getrusage counts what the process was before it became this program, too
        status = Path("/proc/self/status").read_text()
        return next(int(line.split()[1]) * 1024 for line in status.splitlines() if line.startswith("VmHWM:"))
    except (FileNotFoundError, StopIteration):
        peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        return peak if sys.platform == "darwin" else peak * 1024  # Linux counts KiB


def current_memory() -> int:
    """Resident set of this process now [bytes]; at most so far, where the system does not tell."""
    try:
        pages = int(Path("/proc/self/statm").read_text().split()[1])
    except FileNotFoundError:
        return peak_memory()
    return pages * resource.getpagesize()


def hold_little_memory() -> None:
    """Set the process's allocators to give back what is free; call it before threads and slow libraries are there.

    By default glibc has a heap for every thread, and what one frees no other uses: a recording that is written by
    threads grew by 45 MB a scan. Rerun and Arrow bring an allocator of their own, mimalloc, which keeps the pages of
    threads that are gone: 4 MB a scan. Neither changes what is computed or, measurably, how long it takes.
    """
    os.environ.setdefault("MIMALLOC_PURGE_DELAY", "0")
    mallopt = getattr(ctypes.CDLL(None), "mallopt", None) if sys.platform == "linux" else None
    if mallopt is not None:
        mallopt(_M_ARENA_MAX, 1)


def release_freed_memory() -> None:
    """Hand the pages that are free between living arrays back to the system; nothing happens without glibc.

    Images and clouds of some megabytes come from the heap, where the long-lived clouds of each scan keep the holes
    between them: 0.15 GB a scan without this. It takes some milliseconds.
    """
    trim = getattr(ctypes.CDLL(None), "malloc_trim", None) if sys.platform == "linux" else None
    if trim is not None:
        trim(0)
