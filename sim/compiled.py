"""Compiling of the loops that numpy has no words for."""

from __future__ import annotations

import os
from collections.abc import Callable
from functools import lru_cache
from hashlib import sha256
from pathlib import Path
from typing import Any

import numba


def compiled(function: Callable[..., Any]) -> Any:
    """Compile a function when it is first called, so that it runs without Python's lock.

    What was compiled is kept in the user's cache; where that cannot be written, each program compiles anew.
    """
    config: Any = numba.config
    before, config.CACHE_DIR = config.CACHE_DIR, str(_folder())
    try:
        return numba.njit(nogil=True, cache=True, error_model="numpy")(function)
    except RuntimeError:  # there is no place for the cache
        return numba.njit(nogil=True, error_model="numpy")(function)
    finally:
        config.CACHE_DIR = before


@lru_cache(maxsize=1)
def _folder() -> Path:
    """Of these sources: numba looks at a function's own file alone, which uses functions and tuples of others."""
    cache = os.environ.get("NUMBA_CACHE_DIR") or os.environ.get("XDG_CACHE_HOME") or Path("~/.cache").expanduser()
    digest = sha256()
    for source in sorted(Path(__file__).parent.glob("*.py")):
        digest.update(source.read_bytes())
    return Path(cache) / "door-mission" / f"compiled-{digest.hexdigest()[:16]}"
