"""Tests of normal noise by the million."""

from __future__ import annotations

import numpy as np
import pytest

from sim.noise import normal_noise


def test_quick_noise_is_normal():
    sample = normal_noise(3, (1000, 1001))
    assert sample.dtype == np.float32
    assert sample.mean() == pytest.approx(0, abs=0.005)
    assert sample.std() == pytest.approx(1, abs=0.005)
    assert (np.abs(sample) > 2).mean() == pytest.approx(0.0455, abs=0.001)
    assert np.abs(np.corrcoef(sample[:, :-1].ravel(), sample[:, 1:].ravel())[0, 1]) < 0.005
