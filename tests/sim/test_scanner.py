"""Tests of the scanner: pattern, cast, what comes back, noise."""

from __future__ import annotations

import numpy as np
import pytest

from sim.scanner import PATTERNS, Scanner, ScannerParameters

ROOM = """
<geom type="box" size="4 3 .1" pos="0 0 -.1"/>  <geom type="box" size="4 3 .1" pos="0 0 2.8"/>
<geom type="box" size=".1 3 2" pos="4.1 0 1"/>  <geom type="box" size=".1 3 2" pos="-4.1 0 1"/>
<geom type="box" size="4 .1 2" pos="0 3.1 1"/>  <geom type="box" size="4 .1 2" pos="0 -3.1 1"/>
<geom type="box" size=".3 .4 .9" pos="2.5 -2 .9" euler="0 0 30"/>
<geom type="cylinder" size=".05 1.3" pos="-2 1 1.35"/>  <geom type="sphere" size=".3" pos="-2.5 -1.5 1"/>
<geom type="box" size=".02 .45 1.05" pos="1.5 2.5 1.05" euler="0 0 -35"/>
"""
EXACT = ScannerParameters(pattern="draft", noise=False)
WHITE = 'rgba="1 1 1 1"'


def pose(x=0.0, y=0.0, z=0.0, yaw=0.0, tilt=0.0):
    """world_from_scanner, turned about the vertical after a tilt about y [rad]."""
    cy, sy, ct, st = np.cos(yaw), np.sin(yaw), np.cos(tilt), np.sin(tilt)
    world_from_scanner = np.eye(4)
    world_from_scanner[:3, :3] = np.array([[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]]) @ [
        [ct, 0, st],
        [0, 1, 0],
        [-st, 0, ct],
    ]
    world_from_scanner[:3, 3] = x, y, z
    return world_from_scanner


def directions(scan, rows, columns):
    """(N, 3) unit vectors of single beams in the scanner frame."""
    e, a = scan.elevations[rows], scan.azimuths[columns]
    return np.column_stack([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])


def scan_once(scene, world_from_scanner=None, parameters=EXACT, seed=0, **hidden):
    scanner = Scanner(scene[0], parameters, **hidden)
    place = np.eye(4) if world_from_scanner is None else world_from_scanner
    return scanner.scan(scene[1], place, np.random.default_rng(seed))


def beam(scan, azimuth_deg, elevation_deg):
    """Indices of the beam next to a direction."""
    row = np.abs(scan.elevations - np.radians(elevation_deg)).argmin()
    return row, int(round(azimuth_deg / 360 * len(scan.azimuths))) % len(scan.azimuths)


@pytest.mark.parametrize(("name", "beams"), [("panorama_40", 22_500_000), ("panorama_60", 10_002_000)])
def test_a_pattern_covers_100_degrees_from_plus_60_all_round(name, beams):
    pattern = PATTERNS[name]
    step = 2 * np.pi / pattern.columns
    assert pattern.rows * pattern.columns == beams
    assert np.degrees(pattern.elevations()[[0, -1]]) == pytest.approx([60, -40], abs=0.05)
    assert np.allclose(np.diff(pattern.elevations()), -step)
    assert np.allclose(np.diff(pattern.azimuths()), step)


def test_beams_agree_with_rays_to_a_few_micrometres(world, true_ranges):
    scene = world(ROOM)
    place = pose(0.3, -0.2, 1.2, yaw=0.47, tilt=0.03)
    scan = scan_once(scene, place, EXACT.model_copy(update={"pattern": "panorama_60"}))
    rng = np.random.default_rng(1)
    rows, columns = rng.integers(scan.ranges.shape[0], size=20_000), rng.integers(scan.ranges.shape[1], size=20_000)
    true = true_ranges(scene, place[:3, 3].copy(), directions(scan, rows, columns) @ place[:3, :3].T)
    measured = scan.ranges[rows, columns]
    known = true >= 1.5
    assert known.mean() > 0.9
    assert np.abs(measured - true)[known].max() < 5e-6
    assert np.isnan(measured[~known]).all()


