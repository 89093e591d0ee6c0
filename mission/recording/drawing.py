"""What both recordings draw alike: display clouds, colours, outlines and labels; knows no log format."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Protocol

import cv2
import numpy as np
from numpy.typing import NDArray

from detector.room import VoxelLabel
from mission.angles import opening_text

if TYPE_CHECKING:
    from mission.evaluation import DoorEvaluation

GRID = 512.0
"""Recorded coordinates are multiples of 1/512 m: at most 1 mm off per axis (0.6 mm rms), a fifth of the scanner's
own noise, and it halves the size of a compressed cloud."""

UNCOLOURED = (150, 150, 150)
"""Colour of points that no photograph sees."""

PALETTE = (
    (239, 131, 57),
    (66, 146, 224),
    (86, 178, 92),
    (200, 92, 200),
    (230, 196, 60),
    (78, 196, 196),
    (222, 84, 96),
    (150, 120, 220),
)
"""Colours that tell doors apart."""

LABEL_COLOURS = {
    VoxelLabel.OCCUPIED: (70, 130, 230),
    VoxelLabel.OCCLUDED: (120, 120, 120),
    VoxelLabel.OPENING: (250, 200, 40),
}

CELL_COLOURS = np.array([(0, 0, 0, 0), (90, 200, 110, 70), (230, 60, 60, 160)], np.uint8)
"""Red, green, blue and opacity of unknown, free and occupied cells of the grid."""

WALL_COLOUR = (120, 160, 220)
TRUTH_COLOUR = (255, 255, 255)

DISPLAY_QUALITY, ARCHIVE_QUALITY = 90, 95
"""JPEG: of pictures to look at, and of photographs that are kept for the machine."""


class Outlined(Protocol):
    """A wall: `detector.Wall` and `mission.WallRectangle` alike."""

    @property
    def origin(self) -> NDArray[np.float64]:
        """(3,) bottom left corner in the world [m]."""

    @property
    def u(self) -> NDArray[np.float64]:
        """(3,) to the right."""

    @property
    def v(self) -> NDArray[np.float64]:
        """(3,) up."""

    @property
    def width(self) -> float:
        """Along u [m]."""

    @property
    def height(self) -> float:
        """Along v [m]."""


def on_grid(points: NDArray[np.floating]) -> NDArray[np.float32]:
    """Points rounded to the recording's grid of 1/512 m."""
    scaled = points.astype(np.float32) * np.float32(GRID)
    np.rint(scaled, out=scaled)
    scaled *= np.float32(1 / GRID)
    return scaled


def cell_keys(points: NDArray[np.float32], cell: float) -> NDArray[np.int64]:
    """(N,) number of the cell of a grid that each point lies in; half a cell aside from the origin, see `thin`."""
    cells = np.array(
        points.T, np.float32, order="C"
    )  # axis by axis: passes along the long side take a tenth of the time
    cells /= np.float32(cell)
    cells += np.float32(0.5)
    np.floor(cells, out=cells)
    x, y, z = cells.astype(np.int64)  # 21 bits each: 50 km of cells of 5 cm to either side
    return (x << 42) + (y << 21) + z


