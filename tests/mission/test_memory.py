"""Memory that was freed goes back to the system."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

from mission.memory import peak_memory, release_freed_memory


def resident() -> int:
    """Resident set of this process now [bytes]."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * 4096


@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
def test_freed_memory_between_living_arrays_goes_back_to_the_system() -> None:
    # 400 blocks of 100 kB from the heap, every other one freed: 20 MB of holes
    blocks = [np.ones(100_000, np.uint8) for _ in range(400)]
    before = resident()
    kept = blocks[::2]
    del blocks
    release_freed_memory()
    assert len(kept) == 200
    assert before - resident() > 10e6
    assert peak_memory() > 0.9 * before  # the kernel counts pages in batches