def beams_that_meet(scene, true_ranges, scan, place, some):
    """Rows, columns and true ranges [m] of some of the beams that a ray has a return of."""
    rows, columns = np.divmod(some, len(scan.azimuths))
    true = true_ranges(scene, place[:3, 3].copy(), directions(scan, rows, columns) @ place[:3, :3].T)
    met = np.isfinite(true) & (true > 1.5)
    return rows[met], columns[met], true[met]


def test_round_things_are_measured_as_round(world, true_ranges):
    scene = world(
        '<geom type="cylinder" size=".4 2" pos="3 0 0"/><geom type="capsule" size=".3 .4" pos="0 3 0" euler="30 20 0"/>'
        '<geom type="ellipsoid" size=".3 .5 .8" pos="-3 0 0"/><geom size=".6" pos="0 -2.2 0"/>'
    )
    scan = scan_once(scene)
    rows, columns, true = beams_that_meet(scene, true_ranges, scan, np.eye(4), np.arange(scan.ranges.size))
    assert len(rows) > 10_000
    assert np.abs(scan.ranges[rows, columns] - true).max() < 1e-4  # NaN would not be below


def test_beams_at_the_edges_of_thin_and_faceted_things_agree_with_rays_too(world, true_ranges):
    # 60 slats of 2 mm, and a gem whose facets are a few beams wide: at draft every second beam meets an edge.
    slats = "".join(f'<geom type="box" size=".001 .02 2" pos="2 {-1.5 + k / 20} 0" euler="0 0 20"/>' for k in range(60))
    rng = np.random.default_rng(0)
    points = rng.normal(size=(400, 3))
    corners = " ".join(f"{x:.4f}" for x in (points / np.linalg.norm(points, axis=1)[:, None] * 0.8).ravel())
    scene = world(
        f'{slats}<geom type="mesh" mesh="gem" pos="-2.6 0 0"/><geom type="box" size=".1 9 4" pos="5.1 0 0"/>',
        f'<mesh name="gem" vertex="{corners}"/>',
    )
    place = pose(0.05, 0.03, 0.02, yaw=0.2, tilt=0.04)
    scan = scan_once(scene, place)
    some = rng.choice(scan.ranges.size, 100_000, replace=False)
    rows, columns, true = beams_that_meet(scene, true_ranges, scan, place, some)
    assert len(rows) > 20_000
    assert np.abs(scan.ranges[rows, columns] - true).max() < 5e-6  # NaN would not be below


def test_a_cloth_is_seen(world):
    cloth = '<flexcomp name="f" type="grid" count="4 4 1" spacing=".5 .5 .5" radius=".01" mass="1" euler="0 90 0"/>'
    scan = scan_once(world(f'<body name="b" pos="3 0 0">{cloth}</body>'))
    assert scan.ranges[beam(scan, 0, 0)] == pytest.approx(3, abs=0.02)


def test_no_beam_floats_between_two_surfaces(world, true_ranges):
    # A post at 2 m before a wall at 5 m: every beam is on one of them, none between.
    scene = world('<geom type="box" size=".05 .05 4" pos="2 0 0"/><geom type="box" size=".1 9 4" pos="5.1 0 0"/>')
    scan = scan_once(scene, pose(yaw=0.1, tilt=0.05))
    x = scan.points() @ pose(yaw=0.1, tilt=0.05)[:3, :3].T[:, 0]
    assert ((np.abs(x - 5) < 0.005) | (np.abs(x - 2) < 0.06)).all()
    assert (np.abs(x - 2) < 0.06).sum() > 1000


def test_a_step_within_one_mesh_leaves_no_ghosts_either(world):
    # Two parallel faces of one mesh, 3 m and 3.2 m away: ids cannot tell them apart.
    mesh = """<mesh name="step" inertia="shell" face="0 1 2  0 2 3  4 5 6  4 6 7"
              vertex="3 -4 -4  3 0 -4  3 0 4  3 -4 4  3.2 0 -4  3.2 4 -4  3.2 4 4  3.2 0 4"/>"""
    scan = scan_once(world('<geom type="mesh" mesh="step"/>', mesh))
    x = scan.points()[:, 0]
    assert ((np.abs(x - 3) < 0.005) | (np.abs(x - 3.2) < 0.005)).all()


