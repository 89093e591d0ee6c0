"""Rooms that several tests look at, scanned once."""

from __future__ import annotations

import numpy as np
import pytest

from detector.detect import detect_doors
from detector.parameters import DetectorParameters
from detector.result import Orthoimage, WallResult
from detector.room import Wall
from tests.detector.synthetic import Box, DoorSpec, Layout, make_room

COARSE = DetectorParameters(pixel_size=0.01)
"""For scans of 0.3 deg: 16 mm between samples at 3 m."""
STEP_DEG = 0.3

DOORS = (
    DoorSpec(left=0.6, width=0.9, height=2.05, frame=0.07),
    DoorSpec(left=2.4, width=0.82, height=2.0, angle_deg=35, colour=(0.5, 0.54, 0.58)),
    DoorSpec(
        left=4.3, width=0.9, height=2.1, angle_deg=70, hinge="right", inward=False, recess=0.07, colour=(0.9, 0.9, 0.9)
    ),
)
FURNITURE = (
    Box((1.0, 0.95, 0.3), (0.45, 0.95, 0.25), (0.6, 0.4, 0.3)),  # a cabinet, 5 cm before the wall
    Box((2.4, 1.5, 0.01), (0.3, 0.5, 0.01), (0.2, 0.3, 0.6)),  # a poster
    Box((5.2, 1.0, 0.08), (0.45, 1.0, 0.08), (0.5, 0.4, 0.3)),  # a door-sized cupboard, 16 cm deep
)


@pytest.fixture(scope="session")
def three_doors() -> WallResult:
    """A closed framed door, one 35 deg into the room, one 70 deg out of it; the wall oblique in the world."""
    room = make_room(Layout(doors=DOORS), step_deg=STEP_DEG, yaw=0.5, shift=(10.0, -7.0, 0.3))
    return detect_doors(room, COARSE)[0]


@pytest.fixture(scope="session")
def no_doors() -> WallResult:
    """A wall with a window, a poster and two cupboards."""
    layout = Layout(extra=FURNITURE, holes=[(3.2, 0.9, 4.4, 2.1)])
    return detect_doors(make_room(layout, step_deg=STEP_DEG), COARSE)[0]


@pytest.fixture
def wall() -> Wall:
    """A bare wall of 2 x 1 m in the plane y = 0, seen from y < 0, all Occupied."""
    return Wall(
        origin=np.zeros(3),
        u=np.array([1.0, 0, 0]),
        v=np.array([0, 0, 1.0]),
        width=2.0,
        height=1.0,
        voxel_labels=np.ones((5, 10), np.uint8),
    )


def plain_image(shape: tuple[int, int] = (100, 200), grey: int = 128, pixel_size: float = 0.01) -> Orthoimage:
    """A flat wall of one grey."""
    return Orthoimage(
        np.full((*shape, 3), grey, np.uint8), np.ones(shape, bool), np.zeros(shape, np.float32), pixel_size
    )
