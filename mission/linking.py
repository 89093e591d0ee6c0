"""Links between rooms: the same door seen from both sides, and what the scans of both rooms saw in common."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from mission.door_faces import DoorFace
from mission.pose_graph import Link, turn_of
from mission.registration import Registrar, RegistrationParameters
from mission.rigid import Pose, inverted, rotated, transformed
from mission.samples import PosedSample
from sim.parameters import Parameters


class LinkParameters(Parameters):
    """When two faces are one door, and how well a door ties two rooms."""

    max_offset: float = Field(default=0.5, gt=0, le=3, description="between the faces' middles, along the wall [m]")
    max_turn: float = Field(default=math.radians(8), gt=0, le=0.5, description="between the faces' planes [rad]")
    max_thickness: float = Field(default=0.7, gt=0, le=3, description="of a wall between two rooms [m]")
    max_size_difference: float = Field(
        default=0.2, gt=0, le=0.5, description="of the faces' widths and heights: one may have its frame with it [m]"
    )
    frame: float = Field(default=0.03, gt=0, le=0.5, description="faces that differ by more: one has its frame [m]")
    thickness: float = Field(default=0.15, gt=0, le=1, description="of a wall that nothing tells the thickness of [m]")
    thickness_deviation: float = Field(default=0.05, gt=0, le=1, description="1 sigma of it [m]")
    leaf_thickness: float = Field(default=0.04, gt=0, le=0.2, description="of a leaf; inner doors: 39 to 42 mm [m]")
    leaf_deviation: float = Field(default=0.005, gt=0, le=0.1, description="1 sigma of it [m]")
    edge_deviation: float = Field(default=0.003, gt=0, le=0.1, description="1 sigma of a doorway's middle [m]")
    turn_deviation: float = Field(default=0.0005, gt=0, le=0.1, description="1 sigma of a wall's heading [rad]")
    scan_deviation: float = Field(default=0.002, gt=0, le=0.1, description="1 sigma of registered scans [m]")
    scan_turn_deviation: float = Field(default=0.0003, gt=0, le=0.1, description="likewise of their heading [rad]")


def same_doors(
    faces: Iterable[DoorFace],
    others: Iterable[DoorFace],
    world_from_room: dict[int, Pose],
    parameters: LinkParameters,
) -> list[tuple[DoorFace, DoorFace]]:
    """Pairs of faces, one of `faces` and one of `others`, that are the two sides of one door; nearest first.

    Two sides of a door face away from each other, a wall's thickness apart, and have one size. No face is in two
    pairs.
    """
    pairs = sorted(
        (
            (offset, one.door_id, other.door_id, one, other)
            for one in faces
            for other in others
            if (offset := _offset(one, other, world_from_room, parameters)) is not None
        ),
        key=lambda pair: pair[:3],
    )
    taken: set[str] = set()
    chosen = []
    for _, one_id, other_id, one, other in pairs:
        if one_id not in taken and other_id not in taken:
            taken |= {one_id, other_id}
            chosen.append((one, other))
    return chosen


def door_link(first: DoorFace, second: DoorFace, parameters: LinkParameters) -> Link:
    """How the second face's room lies to the first's: walls parallel, doorways opposite each other.

    A wall is as thick as both recesses of a closed leaf and the leaf itself; where the leaf stands open, other links
    must tell, and the usual thickness is only a hint. So it is where one face was found with its frame, which stands
    out of the leaf; its middle is then as unsure as the sizes differ.
    """
    recesses = first.recess + second.recess
    one, other = first.door.rectangle, second.door.rectangle
    narrower, lower = abs(one.width - other.width), abs(one.height - other.height)
    known = bool(np.isfinite(recesses)) and narrower < parameters.frame
    thickness = recesses + parameters.leaf_thickness if known else parameters.thickness
    out, along = -first.normal, first.wall.u
    return Link(
        first=first.room,
        second=second.room,
        in_first=first.head + thickness * out,
        in_second=second.head,
        turn=_heading(out) - _heading(second.normal),
        axes=np.stack([along, out, [0.0, 0.0, 1.0]]),
        deviations=np.array(
            [
                parameters.edge_deviation + max(narrower - parameters.frame, 0.0) / 2,
                parameters.leaf_deviation if known else parameters.thickness_deviation,
                2 * parameters.edge_deviation + max(lower - parameters.frame, 0.0),
            ]
        ),
        turn_deviation=parameters.turn_deviation,
        doors=(first.door_id, second.door_id),
    )


def scan_link(
    first: int, second: int, first_from_second: Pose, place: NDArray[np.float64], parameters: LinkParameters
) -> Link:
    """How the second room lies to the first, as registered scans tell.

    Args:
        first, second: Numbers of the rooms.
        first_from_second: (4, 4).
        place: (3,) where the scans were taken, in the second room's frame [m].
    """
    return Link(
        first=first,
        second=second,
        in_first=transformed(place[None], first_from_second)[0],
        in_second=place,
        turn=turn_of(first_from_second),
        axes=np.eye(3),
        deviations=np.full(3, parameters.scan_deviation),
        turn_deviation=parameters.scan_turn_deviation,
    )


def common_scan_link(
    first: tuple[int, Registrar],
    second: tuple[int, Sequence[PosedSample]],
    first_from_second: Pose,
    parameters: LinkParameters,
) -> Link | None:
    """How two rooms lie to each other by what the scans of both saw in common, through an opening.

    Of the second room's scans the one with most in common counts.

    Args:
        first: Number of a room, and the map of its scans.
        second: Number of the other, and its scans in its own frame.
        first_from_second: (4, 4) as the doors tell, within some centimetres.

    Returns:
        None if they have too little in common to hold all directions.
    """
    best: tuple[float, Link] | None = None
    guessed = [(scan.sample, first_from_second @ scan.world_from_scanner) for scan in second[1]]
    for scan, found in zip(second[1], first[1].compare(guessed, _IN_COMMON), strict=True):
        if found.accepted and (best is None or found.fitness > best[0]):
            moved = found.world_from_scanner @ inverted(scan.world_from_scanner)
            best = found.fitness, scan_link(first[0], second[0], moved, scan.scanner_in_world, parameters)
    return best[1] if best else None


_IN_COMMON = RegistrationParameters(
    points=30_000, reaches=(0.1, 0.05, 0.03), min_fitness=0.02, max_shift=0.1, max_turn=math.radians(1)
)
"""For scans that see little of the other room, from where doors have put them already."""


def _offset(
    one: DoorFace, other: DoorFace, world_from_room: dict[int, Pose], parameters: LinkParameters
) -> float | None:
    """Distance of two faces' middles along the wall [m]; None if they cannot be one door."""
    a, b = one.door.rectangle, other.door.rectangle
    if max(abs(a.width - b.width), abs(a.height - b.height)) > parameters.max_size_difference:
        return None
    world_from_one, world_from_other = world_from_room[one.room], world_from_room[other.room]
    normal, along = rotated(np.stack([one.normal, one.wall.u]), world_from_one)
    (normal_b,) = rotated(other.normal[None], world_from_other)
    (head,), (head_b,) = transformed(one.head[None], world_from_one), transformed(other.head[None], world_from_other)
    between = head_b - head
    behind, offset = -float(normal @ between), abs(float(along @ between))
    if -float(normal @ normal_b) < np.cos(parameters.max_turn) or offset > parameters.max_offset:
        return None
    reach = parameters.max_thickness
    return offset if -0.1 < behind < reach and abs(between[2]) < parameters.max_size_difference else None


def _heading(direction: NDArray[np.float64]) -> float:
    return float(np.arctan2(direction[1], direction[0]))
