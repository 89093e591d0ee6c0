"""Rays against everything that is seen or bumped into."""

from __future__ import annotations

import numpy as np

from sim.rays import Rays


def test_rays_meet_a_geom_that_nothing_collides_with_beside_one_that_things_do(world) -> None:
    model, data = world(
        """<body>
             <geom name="seen" type="box" pos="3 0 0" size="0.5 1 1" contype="0" conaffinity="0"/>
             <geom name="solid" type="box" pos="0 9 0" size="0.1 0.1 0.1"/>
           </body>"""
    )
    hits = Rays(model, data).cast(np.zeros(3), np.array([[1.0, 0, 0], [-1.0, 0, 0]]))
    np.testing.assert_allclose(hits.distances, [2.5, np.inf])  # the near face of the box at 3 m
    assert hits.geoms[0] == model.geom("seen").id
