"""Where things are in the Rerun recording: entity paths and class ids; quantity first, identity last."""

from __future__ import annotations

import rerun as rr

from mission.recording.drawing import LABEL_COLOURS

WORLD = "/world"
ROBOT = "/world/robot"
ROBOT_BODY = "/world/robot/body"
CAMERA = "/world/camera"
CLOUDS = "/world/scans"
CEILINGS = "/world/ceiling"
DRIVEN = "/world/path/driven"
PLANNED = "/world/path/planned"
LASERS = "/world/lasers"
PLANS = "/world/candidates"
CANDIDATES = "/world/candidates/all"
CHOSEN = "/world/candidates/chosen"
WALLS = "/world/walls"
MAP = "/world/map"
GRID = "/world/map/grid"
VOXELS = "/world/map/voxels"
CEILING_VOXELS = "/world/map/ceiling_voxels"
CLUTTER = "/world/map/clutter"
DOORS = "/world/doors"
TRUTH = "/world/truth/doors"
TRUE_PATH = "/world/truth/path"
SHOTS = "/world/shots"

GRAPH = "/building/graph"

ANGLES = "/plots/angle"
COVERAGE = "/plots/coverage"
SCATTER = "/figures/angle_against_joint"
ERRORS = "/figures/angle_error"
COVERED = "/figures/coverage"
STAGES = "/timing/detector_stages"
MISSION_STAGES = "/timing/mission_stages"
MEMORY = "/timing/memory"
ACTIVITY = "/activity"
DOOR_STATES = "/door"
TABLE = "/table/doors"
LOG = "/log"
STAGES_OF_WALLS = "/walls"
SUMMARY = "/report/summary"
CONFIGURATION = "/report/configuration"
KEY = "/report/key"

NOTHING = 0
VOXELS_FROM = 10
"""Class of a voxel: this plus its label."""
DATA, CENTROID, SEEN_THROUGH, BLOCKED = 20, 21, 22, 23
REGION_OF_INTEREST, BRIGHT, HIGHLIGHT = 30, 31, 32
COLOUR_EDGE, DEPTH_EDGE, BOTH_EDGES = 40, 41, 42
WALL_AREA = 50
CLUSTERS = 100
"""Clusters count up from here, in colours that the viewer chooses."""

LEGEND = (
    (NOTHING, "none", (0, 0, 0, 0)),  # without it every overlay is tinted
    *((VOXELS_FROM + label, label.name.lower(), (*colour, 255)) for label, colour in LABEL_COLOURS.items()),
    (DATA, "data", (235, 235, 235, 255)),
    (CENTROID, "opening voxel", (220, 60, 60, 255)),
    (SEEN_THROUGH, "a beam went through", (250, 200, 40, 255)),
    (BLOCKED, "something stands before it", (150, 90, 170, 255)),
    (REGION_OF_INTEREST, "region of interest", (60, 160, 250, 90)),
    (BRIGHT, "candidate region", (250, 190, 40, 255)),
    (HIGHLIGHT, "highlight", (230, 40, 160, 255)),
    (COLOUR_EDGE, "colour edge", (255, 170, 60, 255)),
    (DEPTH_EDGE, "depth edge", (70, 190, 255, 255)),
    (BOTH_EDGES, "both", (255, 255, 255, 255)),
    (WALL_AREA, "wall area", (90, 200, 110, 255)),
)
"""Class id, label and colour of all that is drawn by class."""


def legend(number: int) -> tuple[str, tuple[int, int, int]]:
    """Label and colour of a class."""
    label, (red, green, blue, _) = next((label, colour) for known, label, colour in LEGEND if known == number)
    return label, (red, green, blue)


def child(parent: str, *parts: object) -> str:
    """An entity below another; whatever a scene's author put into a name stays one part of the path."""
    return "/".join([parent, *(rr.escape_entity_path_part(str(part)) for part in parts)])


def wall_name(room: int, number: int) -> str:
    """A wall for people and paths: "1.2" is the second wall of room 1."""
    return f"{room}.{number}"


def stages(wall: str) -> str:
    """Where the images of a wall are: outside the world, for they have no place in its 3D view."""
    return child(STAGES_OF_WALLS, wall)
