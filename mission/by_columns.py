"""Points (N, 3) whose x, y and z each lie together in memory: half the time where each is computed with by itself."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray


def gathered(parts: Sequence[NDArray[np.floating]]) -> NDArray[np.float64]:
    """All parts (N, 3) as one array (N, 3), by columns."""
    columns = np.empty((3, sum(map(len, parts))))
    return np.concatenate([part.T for part in parts], axis=1, out=columns).T


def chosen(points: NDArray[np.float64], which: NDArray[np.bool_] | NDArray[np.intp]) -> NDArray[np.float64]:
    """`points[which]`, by columns."""
    rows = np.flatnonzero(which) if which.dtype == np.bool_ else which
    return np.take(points.T, rows, axis=1).T


def distinct(cells: NDArray[np.int_]) -> NDArray[np.int_]:
    """The distinct rows of (N, 3) whole numbers, in ascending order."""
    low = cells.min(axis=0, initial=0)
    size = tuple(cells.max(axis=0, initial=0) - low + 1)
    keys = np.unique(np.ravel_multi_index(tuple((cells - low).T), size))
    return np.stack(np.unravel_index(keys, size), axis=1) + low