def test_points_are_where_the_world_is(world):
    # A wall at y = 3, seen from (1, 0, 0.5) with the scanner turned by 90 deg: it is straight ahead, at 3 m.
    scan = scan_once(world('<geom type="box" size="9 .1 9" pos="0 3.1 0"/>'), pose(1, 0, 0.5, yaw=np.pi / 2))
    points = scan.points()
    assert points.dtype == np.float32
    assert len(points) == scan.hits.sum() == np.isfinite(scan.ranges).sum()
    assert np.allclose(points[:, 0], 3, atol=1e-4)
    assert np.allclose(np.linalg.norm(points, axis=1), scan.ranges[scan.hits], atol=1e-4)


def test_azimuth_runs_anticlockwise_and_elevation_down(world):
    scan = scan_once(world('<geom size=".5" pos="0 3 0"/><geom size=".5" pos="3 0 3"/>'))
    assert scan.ranges[beam(scan, 90, 0)] == pytest.approx(2.5, abs=1e-3)
    assert scan.ranges[beam(scan, 0, 45)] == pytest.approx(3 * 2**0.5 - 0.5, abs=5e-3)
    assert np.isnan(scan.ranges[beam(scan, 270, 0)])
    assert scan.elevations[0] > scan.elevations[-1]


def test_nothing_nearer_than_1_5_metres_returns(world):
    scan = scan_once(world('<geom type="box" size=".1 9 9" pos="1.3 0 0"/>'))  # 1.2 m away, 1.5 m at 37 deg
    assert np.isnan(scan.ranges[beam(scan, 0, 0)])
    assert np.isnan(scan.reflectance[beam(scan, 0, 0)])
    assert scan.ranges[beam(scan, 45, 0)] == pytest.approx(1.2 * 2**0.5, abs=1e-3)
    assert np.nanmin(scan.ranges) >= 1.5


@pytest.mark.parametrize(("grey", "reach"), [(0.954, 600.0), (0.4845, 283.0)], ids=["90 %", "20 %"])
def test_the_reach_falls_with_the_root_of_the_reflectance(world, grey, reach):
    # sRGB 0.954 is 90 % and 0.4845 is 20 % of the light: 600 m and 600 m sqrt(0.2 / 0.9) = 283 m.
    for distance, returns in ((reach * 0.98, True), (reach * 1.02, False)):
        wall = f'<geom type="box" size="1 20 20" pos="{distance + 1} 0 0" rgba="{grey} {grey} {grey} 1"/>'
        scan = scan_once(world(wall))
        assert np.isfinite(scan.ranges[beam(scan, 0, 0)]) == returns


def test_the_sky_returns_nothing(world):
    scan = scan_once(world('<geom type="plane" size="0 0 1"/>'), pose(z=1.5))
    assert np.isnan(scan.ranges[scan.elevations > 0]).all()
    assert np.isfinite(scan.ranges[scan.elevations < np.radians(-2)]).all()


def test_glass_lets_the_laser_through(world):
    scene = world(
        '<geom type="box" size=".1 9 9" pos="4.1 0 0"/><geom type="box" size=".01 9 9" pos="2 0 0" rgba="1 1 1 .2"/>'
    )
    scan = scan_once(scene)
    assert scan.ranges[beam(scan, 0, 0)] == pytest.approx(4, abs=1e-4)


def test_the_robot_does_not_see_itself(world):
    scene = world(
        '<geom type="box" size=".1 9 9" pos="4.1 0 0"/>'
        '<body name="mast"><geom type="box" size=".1 1 1" pos="2 0 0"/></body>'
    )
    scan = scan_once(scene)
    assert scan.ranges[beam(scan, 0, 0)] == pytest.approx(1.9, abs=1e-3)
    scan = scan_once(scene, hidden_bodies={scene[0].body("mast").id})
    assert scan.ranges[beam(scan, 0, 0)] == pytest.approx(4, abs=1e-3)


def test_a_scan_takes_the_time_of_the_data_sheet(world):
    assert scan_once(world("")).duration == pytest.approx(900_000 / 122_000)


def test_range_noise_is_three_millimetres(world):
    scan = scan_once(
        world(f'<geom type="box" size=".1 2 2" pos="3.1 0 0" {WHITE}/>'),
        parameters=ScannerParameters(pattern="draft"),
    )
    points = scan.points().astype(float)
    beams = points / np.linalg.norm(points, axis=1, keepdims=True)
    along = (points[:, 0] - 3) / beams[:, 0]  # residual of the wall x = 3 along each beam
    assert len(along) > 10_000
    assert along.std() == pytest.approx(0.003, rel=0.03)
    assert abs(along.mean()) < 0.0001


