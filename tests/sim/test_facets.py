"""Tests of what lies between the pixels of a depth picture."""

from __future__ import annotations

import numpy as np
import pytest

from sim.facets import bent_blocks, on_facets
from sim.render import Depth


def picture(raw):
    """A depth picture of one geom, from its raw depth."""
    return Depth(raw.astype(np.float32), np.ones(raw.shape, np.uint16), np.array([-1, 0], np.int32))


def test_a_grazing_plane_has_no_bent_blocks_but_a_small_step_in_it_has():
    column = np.arange(60.0)
    raw = np.tile(1 + 0.05 * column, (20, 1)).astype(np.float32)  # 5 % a pixel: a plane at 87 deg of incidence
    inside = np.s_[2:-3, 2:-3]
    assert not bent_blocks(raw)[inside].any()
    raw[:, 30:] += 0.02  # less than one pixel's slope; the pixels on both sides of it are bent
    assert set(np.nonzero(bent_blocks(raw)[inside].any(axis=0))[0] + 2) == {28, 29, 30}


@pytest.mark.parametrize("bulge", [1, -1])
def test_between_two_facets_their_planes_are_prolonged_to_where_they_meet(bulge):
    # A ridge or a groove at column 20.3, rising by 1 % a row: at 20.2 it is 0.001 off its edge, at 20.6 0.003.
    column, row = np.meshgrid(np.arange(40.0), np.arange(12.0))
    surface = picture(2 - bulge * 0.01 * np.abs(column - 20.3) + 0.01 * row)
    block = np.array([5 * 40 + 20] * 2, np.int32)
    raw, proven = on_facets(surface, block, np.float32([0.2, 0.6]), np.float32([0, 0]))
    assert proven.all()
    assert raw == pytest.approx([2.05 - bulge * 0.001, 2.05 - bulge * 0.003], abs=1e-5)


def test_where_a_surface_ends_nothing_is_proven():
    step = np.where(np.arange(40) < 20, 2.0, 1.5) * np.ones((12, 1))
    narrow = np.where(np.arange(40) == 20, 1.9, step)  # a reveal of one pixel between wall and leaf
    for raw in (step, narrow):
        blocks = (5 * 40 + np.arange(18, 22)).astype(np.int32)
        proven = on_facets(picture(raw), blocks, np.full(4, 0.5, np.float32), np.full(4, 0.5, np.float32))[1]
        values = raw[5, 18:23]
        assert not proven[values[:-1] != values[1:]].any()


def test_where_two_geoms_meet_nothing_is_proven():
    roof = picture(2 - 0.01 * np.abs(np.arange(40.0) - 20.3) * np.ones((12, 1)))
    roof.segments[:, 21:] = 2
    block = np.array([5 * 40 + 20], np.int32)
    assert not on_facets(roof, block, np.float32([0.5]), np.float32([0.5]))[1].any()
