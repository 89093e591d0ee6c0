"""What the detector returns: for each wall the doors, and every intermediate product of the paper's figures.

All images of a wall have the same size; row 0 is the top of the wall, column 0 its left end seen from inside the
room, and pixel (row, column) is centred on u = (column + 0.5) * pixel_size, v = height - (row + 0.5) * pixel_size.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from detector.room import Wall

Image = NDArray[np.uint8]
Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class Rectangle:
    """An upright rectangle on a wall, in wall coordinates [m]."""

    left: float
    bottom: float
    right: float
    top: float

    @property
    def width(self) -> float:
        """Extent along u [m]."""
        return self.right - self.left

    @property
    def height(self) -> float:
        """Extent along v [m]."""
        return self.top - self.bottom

    @property
    def area(self) -> float:
        """Area [m2]."""
        return self.width * self.height


@dataclass(frozen=True, eq=False)
class Orthoimage:
    """4D orthoimage J_CD: colour and depth of a wall (section 4)."""

    colour: Image
    """(H, W, 3) sRGB, zero where there is none."""
    coloured: Mask
    """(H, W) True where the colour is known."""
    depth: NDArray[np.float32]
    """(H, W) distance from the wall plane into the room [m]; NaN where there is no point."""
    pixel_size: float
    """Side of a pixel [m]."""


@dataclass(frozen=True, eq=False)
class Highlights:
    """Specular highlights of one view (section 4.1, figure 3)."""

    region_of_interest: Mask
    """(H, W) where highlights are looked for, round the foot of the perpendicular from the camera centre."""
    levels: Image
    """(H, W) intensity quantised to the grey levels."""
    candidates: NDArray[np.int32]
    """(H, W) number of the candidate region, 0 for none."""
    regions: Mask
    """(H, W) inside a detected highlight, as delimited by the spline."""
    contours: tuple[NDArray[np.float64], ...]
    """For each detected highlight the (8, 2) end points of its profiles, as (row, column)."""
    inpainted: Image
    """(H, W, 3) the view's colour with the highlights filled in (section 4.2, figure 4)."""


@dataclass(frozen=True, eq=False)
class Openings:
    """Openings of a wall (section 5, figure 7)."""

    trinary: Image
    """(H, W) 0 no data, 1 data, 2 centroid of an Opening voxel."""
    horizontal_lines: NDArray[np.int32]
    """Rows of the lateral histogram's lines."""
    vertical_lines: NDArray[np.int32]
    """Columns of the lateral histogram's lines."""
    clusters: NDArray[np.int32]
    """(rows, columns) of the wall's voxels: number of the centroid cluster, 0 for none."""
    rectangles: tuple[Rectangle, ...]
    """Best rectangle of each cluster."""
    is_door: tuple[bool, ...]
    """For each rectangle: its lower side is at the floor."""
    visibility: Image
    """(H, W) 0 never met by a beam, 1 data, 2 a beam went through, 3 something stands before it."""


@dataclass(frozen=True, eq=False)
class WallArea:
    """The visible part of the wall (section 6.1, figure 8)."""

    seeds: NDArray[np.int32]
    """(S, 2) row and column of the top left pixel of each coherent seed."""
    seed_clusters: NDArray[np.int32]
    """(S,) cluster of each seed, from 1; 0 for seeds that the silhouette test dropped."""
    clusters: NDArray[np.int32]
    """(H, W) cluster of each pixel, 0 for none."""
    mask: Mask
    """(H, W) True on the wall."""


@dataclass(frozen=True)
class Candidate:
    """A rectangle of door size that stands on the floor, judged by section 6.2's conditions."""

    rectangle: Rectangle
    dominant_colour_share: float
    """Share of the rectangle that has the dominant colour, condition 1."""
    dominant_depth_share: float
    """Share of the rectangle that has the dominant depth, condition 1."""
    side_support: tuple[float, float, float, float]
    """Share of the left, top, right and bottom side that lies on a discontinuity, condition 2."""
    wall_share: float
    """Share of the rectangle that is wall area, condition 3."""
    rejected_by: str | None
    """Name of the first condition that the rectangle fails; None for a door."""
    surroundings: float = 1.0
    """Least share of wall along the outside of the left, top and right sides, as far as it is seen (ours)."""


