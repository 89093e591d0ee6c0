"""The VZ-400 against Open3D's ray caster (Embree): a second opinion that shares no code with MuJoCo."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from sim.scanner import Scanner, ScannerParameters

TILT = np.array(
    [[0.9, -0.43588989, 0, 0.2], [0.43588989, 0.9, 0, -0.1], [0, 0, 1, 1.1], [0, 0, 0, 1]]
)  # yaw 25.8 deg: no wall is parallel to a picture


def box(centre: tuple[float, float, float], half: tuple[float, float, float]) -> tuple[np.ndarray, np.ndarray]:
    """Corners (8, 3) and triangles (12, 3) of a box."""
    corners = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * half + centre
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return corners, np.array([triangle for a, b, c, d in quads for triangle in ((a, b, c), (a, c, d))])


BOXES = [
    box((4, 0, 1), (0.1, 4, 2)),
    box((-4, 0, 1), (0.1, 4, 2)),
    box((0, 4, 1), (4, 0.1, 2)),
    box((0, -4, 1), (4, 0.1, 2)),
    box((0, 0, -0.1), (4, 4, 0.1)),
    box((2, 1.5, 0.5), (0.3, 0.4, 0.5)),
    box((-2, 2, 1.2), (0.5, 0.2, 0.05)),
]


@pytest.mark.slow
def test_ranges_agree_with_embree(world: Callable) -> None:
    import open3d as o3d

    geoms = "".join(
        f'<geom type="box" pos="{(p.min(0) + p.max(0)) @ np.diag([0.5] * 3)}" size="{np.ptp(p, axis=0) / 2}"/>'
        for p, _ in BOXES
    ).translate(str.maketrans("", "", "[]"))
    model, data = world(geoms)
    scanner = Scanner(model, ScannerParameters(pattern="draft", noise=False))
    scan = scanner.scan(data, TILT, np.random.default_rng(0))

    embree = o3d.t.geometry.RaycastingScene()
    for corners, triangles in BOXES:
        embree.add_triangles(corners.astype(np.float32), triangles.astype(np.uint32))
    e, a = np.meshgrid(scan.elevations, scan.azimuths, indexing="ij")
    beams = np.stack([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)], axis=-1) @ TILT[:3, :3].T
    rays = np.concatenate([np.broadcast_to(TILT[:3, 3], beams.shape), beams], axis=-1).astype(np.float32)
    true = embree.cast_rays(o3d.core.Tensor(rays))["t_hit"].numpy()

    both = scan.hits & np.isfinite(true)
    assert both.mean() > 0.5
    assert (np.abs(scan.ranges[both] - true[both]) < 1e-4).mean() > 0.9999
    measurable = np.isfinite(true) & (true > scanner.parameters.min_range)
    assert (measurable == scan.hits).mean() > 0.9999
