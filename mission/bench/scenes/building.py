"""building.xml: five rooms on 27 x 21 m with 66 wall faces and five doors seen as nine, as in the paper's Figure 13."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from mission.bench.scenes import palette
from mission.bench.scenes.finishes import Named
from mission.bench.scenes.furniture import DiningTable, Hedge, Kitchen, Low, Television, Wardrobe
from mission.bench.scenes.plans import Doorway, House, Lowered, Pillar, Room, Side, Standing, Start
from mission.bench.walls.finishes import BLACK, BRASS, WHITE
from mission.bench.walls.fixtures import Clock, Extinguisher, Radiator, Sheet, Socket
from mission.bench.walls.furniture import Chair, CoatStand, Plant, Shelf, Sofa, Table
from mission.bench.walls.plans import DoorPlan, Frame, Hung, Stood, WindowPlan


def _picture(x: float, width: float, height: float, finish: Named, *, z: float = 1.55) -> Hung:
    return Hung(x, z, Sheet(width, height, finish, rim=BLACK))


def _window(left: float, width: float) -> tuple[WindowPlan, ...]:
    return (WindowPlan(left, width, 0.9, 1.35, WHITE, mullions=int(width > 1.1)),)


def _radiator(left: float, width: float) -> Hung:
    return Hung(left + width / 2, 0.45, Radiator(0.85 * width))


FOYER = Room(  # a T with a niche
    "foyer",
    corners=(
        (8.9, 11.0), (18.1, 11.0), (18.1, 5.6), (16.0, 5.6), (16.0, 3.6), (16.5, 3.6), (16.5, 2.0), (16.0, 2.0),
        (16.0, 0.3), (11.0, 0.3), (11.0, 5.6), (8.9, 5.6),
    ),
    height=3.0,
    paint=palette.PAINT_IVORY,
    floor=palette.STONE,
    lamps=((13.5, 8.2), (13.5, 3.0)),
    lowered=(Lowered("lowered ceiling over the entrance", (10.9, 0.2), (16.6, 1.7), 2.6, palette.PAINT_WHITE),),
    sides={
        1: Side(
            paint=palette.PAINT_SAND,
            stood=(Stood(1.6, 0.03, Shelf(1.2, 1.9, 0.36, palette.CHERRY, 11)),),
            hung=(_picture(4.0, 1.2, 0.8, palette.PICTURE_COLD), Hung(8.3, 2.1, Clock())),
        ),
        2: Side(stood=(Stood(4.6, 0.03, Plant(1.7, 0.33, 12)),), hung=(Hung(2.0, 1.1, Socket()),)),
        3: Side(windows=_window(0.5, 1.1), hung=(_radiator(0.5, 1.1),)),
        4: Side(hung=(_picture(1.0, 0.5, 0.7, palette.PICTURE_WARM),)),
        6: Side(paint=palette.BRICKWORK, stood=(Stood(0.8, 0.03, Low(1.1, 0.35, 0.45, palette.OAK)),)),
        9: Side(hung=(Hung(1.4, 0.95, Extinguisher()),), stood=(Stood(4.4, 0.05, CoatStand(palette.RED_FABRIC)),)),
        10: Side(windows=_window(1.6, 1.6), hung=(_radiator(1.6, 1.6),)),
        12: Side(hung=(Hung(3.6, 1.1, Socket()), _picture(4.5, 0.7, 0.5, palette.PICTURE_DARK))),
    },
    standing=(
        Standing((15.6, 8.3), 90.0, DiningTable(1.5, 0.8, palette.WALNUT)),
        Standing((15.1, 8.0), 90.0, Chair(palette.GREEN_FABRIC)),
        Standing((15.1, 8.6), 90.0, Chair(palette.GREEN_FABRIC)),
    ),
)  # fmt: skip

OFFICE = Room(  # an L with an oblique corner, a niche and a step
    "office",
    corners=(
        (0.3, 10.2), (2.1, 12.0), (8.7, 12.0), (8.7, 4.2), (8.0, 4.2), (8.0, 3.2), (6.6, 3.2), (6.6, 2.7),
        (5.0, 2.7), (5.0, 3.2), (3.6, 3.2), (3.6, 6.4), (0.3, 6.4),
    ),
    height=2.7,
    paint=palette.PAINT_ROUGHCAST,
    floor=palette.CARPET,
    lamps=((5.5, 8.5),),
    sides={
        1: Side(windows=_window(0.7, 1.2), hung=(_radiator(0.7, 1.2),)),
        2: Side(
            paint=palette.PAINT_SKY,
            stood=(
                Stood(1.4, 0.03, Shelf(1.6, 2.0, 0.38, palette.BEECH, 21)),
                Stood(4.6, 0.03, Table(1.6, 0.75, 0.74, palette.WHITE_FURNITURE, 22)),
            ),
            hung=(_picture(4.6, 1.0, 0.7, palette.PICTURE_WARM, z=1.7), Hung(6.2, 0.32, Socket(3))),
        ),
        3: Side(hung=(Hung(2.0, 1.5, Sheet(1.4, 0.9, palette.WHITE_FURNITURE, 0.02, rim=BLACK)),)),
        8: Side(windows=_window(0.25, 1.1), hung=(_radiator(0.25, 1.1),)),
        11: Side(
            stood=(Stood(1.6, 0.03, Table(1.4, 0.7, 0.74, palette.BEECH, 23)),),
            hung=(_picture(1.6, 0.6, 0.45, palette.PICTURE_COLD, z=1.7),),
        ),
        13: Side(windows=_window(1.2, 1.6), hung=(_radiator(1.2, 1.6),)),
    },
    standing=(
        Standing((6.7, 10.65), 180.0, Chair(palette.BLUE_FABRIC)),
        Standing((5.0, 4.8), 90.0, Chair(palette.BLUE_FABRIC)),
    ),
)  # fmt: skip

LOUNGE = Room(  # oblique wall, chimney breast, pillar
    "lounge",
    corners=(
        (18.25, 11.0), (24.0, 11.0), (24.0, 9.2), (26.7, 9.2), (26.7, 5.0), (23.7, 2.0), (22.2, 2.0), (22.2, 2.4),
        (20.8, 2.4), (20.8, 2.0), (18.25, 2.0),
    ),
    height=2.8,
    paint=palette.PAINT_PLASTER,
    floor=palette.BOARDS,
    lamps=((21.2, 7.5),),
    pillars=(Pillar((23.6, 6.6), (0.6, 0.5), 0.0, palette.PAINT_WHITE),),
    sides={
        1: Side(
            stood=(Stood(2.9, 0.03, Sofa(2.2, palette.RED_FABRIC)),),
            hung=(_picture(2.9, 1.3, 0.8, palette.PICTURE_DARK),),
        ),
        3: Side(
            stood=(Stood(1.5, 0.03, Shelf(1.4, 0.9, 0.36, palette.CHERRY, 31)),),
            hung=(_picture(1.5, 0.8, 0.6, palette.PICTURE_WARM),),
        ),
        4: Side(windows=_window(1.2, 1.8), hung=(_radiator(1.2, 1.8),)),
        5: Side(paint=palette.PAINT_MINT, windows=_window(1.2, 1.6), hung=(_radiator(1.2, 1.6),)),
        8: Side(paint=palette.BRICKWORK),
        10: Side(stood=(Stood(1.35, 0.03, Television(1.6, palette.ANTHRACITE)),)),
        11: Side(hung=(_picture(2.2, 0.9, 0.6, palette.PICTURE_COLD), Hung(6.75, 1.1, Socket()))),
    },
    standing=(
        Standing((21.2, 9.0), 0.0, Low(1.1, 0.6, 0.42, palette.OAK)),
        Standing((26.0, 8.6), -60.0, Plant(1.6, 0.32, 32)),
    ),
)  # fmt: skip

LIBRARY = Room(  # an L with an oblique corner, a chimney breast and a beam
    "library",
    corners=(
        (3.0, 17.5), (6.2, 20.7), (9.0, 20.7), (9.0, 20.25), (10.6, 20.25), (10.6, 20.7), (12.8, 20.7),
        (12.8, 11.24), (9.4, 11.24), (9.4, 12.2), (3.0, 12.2),
    ),
    height=3.2,
    paint=palette.PAINT_GREY,
    floor=palette.BOARDS,
    lamps=((6.0, 15.8), (10.7, 15.8)),
    lowered=(Lowered("beam", (7.9, 12.15), (8.2, 20.75), 2.85, palette.OAK),),
    sides={
        1: Side(windows=_window(1.4, 1.7), hung=(_radiator(1.4, 1.7),)),
        2: Side(stood=(Stood(1.55, 0.03, Shelf(1.5, 2.1, 0.36, palette.CHERRY, 41)),)),
        4: Side(paint=palette.BRICKWORK),
        6: Side(windows=_window(0.5, 1.2), hung=(_radiator(0.5, 1.2),)),
        7: Side(
            paint=palette.PAINT_ROSE,
            stood=(Stood(2.2, 0.03, Shelf(1.6, 2.0, 0.36, palette.BEECH, 42)),),
            hung=(_picture(7.6, 1.1, 0.8, palette.PICTURE_COLD), Hung(4.6, 1.1, Socket())),
        ),
        8: Side(
            stood=(Stood(1.7, 0.03, Sofa(1.9, palette.SAND_FABRIC)),),
            hung=(_picture(1.7, 0.9, 0.6, palette.PICTURE_WARM),),
        ),
        10: Side(
            stood=(
                Stood(1.6, 0.03, Shelf(1.8, 1.9, 0.36, palette.BEECH, 43)),
                Stood(4.3, 0.03, Table(1.5, 0.75, 0.74, palette.WALNUT, 44)),
            ),
            hung=(_picture(4.3, 0.7, 0.5, palette.PICTURE_DARK, z=1.7),),
        ),
        11: Side(windows=_window(1.6, 1.8), hung=(_radiator(1.6, 1.8),)),
    },
    standing=(Standing((5.1, 13.5), 0.0, Chair(palette.SAND_FABRIC)),),
)  # fmt: skip

DINING = Room(  # an L with an oblique corner, a bay window and a pillar
    "dining",
    corners=(
        (13.0, 18.0), (16.2, 18.0), (16.2, 20.7), (21.0, 20.7), (23.0, 18.7), (23.0, 16.6), (23.6, 16.6),
        (23.6, 13.4), (23.0, 13.4), (23.0, 11.15), (13.0, 11.15),
    ),
    height=2.9,
    paint=palette.PAINT_WHITE,
    floor=palette.STONE,
    lamps=((17.0, 14.5), (18.6, 18.6)),
    pillars=(Pillar((19.8, 15.0), (0.5, 0.5), 0.0, palette.PAINT_GREY),),
    sides={
        1: Side(stood=(Stood(1.6, 0.03, Wardrobe(1.5, 2.0, palette.WHITE_FURNITURE)),)),
        2: Side(hung=(_picture(1.35, 0.8, 1.0, palette.PICTURE_WARM),)),
        3: Side(
            paint=palette.WALL_TILES,
            stood=(Stood(2.4, 0.01, Kitchen(3.0, palette.WHITE_FURNITURE, palette.ANTHRACITE)),),
        ),
        4: Side(windows=_window(0.7, 1.4), hung=(_radiator(0.7, 1.4),)),
        7: Side(windows=_window(0.6, 2.0), hung=(_radiator(0.6, 2.0),)),
        9: Side(
            hung=(_picture(1.1, 1.0, 0.7, palette.PICTURE_COLD),),
            stood=(Stood(1.1, 0.03, Shelf(1.4, 0.9, 0.36, palette.BEECH, 51)),),
        ),
        10: Side(
            paint=palette.PAINT_SKY,
            stood=(Stood(2.6, 0.03, Sofa(2.0, palette.BLUE_FABRIC)),),
            hung=(_picture(2.6, 1.2, 0.7, palette.PICTURE_DARK), Hung(8.15, 1.1, Socket())),
        ),
        11: Side(hung=(Hung(2.9, 2.1, Clock()), _picture(1.6, 0.6, 0.8, palette.PICTURE_WARM))),
    },
    standing=(
        Standing((16.2, 14.6), 90.0, DiningTable(1.8, 0.9, palette.OAK)),
        Standing((15.7, 14.2), 90.0, Chair(palette.RED_FABRIC)),
        Standing((15.7, 15.0), 90.0, Chair(palette.RED_FABRIC)),
        Standing((17.6, 14.2), -90.0, Chair(palette.RED_FABRIC)),
        Standing((17.6, 15.0), -90.0, Chair(palette.RED_FABRIC)),
    ),
)  # fmt: skip

_DOOR = DoorPlan(
    left=0.0,
    width=0.9,
    height=2.1,
    finish=palette.DOOR_WHITE,
    frame=Frame("architrave", 0.07, 0.012, palette.FRAME_WHITE),
    recess=0.0,
    opens="inward",
)
DOORS = (
    Doorway(
        "outer_door",
        "foyer",
        9,
        replace(_DOOR, left=2.1, width=1.0, finish=palette.OAK, hinge="right", openings=(np.radians(35.0),)),
    ),
    Doorway(
        "office_door",
        "foyer",
        12,
        replace(_DOOR, left=2.2, width=0.9, finish=palette.DOOR_BLUE, openings=(np.radians(3.0),)),
    ),
    Doorway(
        "lounge_door",
        "lounge",
        11,
        replace(
            _DOOR,
            left=5.5,
            width=0.95,
            finish=palette.WALNUT,
            frame=Frame("architrave", 0.08, 0.015, palette.FRAME_OAK),
            hinge="right",
            openings=(np.radians(54.0),),
        ),
    ),
    Doorway(
        "dining_door",
        "dining",
        10,
        replace(_DOOR, left=7.0, width=0.92, finish=palette.DOOR_GREEN, panel="mouldings", metal=BRASS),
    ),
    Doorway(
        "library_door",
        "library",
        7,
        replace(
            _DOOR,
            left=5.2,
            width=0.85,
            height=2.05,
            finish=palette.DOOR_CREAM,
            frame=Frame("architrave", 0.06, 0.012, palette.DOOR_CREAM),
            hinge="right",
        ),
    ),
)

BUILDING = House(
    "building",
    "Five inhabited rooms on 27 x 21 m with 66 wall faces and five doors, like the simulated scene of the paper "
    "(Figure 13). The outer door stands open 35 deg, those to office and lounge 3 and 54 deg, those to dining room and "
    "library are closed: nobody gets from room to room without help, so the sites say where the robot is set down. To "
    'turn or move all of it, change pos and euler of the body "building".',
    rooms=(FOYER, OFFICE, LOUNGE, LIBRARY, DINING),
    doors=DOORS,
    starts=(
        Start("start", (13.2, 7.2), 90.0),
        Start("start_2", (5.6, 8.2), 0.0),
        Start("start_3", (21.3, 6.2), 90.0),
        Start("start_4", (8.8, 16.0), 0.0),
        Start("start_5", (19.0, 13.1), 90.0),
    ),
    outer=0.3,
    outside=(
        Standing((13.5, -7.0), 180.0, Hedge(16.0, 1.6, 0.6, palette.HEDGE)),
        Standing((33.0, 8.0), 90.0, Hedge(14.0, 3.5, 0.3, palette.BRICKWORK)),
        Standing((-5.0, 9.0), -90.0, Hedge(12.0, 2.4, 0.6, palette.HEDGE)),
        Standing((14.0, 27.0), 180.0, Hedge(18.0, 2.0, 0.6, palette.HEDGE)),
    ),
)