def thin(
    points: NDArray[np.float32], *, cell: float = 0.05, limit: int = 120_000, read: int = 1_000_000
) -> NDArray[np.int64]:
    """Choose points for display: one a cell of a grid.

    The grid is shifted by half a cell, for walls like to lie on round coordinates, where noise would spread a plane
    over two layers of cells.

    Args:
        points: (N, 3) in the world [m].
        cell: Side of a cell [m].
        limit: Most points to choose.
        read: Most points to look at: a dense scan is strided first.

    Returns:
        (M,) indices of the chosen points, ascending.
    """
    stride = max(1, -(-len(points) // read))
    while stride > 1 and any(stride % divisor == 0 for divisor in (2, 3, 5)):
        stride += 1  # with a divisor in common with the beams of a turn, whole columns of beams would be left out
    sample = points[::stride]
    if len(sample) == 0:
        return np.zeros(0, np.int64)
    keys = cell_keys(sample, cell)
    runs = np.flatnonzero(np.diff(keys, prepend=keys[0] - 1))  # neighbouring beams meet one cell: half as many to sort
    chosen = runs[np.unique(keys[runs], return_index=True)[1]]
    chosen = chosen[:: max(1, -(-len(chosen) // limit))]
    return np.sort(chosen) * stride


def display_colours(colours: NDArray[np.uint8], coloured: NDArray[np.bool_]) -> NDArray[np.uint8]:
    """(N, 3) colours with grey where no photograph saw the point."""
    return np.where(coloured[:, None], colours, np.array(UNCOLOURED, np.uint8))


def label_colours(labels: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """(N, 3) colours of voxel labels."""
    table = np.zeros((256, 3), np.uint8)
    for label, colour in LABEL_COLOURS.items():
        table[label] = colour
    return table[labels]


def score_colours(scores: NDArray[np.floating]) -> NDArray[np.uint8]:
    """(N, 3) sRGB from dark violet for the lowest to yellow for the highest score; not finite counts as lowest."""
    scores = np.asarray(scores, float)
    if len(scores) == 0:
        return np.zeros((0, 3), np.uint8)
    finite = scores[np.isfinite(scores)]
    low, high = (finite.min(), finite.max()) if len(finite) else (0.0, 1.0)
    share = np.nan_to_num((scores - low) / max(high - low, 1e-12), nan=0.0, posinf=0.0, neginf=0.0)
    bgr = cv2.applyColorMap((share * 255).astype(np.uint8).reshape(-1, 1), cv2.COLORMAP_VIRIDIS)
    return np.ascontiguousarray(bgr.reshape(-1, 3)[:, ::-1])  # OpenCV has blue first


def palette(index: int) -> tuple[int, int, int]:
    """Colour of a door, by its place in the list."""
    return PALETTE[index % len(PALETTE)]


def outline(wall: Outlined) -> NDArray[np.float64]:
    """(5, 3) closed outline of a wall in the world [m]."""
    right, up = wall.u * wall.width, wall.v * wall.height
    return wall.origin + np.array([np.zeros(3), right, right + up, up, np.zeros(3)])


def closed(corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """(N + 1, 3) closed line through corners."""
    return np.concatenate([corners, corners[:1]])


def quads(corners: Sequence[NDArray[np.float64]]) -> tuple[NDArray[np.float64], NDArray[np.uint32]]:
    """Vertices (4 N, 3) and triangles (2 N, 3) of N quadrilaterals."""
    first = 4 * np.arange(len(corners), dtype=np.uint32)[:, None, None]
    triangles = first + np.array([[0, 1, 2], [0, 2, 3]], np.uint32)
    return np.concatenate([*corners]), triangles.reshape(-1, 3)


def angle_label(evaluation: DoorEvaluation) -> str:
    """Estimate beside truth: "34.8 deg (joint 35.0)"; of a door that slides "45 % open (joint 44 %)"."""
    door = evaluation.door
    return f"{opening_text(door.opening_angle, door.opened_fraction)} {true_label(evaluation)}"


def true_label(evaluation: DoorEvaluation) -> str:
    """Unit and truth: "deg (joint 35.0)"."""
    joint = opening_text(evaluation.true_angle, evaluation.true_opened_fraction)
    truth = "no such door" if evaluation.true_name is None else f"joint {joint}"
    return f"{'open' if evaluation.door.kind == 'sliding' else 'deg'} ({truth})"


def jpeg(image: NDArray[np.uint8], *, quality: int = DISPLAY_QUALITY) -> bytes:
    """An sRGB image (H, W, 3) or a grey one (H, W) as JPEG."""
    bgr = image if image.ndim == 2 else cv2.cvtColor(image, cv2.COLOR_RGB2BGR)  # OpenCV has blue first
    ok, data = cv2.imencode(".jpg", bgr, [cv2.IMWRITE_JPEG_QUALITY, quality])
    assert ok
    return data.tobytes()


def shrink(image: NDArray[np.uint8], *, width: int) -> tuple[NDArray[np.uint8], float]:
    """An image at most `width` pixels wide, and the factor it was scaled by."""
    factor = min(1.0, width / image.shape[1])
    if factor == 1.0:
        return image, 1.0
    size = (width, max(1, round(image.shape[0] * factor)))
    # Means over areas take five times as long, and are needed only where bilinear would skip pixels.
    method = cv2.INTER_AREA if factor < 0.5 else cv2.INTER_LINEAR
    return np.asarray(cv2.resize(image, size, interpolation=method), np.uint8), factor
