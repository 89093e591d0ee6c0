"""Compiling of the loops that numpy has no words for."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numba


def compiled(function: Callable[..., Any]) -> Any:
    """Compile a function when it is first called, so that it runs without Python's lock.

    What was compiled is kept beside the source, or in the user's cache (numba's `NUMBA_CACHE_DIR` says where), and
    compiled anew by each program where neither can be written. It is compiled again when its own file has changed: it
    must not depend on compiled functions and constants of other files.
    """
    try:
        return numba.njit(nogil=True, cache=True, error_model="numpy")(function)
    except RuntimeError:  # there is no place for the cache
        return numba.njit(nogil=True, error_model="numpy")(function)
