"""What scans say of places without points, and directions in which something stands too near for the scanner."""

from __future__ import annotations

import numpy as np
import pytest

import tests.mission.boxroom as boxroom
from mission.samples import PosedSample, ScanSample, place, sample_scan
from mission.visibility import Visibility, VisibilityParameters, _direction_cells, _near_directions
from sim.scan import ScannerParameters


def scan(*points: tuple[float, float, float]) -> PosedSample:
    """A scan from the origin with these points."""
    where = np.array(points, np.float32).reshape(-1, 3)
    sample = ScanSample(where, where * np.nan, np.zeros((2, 2), np.float32), np.array([0.1, 0.0]), np.array([0.0, 0.1]))
    return PosedSample(sample, np.eye(4), where, where * np.nan)


def at(azimuth_deg: float, distance: float) -> tuple[float, float, float]:
    """A point on the level of the scanner."""
    azimuth = np.radians(azimuth_deg)
    return (distance * np.cos(azimuth), distance * np.sin(azimuth), 0.0)


@pytest.mark.parametrize("azimuth_deg", [57.0, 179.9, -179.9, 0.0])
def test_a_near_thing_shadows_a_cell_on_either_side_of_it_also_across_the_seam(azimuth_deg: float) -> None:
    own, parameters = scan(), VisibilityParameters()
    shadows = _near_directions(own, [own, scan(at(azimuth_deg, 1.0))], 1.5, parameters)
    step = np.degrees(parameters.shadow)

    def shadowed(offset_deg: float) -> bool:
        return bool(shadows[_direction_cells(own, np.array([at(azimuth_deg + offset_deg, 4.0)]), parameters)][0])

    assert shadowed(-0.9 * step) and shadowed(0.0) and shadowed(0.9 * step)
    assert not shadowed(-2.1 * step) and not shadowed(2.1 * step)


@pytest.mark.parametrize(("min_range", "passed"), [(1.5, True), (2.5, False), (0.3, True)])
def test_a_beam_without_return_tells_nothing_of_places_nearer_than_the_scanner_measures(
    min_range: float, passed: bool
) -> None:
    # Open ground all round: at the scanner's height nothing comes back from anywhere. The place is 2 m away.
    world_from_scanner = boxroom.pose(0, 0)
    ground = [boxroom.box((-30, 30), (-30, 30), (-0.2, 0))]
    posed = place(sample_scan(boxroom.scan(ground, world_from_scanner)), world_from_scanner)
    spot, normal = world_from_scanner[:3, 3] + [[2.0, 0.0, 0.0]], np.array([[-1.0, 0.0, 0.0]])
    visibility = Visibility([posed], ScannerParameters(min_range=min_range))
    assert visibility.looked_through(spot, normal, behind=0.2).tolist() == [[passed]]