def test_weak_returns_are_noisier(world):
    # Black paint returns 2 %: 3 mm x sqrt(0.1 / 0.02) = 6.7 mm.
    wall = '<geom type="box" size=".1 .4 .4" pos="3.1 0 0" rgba="0 0 0 1"/>'
    scan = scan_once(world(wall), parameters=ScannerParameters(pattern="draft"))
    exact = scan_once(world(wall))
    residual = (scan.ranges - exact.ranges)[scan.hits & exact.hits]
    assert residual.std() == pytest.approx(0.0067, rel=0.05)


def test_reflectance_is_that_of_a_white_target_times_the_cosine(world):
    scan = scan_once(world('<geom type="box" size=".1 9 9" pos="3.1 0 0" rgba=".7354 .7354 .7354 1"/>'))
    # sRGB 0.7354 is half of the light: -3 dB square on; at 60 deg half of that again.
    assert scan.reflectance[beam(scan, 0, 0)] == pytest.approx(-3.01, abs=0.05)
    assert scan.reflectance[beam(scan, 60, 0)] == pytest.approx(-6.02, abs=0.05)
    assert scan.reflectance[beam(scan, 0, 45)] == pytest.approx(-4.52, abs=0.06)
    assert scan.reflectance[beam(scan, 45, -35.264)] == pytest.approx(-3.01 + 10 * np.log10(1 / 3**0.5), abs=0.06)


def test_reflectance_of_a_texture_is_its_mean(world):
    scene = world(
        '<geom type="box" size=".1 9 9" pos="3.1 0 0" material="m"/>',
        '<texture name="t" type="2d" builtin="checker" rgb1="1 1 1" rgb2="0 0 0" width="128" height="128"/>'
        '<material name="m" texture="t"/>',
    )
    scan = scan_once(scene)
    assert scan.reflectance[beam(scan, 0, 0)] == pytest.approx(-3.01, abs=0.1)  # half black, half white


def test_the_same_seed_gives_the_same_scan_and_another_one_another(world):
    scene, noisy = world(ROOM), ScannerParameters(pattern="draft")
    first, again, other = (scan_once(scene, pose(z=1.2), noisy, seed) for seed in (7, 7, 8))
    assert np.array_equal(first.ranges, again.ranges, equal_nan=True)
    assert np.array_equal(first.reflectance, again.reflectance, equal_nan=True)
    assert not np.array_equal(first.ranges, other.ranges, equal_nan=True)


def test_readings_are_whole_quarters_of_a_millimetre_and_tenths_of_a_decibel(world):
    noisy = ScannerParameters(pattern="draft")
    scan = scan_once(world('<geom type="box" size=".1 9 9" pos="5 0 0"/>'), parameters=noisy)
    ranges, reflectance = scan.ranges[scan.hits].astype(float), scan.reflectance[scan.hits].astype(float)
    assert np.abs(ranges * 4000 - np.rint(ranges * 4000)).max() < 0.01
    assert np.abs(reflectance * 10 - np.rint(reflectance * 10)).max() < 0.01


def test_the_noise_does_not_depend_on_the_number_of_cores(world, monkeypatch):
    scene, noisy = world(ROOM), ScannerParameters(pattern="draft")
    scans = []
    for cores in (1, 4):
        monkeypatch.setattr("os.cpu_count", lambda cores=cores: cores)
        scans.append(scan_once(scene, pose(z=1.2), noisy))
    assert np.array_equal(scans[0].ranges, scans[1].ranges, equal_nan=True)


def test_a_distance_field_is_seen_as_its_mesh_is(world, true_ranges):
    mesh = '<mesh name="gem" vertex="0 0 0  1 0 0  0 1 0  0 0 1"/>'
    scans = [scan_once(world(f'<geom type="{kind}" mesh="gem" pos="2.5 -.3 -.3"/>', mesh)) for kind in ("mesh", "sdf")]
    assert scans[0].hits.sum() > 1000
    assert np.array_equal(scans[0].ranges, scans[1].ranges, equal_nan=True)
