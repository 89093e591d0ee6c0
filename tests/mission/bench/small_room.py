"""One small benchmark room, written by hand: 5 x 4 m, a closed door in the north, one at 30 degrees in the east."""

from __future__ import annotations

import math

from mission.bench.walls.rooms import BenchDoor, BenchRoom, BenchWall

ANGLE = math.radians(30)
XML = f"""
<mujoco>
  <asset>
    <material name="paint" rgba="0.75 0.72 0.62 1" specular="0" shininess="0"/>
    <material name="gloss" rgba="0.45 0.5 0.62 1" specular="0.9" shininess="0.6"/>
    <material name="wood" rgba="0.5 0.3 0.16 1" specular="0" shininess="0"/>
    <material name="floor" rgba="0.4 0.4 0.42 1" specular="0" shininess="0"/>
  </asset>
  <worldbody>
    <geom type="box" pos="3 3 -0.05" size="5 5 0.05" material="floor"/>
    <geom type="box" pos="2.5 2 2.65" size="2.6 2.1 0.05" material="paint"/>
    <geom type="box" pos="-0.05 2 1.3" size="0.05 2.1 1.3" material="paint"/>
    <geom type="box" pos="2.5 -0.05 1.3" size="2.6 0.05 1.3" material="paint"/>
    <geom type="box" pos="0.95 4.05 1.3" size="1.05 0.05 1.3" material="paint"/>
    <geom type="box" pos="4 4.05 1.3" size="1.1 0.05 1.3" material="paint"/>
    <geom type="box" pos="2.45 4.05 2.35" size="0.45 0.05 0.25" material="paint"/>
    <geom type="box" pos="5.05 3.3 1.3" size="0.05 0.8 1.3" material="gloss"/>
    <geom type="box" pos="5.05 0.75 1.3" size="0.05 0.85 1.3" material="gloss"/>
    <geom type="box" pos="5.05 2.05 2.3" size="0.05 0.45 0.3" material="gloss"/>
    <geom type="box" pos="2.5 6 1.3" size="5 0.05 1.3" material="paint"/>
    <geom type="box" pos="7 2 1.3" size="0.05 5 1.3" material="paint"/>
    <body name="north_leaf" pos="2.0 4.05 0">
      <joint name="north_hinge" axis="0 0 1" range="0 100"/>
      <geom type="box" pos="0.45 0 1.05" size="0.45 0.02 1.05" material="wood"/>
    </body>
    <body name="east_leaf" pos="5.05 2.5 0">
      <joint name="east_hinge" axis="0 0 1" range="0 100"/>
      <geom type="box" pos="0 -0.45 1" size="0.02 0.45 1" material="wood"/>
    </body>
  </worldbody>
  <keyframe><key qpos="0 {ANGLE}"/></keyframe>
</mujoco>
"""


def small_room() -> BenchRoom:
    """Scanned from two places."""
    north = BenchWall(
        name="simple 1.1",
        category="simple",
        origin=(0.0, 4.0, 0.0),
        end=(5.0, 4.0, 0.0),
        height=2.6,
        doors=(BenchDoor(("north_leaf",), (0.0,), 0.0, 0.0),),
    )
    east = BenchWall(
        name="specular 1.1",
        category="specular",
        origin=(5.0, 4.0, 0.0),
        end=(5.0, 0.0, 0.0),
        height=2.6,
        doors=(BenchDoor(("east_leaf",), (ANGLE,), 0.0, 0.0),),
    )
    return BenchRoom(
        name="small", xml=XML, assets={}, scan_places=((2.0, 1.8, 0.3), (3.2, 2.4, 1.2)), walls=(north, east)
    )
