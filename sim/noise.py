"""Normal noise by the million."""

from __future__ import annotations

from functools import lru_cache
from statistics import NormalDist

import cv2
import numpy as np
from numpy.typing import NDArray

_LEVELS = 2**16


def normal_noise(source: int | np.random.PCG64, shape: tuple[int, ...]) -> NDArray[np.float32]:
    """Draw standard normal numbers, eight times as fast as numpy's generator.

    A sensor needs tens of millions of them a scan. They are drawn from the 65536 equal quantiles of the normal
    distribution, so that they end at 4.3 sigma.

    Args:
        source: a seed, which gives the same numbers on every machine; or a source that goes on where it stopped.
            Four numbers are drawn at a time: those left over are lost.
        shape: of the result.
    """
    count = int(np.prod(shape))
    bits = source if isinstance(source, np.random.PCG64) else np.random.PCG64(source)
    words = bits.random_raw(-(-count // 4)).astype("<u8", copy=False).view("<u2")[:count]
    return np.asarray(cv2.LUT(words.reshape(shape[0], -1), _quantiles()), np.float32).reshape(shape)


@lru_cache(maxsize=1)
def _quantiles() -> NDArray[np.float32]:
    """(65536,) quantiles of the normal distribution, scaled to unit variance."""
    inverse = NormalDist().inv_cdf
    half = np.array([inverse((k + 0.5) / _LEVELS) for k in range(_LEVELS // 2)])
    quantiles = np.concatenate([half, -half[::-1]])
    return (quantiles / quantiles.std()).astype(np.float32)
