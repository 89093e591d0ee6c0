"""flat.xml: four rooms that MoPAD can visit without help, and a store behind a door that is too narrow for it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from mission.bench.scenes import palette
from mission.bench.scenes.furniture import Bed, DiningTable, Hedge, Kitchen, Low, Wardrobe
from mission.bench.scenes.plans import Doorway, House, Lowered, Room, Side, Standing, Start
from mission.bench.walls.finishes import BLACK, WHITE
from mission.bench.walls.fixtures import Clock, Radiator, Sheet, Socket
from mission.bench.walls.furniture import Boxes, Chair, CoatStand, Plant, Shelf, Sofa, Table
from mission.bench.walls.plans import DoorPlan, Frame, Hung, Stood, WindowPlan

ARCHITRAVE = Frame("architrave", 0.07, 0.012, palette.FRAME_WHITE)
_SILL, _PANES = 0.9, 1.3

HALL = Room(
    "hall",
    corners=((0.0, 4.8), (3.4, 4.8), (3.4, 0.0), (0.0, 0.0)),
    height=2.5,
    paint=palette.PAINT_IVORY,
    floor=palette.STONE,
    lamps=((1.7, 2.6),),
    sides={
        1: Side(hung=(Hung(2.85, 1.6, Sheet(0.45, 0.6, palette.PICTURE_COLD, rim=BLACK)), Hung(2.3, 1.1, Socket()))),
        2: Side(hung=(Hung(0.6, 1.55, Sheet(0.8, 0.55, palette.PICTURE_WARM, rim=WHITE)),)),
        3: Side(stood=(Stood(0.3, 0.03, CoatStand(palette.GREEN_FABRIC)),)),
        4: Side(
            stood=(Stood(0.72, 0.03, Low(0.9, 0.32, 0.78, palette.BEECH)),),
            hung=(Hung(0.72, 1.55, Sheet(0.5, 0.9, palette.WHITE_FURNITURE, rim=BLACK)),),
        ),
    },
)

LIVING = Room(
    "living",
    corners=((3.55, 4.8), (7.35, 4.8), (8.75, 3.2), (8.75, -0.2), (3.55, -0.2)),
    height=2.7,
    paint=palette.PAINT_PLASTER,
    floor=palette.BOARDS,
    lamps=((6.1, 2.3),),
    sides={
        1: Side(
            hung=(Hung(1.9, 1.55, Sheet(1.1, 0.75, palette.PICTURE_DARK, rim=BLACK)),),
            stood=(Stood(1.6, 0.02, Shelf(1.1, 0.85, 0.36, palette.CHERRY, 3)),),
        ),
        2: Side(windows=(WindowPlan(0.45, 1.2, _SILL, _PANES, WHITE),), hung=(Hung(1.05, 0.45, Radiator(1.0)),)),
        3: Side(
            paint=palette.PAINT_MINT,
            windows=(WindowPlan(0.7, 1.7, _SILL, _PANES, WHITE),),
            hung=(Hung(1.55, 0.45, Radiator(1.4)),),
        ),
        4: Side(
            stood=(
                Stood(2.5, 0.03, Sofa(2.0, palette.BLUE_FABRIC)),
                Stood(0.45, 0.06, Plant(1.6, 0.32, 4)),
                Stood(4.5, 0.02, Shelf(1.0, 1.9, 0.34, palette.CHERRY, 5)),
            ),
            hung=(Hung(2.5, 1.6, Sheet(1.2, 0.7, palette.PICTURE_WARM, rim=WHITE)), Hung(3.7, 2.05, Clock())),
        ),
    },
    standing=(
        Standing((7.65, 2.4), 90.0, DiningTable(1.4, 0.85, palette.BEECH)),
        Standing((7.15, 2.1), 90.0, Chair(palette.RED_FABRIC)),
        Standing((7.15, 2.75), 90.0, Chair(palette.RED_FABRIC)),
        Standing((8.1, 1.25), -165.0, Chair(palette.RED_FABRIC)),
    ),
)

BEDROOM = Room(
    "bedroom",
    corners=((0.0, 9.58), (4.8, 9.58), (4.8, 4.98), (0.0, 4.98)),
    height=2.6,
    paint=palette.PAINT_SKY,
    floor=palette.CARPET,
    lamps=((2.6, 6.6),),
    sides={
        1: Side(
            windows=(WindowPlan(1.3, 1.3, _SILL, _PANES, WHITE),),
            hung=(Hung(1.95, 0.45, Radiator(1.1)),),
        ),
        2: Side(
            paint=palette.PAINT_PLASTER,
            stood=(Stood(0.95, 0.03, Bed(1.5, palette.BEECH, palette.GREEN_FABRIC)),),
            hung=(Hung(0.95, 1.6, Sheet(1.0, 0.6, palette.PICTURE_COLD, rim=WHITE)), Hung(3.0, 0.3, Socket(2))),
        ),
        4: Side(stood=(Stood(3.35, 0.02, Wardrobe(1.8, 2.1, palette.WHITE_FURNITURE)),)),
    },
    lowered=(Lowered("lowered ceiling over the wardrobe", (-0.05, 4.93), (1.3, 9.63), 2.3, palette.PAINT_WHITE),),
)

KITCHEN = Room(
    "kitchen",
    corners=((-4.12, 4.4), (-0.12, 4.4), (-0.12, 0.4), (-4.12, 0.4)),
    height=2.5,
    paint=palette.PAINT_SAND,
    floor=palette.STONE,
    lamps=((-2.0, 2.4),),
    sides={
        1: Side(
            paint=palette.WALL_TILES,
            stood=(Stood(1.35, 0.01, Kitchen(2.4, palette.WHITE_FURNITURE, palette.ANTHRACITE)),),
        ),
        2: Side(hung=(Hung(0.6, 1.6, Sheet(0.4, 0.55, palette.PICTURE_WARM, rim=BLACK)), Hung(3.5, 1.1, Socket()))),
        3: Side(
            stood=(Stood(2.95, 0.03, Table(1.2, 0.7, 0.74, palette.BEECH, 6)),),
            hung=(Hung(0.7, 2.0, Clock()),),
        ),
        4: Side(windows=(WindowPlan(1.2, 1.4, _SILL, _PANES, WHITE),), hung=(Hung(1.9, 0.45, Radiator(1.2)),)),
    },
    standing=(Standing((-3.07, 1.62), 0.0, Chair(palette.BLUE_FABRIC)),),
)

STORE = Room(
    "store",
    corners=((1.0, -0.12), (3.0, -0.12), (3.0, -1.72), (1.0, -1.72)),
    height=2.5,
    paint=palette.PAINT_WHITE,
    floor=palette.STONE,
    sides={
        3: Side(
            stood=(
                Stood(0.55, 0.03, Boxes(0.8, 1.5, 7)),
                Stood(1.5, 0.03, Shelf(0.8, 1.8, 0.35, palette.WHITE_FURNITURE, 8)),
            )
        )
    },
)

_PLAIN = DoorPlan(
    left=0.0, width=0.9, height=2.05, finish=palette.DOOR_WHITE, frame=ARCHITRAVE, recess=0.0, opens="outward"
)
DOORS = (
    Doorway(
        "living_door",
        "living",
        5,
        replace(
            _PLAIN, left=1.95, width=0.95, finish=palette.OAK, hinge="left", opens="inward", openings=(np.radians(95),)
        ),
    ),
    Doorway(
        "bedroom_door",
        "bedroom",
        3,
        replace(
            _PLAIN,
            left=2.9,
            width=0.9,
            finish=palette.DOOR_BLUE,
            hinge="left",
            opens="inward",
            openings=(np.radians(100),),
        ),
    ),
    Doorway(
        "kitchen_door",
        "kitchen",
        2,
        replace(_PLAIN, left=1.85, width=0.835, hinge="right", opens="inward", openings=(np.radians(90),)),
    ),
    Doorway(
        "store_door",
        "store",
        1,
        replace(_PLAIN, left=0.6, width=0.6, height=1.98, hinge="left", opens="inward", openings=(np.radians(90),)),
    ),
)

FLAT = House(
    "flat",
    "A flat of four furnished rooms, all linked by doors that stand open: those of living room and bedroom are wide, "
    "the kitchen's lets MoPAD just through, the store's does not. To turn or move all of it, change pos and euler of "
    'the body "building".',
    rooms=(HALL, LIVING, BEDROOM, KITCHEN, STORE),
    doors=DOORS,
    starts=(Start("start", (1.7, 2.4), 90.0),),
    outer=0.24,
    outside=(
        Standing((14.5, 2.0), 90.0, Hedge(9.0, 2.2, 0.6, palette.HEDGE)),
        Standing((2.0, 16.0), 180.0, Hedge(8.0, 3.2, 0.3, palette.BRICKWORK)),
        Standing((-10.5, 2.0), -90.0, Hedge(7.0, 1.4, 0.6, palette.HEDGE)),
    ),
)