@dataclass(frozen=True, eq=False)
class DoorSearch:
    """From discontinuities to doors (section 6.2, figures 9 and 10)."""

    colour_edges: Mask
    """(H, W) J'_C: Di Zenzo gradient above Otsu's threshold."""
    depth_edges: Mask
    """(H, W) J'_D: Canny on the depth."""
    edges: Mask
    """(H, W) J'_CD: one or the other."""
    horizontal_lines: NDArray[np.int32]
    """Rows of the lines."""
    vertical_lines: NDArray[np.int32]
    """Columns of the lines."""
    candidates: tuple[Candidate, ...]
    """Rectangles that were judged, the accepted ones first."""


@dataclass(frozen=True, eq=False)
class Leaf:
    """One leaf of a door (section 6.3, figure 11)."""

    hinge: Literal["left", "right", "none"]
    """Side of the hinge, seen from inside the room."""
    opening_angle: float
    """Angle between the leaf and the closed door, >= 0 [rad]; NaN where no point of the leaf was seen."""
    opening_angle_std: float
    """Standard deviation of the angle from the spread of the points [rad]; NaN like the angle."""
    opens: Literal["inward", "outward"] | None
    """Into the room or out of it; None for a closed or sliding leaf."""
    points: NDArray[np.float32]
    """(N, 2) the slice that the line was fitted to: along u and depth [m]; empty for a closed leaf."""
    slid: float = 0.0
    """Way of a sliding leaf from its closed place, along u [m]; 0 for a hinged one."""


class Evidence(NamedTuple):
    """What speaks for a door: shares and steps in [0, 1], of which more is better."""

    outline: float
    """Mean support of the left, top and right side by discontinuities."""
    weakest_side: float
    """Least support of these sides."""
    one_surface: float
    """The lesser share of the dominant colour and depth, openings included."""
    apart: float
    """1 without wall area inside, 0 with a tenth or more; 1, too, for a surface that differs from the wall round it."""
    wall_round: float
    """Least share of wall along the outside of the three sides."""
    visible: float
    """Share that nothing hides."""
    contrast: float
    """Change of colour or depth that the three sides share; 1 is a clear one."""


@dataclass(frozen=True, eq=False)
class Door:
    """A detected door."""

    rectangle: Rectangle
    """The doorway in the wall: what the closed leaf or leaves fill."""
    kind: Literal["single", "double", "sliding"]
    state: Literal["closed", "semi-open", "open"]
    leaves: tuple[Leaf, ...]
    """From left to right."""
    confidence: float = float("nan")
    """Probability that there is a door, in [0, 1]."""
    evidence: Evidence | None = None
    """What the confidence was computed from."""

    @property
    def opening_angle(self) -> float:
        """That of the wider open leaf; 0 for a closed or sliding door; NaN if no leaf was seen [rad]."""
        angles = [leaf.opening_angle for leaf in self.leaves if not np.isnan(leaf.opening_angle)]
        return max(angles) if angles else float("nan")

    @property
    def opened_fraction(self) -> float:
        """Share of the doorway's width that a sliding door leaves open; NaN for hinged doors."""
        if self.kind != "sliding":
            return float("nan")
        return sum(abs(leaf.slid) for leaf in self.leaves) / self.rectangle.width


@dataclass(frozen=True, eq=False)
class WallResult:
    """Everything the detector found out about one wall."""

    wall: Wall
    views: tuple[Orthoimage, ...]
    """One orthoimage for each view that saw the wall (section 4)."""
    view_numbers: tuple[int, ...]
    """Index into `Room.views` of each of `views`."""
    highlights: tuple[Highlights, ...]
    """One for each of `views` (section 4.1)."""
    merged: Orthoimage
    """The unified J_CD (section 4.2)."""
    openings: Openings
    wall_area: WallArea
    search: DoorSearch
    doors: tuple[Door, ...]
    """From left to right."""
    stage_seconds: tuple[tuple[str, float], ...] = ()
    """Wall clock time of each stage [s]: for people, not part of the result."""
