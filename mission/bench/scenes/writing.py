"""From a building on paper to the text of an MJCF file."""

from __future__ import annotations

import re
from textwrap import wrap
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from mission.bench.scenes.finishes import Named
from mission.bench.scenes.pen import Node, Pen, numbers
from mission.bench.scenes.plans import (
    Doorway,
    Edge,
    House,
    Room,
    behind,
    edges,
    skin,
    thickness_at,
    wall_plan,
)
from mission.bench.scenes.triangles import triangulated
from mission.bench.walls.doors import build_door
from mission.bench.walls.finishes import Finish
from mission.bench.walls.floor_plans import grown
from mission.bench.walls.shell import build_shell

_FACE_GAP = 0.001
"""By which walls end before an outward corner, where the next one's face begins [m]."""
_UNDER_WALLS = 0.05
"""How far floors and ceilings reach into walls [m]."""
_SLAB = 0.1
"""Thickness of floors and ceilings [m]."""
_BOX_SPAN = 2.0
"""A box is two units wide to MuJoCo's textures, whatever its size: they repeat so many times half as often."""
_CEILING = Named((0.93, 0.93, 0.92), name="ceiling", specular=0.01, roughness=0.9)
_CONCRETE = Named((0.55, 0.55, 0.54), name="concrete", specular=0.0, roughness=1.0)
"""Under the floors, as it shows at the foot of walls."""
_LAWN = Named((0.33, 0.42, 0.25), name="lawn", specular=0.0, roughness=1.0)
_LAMP = Named((0.97, 0.95, 0.88), name="lamp")

HEADER = """
  <compiler angle="degree"/>
  <option timestep="0.002" integrator="implicitfast"/>
  <visual>
    <headlight ambient="0.6 0.6 0.6" diffuse="0.3 0.3 0.3" specular="0.1 0.1 0.1"/>
    <global offwidth="1280" offheight="960"/>
    <map znear="0.005" zfar="4"/>
  </visual>
  <default>
    <geom type="box" material="matt" friction="0.9 0.01 0.001"/>
    <!-- geom axes: x along the wall, y up, z through it, so that textures lie on its faces -->
    <default class="upright">
      <geom xyaxes="1 0 0 0 0 1"/>
    </default>
    <!-- what is seen only: the floors' and ceilings' surfaces -->
    <default class="visual">
      <geom type="mesh" contype="0" conaffinity="0"/>
    </default>
    <!-- a door: joint zero is closed, `ref` is how far it stands open in this file -->
    <default class="leaf">
      <joint type="hinge" limited="true" damping="2" frictionloss="0.5" armature="0.02"/>
      <geom density="380"/>
      <default class="leaf_panel">
        <geom xyaxes="1 0 0 0 0 1"/>
      </default>
      <default class="hinge">
        <geom contype="0" conaffinity="0"/>
      </default>
    </default>
  </default>
"""


def written(house: House) -> str:
    """The text of the building's file."""
    root = ElementTree.fromstring(f"<mujoco>{HEADER}</mujoco>", _parser())
    root.set("model", house.name)
    root.insert(0, ElementTree.Comment("\n       ".join(["", *wrap(house.summary, 110)])[6:] + " "))
    pen, asset = Pen(), ElementTree.SubElement(root, "asset")
    world = ElementTree.SubElement(root, "worldbody")
    building = Node(ElementTree.SubElement(world, "body", name="building", pos="0 0 0", euler="0 0 0"))
    _add_ground(pen, building, house)
    for room in house.rooms:
        _add_room(pen, building, house, room)
        _add_levels(pen, asset, building, room)
    for place in house.outside:
        pen.place(place.thing, building, (*place.at, 0.0), turned=np.radians(place.turned), owner="outside")
    _add_starts_and_lights(building, house)
    _add_materials(pen, asset)
    ElementTree.indent(root)
    text = ElementTree.tostring(root, encoding="unicode").replace(" />", "/>") + "\n"
    return re.sub(r"\n( +<!--)", r"\n\n\1", text)


def _parser() -> ElementTree.XMLParser:
    return ElementTree.XMLParser(target=ElementTree.TreeBuilder(insert_comments=True))


def _add_ground(pen: Pen, building: Node, house: House) -> None:
    corners = np.concatenate([room.polygon for room in house.rooms])
    low, high = corners.min(axis=0) - house.outer, corners.max(axis=0) + house.outer
    building.comment(
        "What everything stands on, and the lawn around; the rooms' own floors lie half a millimetre higher"
    )
    pen.box(building, (*low, -0.2), (*high, -0.0005), _CONCRETE)
    pen.box(building, (*(low - 12), -0.4), (*(high + 12), -0.2), _LAWN)


def _add_room(pen: Pen, building: Node, house: House, room: Room) -> None:
    corners = room.polygon
    low, high = corners.min(axis=0), corners.max(axis=0)
    size = f"{high[0] - low[0]:.2f} x {high[1] - low[1]:.2f} m, {_area(corners):.1f} m2"
    building.comment(f"Room {room.name}: {room.faces} wall faces, {size}, {room.height:.2f} m high")
    for edge in edges(room):
        _add_wall(pen, building, house, edge)
    body = building.add_body(name=room.name)
    for number, pillar in enumerate(room.pillars, start=1):
        turn = np.radians(pillar.turned)
        column = body.add_body(
            name=f"{room.name}_pillar_{number}",
            pos=(*pillar.at, 0.0),
            quat=[np.cos(turn / 2), 0, 0, np.sin(turn / 2)],
        )
        half = np.array(pillar.size) / 2
        pen.box(column, (*-half, 0.0), (*half, room.height + _SLAB), pillar.finish)
    for lowered in room.lowered:
        body.comment(lowered.name)
        pen.box(body, (*lowered.lower, lowered.height), (*lowered.upper, room.height + _SLAB / 2), lowered.finish)
    for x, y in room.lamps:
        pen.cylinder(body, (x, y, room.height - 0.35), (x, y, room.height), 0.008, _CONCRETE)
        pen.ball(body, (x, y, room.height - 0.42), (0.18, 0.18, 0.08), _LAMP)
    for place in room.standing:
        pen.place(place.thing, body, (*place.at, 0.0), turned=np.radians(place.turned), owner=room.name)


def _add_wall(pen: Pen, building: Node, house: House, edge: Edge) -> None:
    plan, side = wall_plan(house, edge), house.room(edge.room).side(edge.number)
    neighbours = ", ".join(sorted({other.room for other, *_ in behind(house, edge)}))
    building.comment(f"{edge.room}, wall {edge.number}: {edge.length:.2f} m, {neighbours or 'outside'} beyond")
    turn = np.radians(edge.degrees)
    wall = building.add_body(
        name=f"{edge.room}_wall_{edge.number}",
        pos=(*edge.start, 0.0),
        quat=[np.cos(turn / 2), 0, 0, np.sin(turn / 2)],
    )
    size = (edge.length, house.room(edge.room).height)
    build_shell(pen, wall, plan, size, _beyond(house, edge))  # type: ignore[arg-type]  # a pen draws as a kit does
    for hung in side.hung:
        pen.place(hung.thing, wall, (hung.x, 0.0, hung.z), turned=0.0, owner=edge.room)
    for stood in side.stood:
        pen.place(stood.thing, wall, (stood.x, -stood.away, 0.0), turned=stood.turned, owner=edge.room)
    for door in house.doors:
        if (door.room, door.wall) == (edge.room, edge.number):
            _add_door(pen, wall, house, door)


def _add_door(pen: Pen, wall: Node, house: House, door: Doorway) -> None:
    plan, angle = door.plan, np.degrees(door.plan.openings[0])
    stands = f"stands open {angle:g} deg" if angle else "closed"
    wall.comment(f"door {door.name}: {plan.width:.3f} x {plan.height:.2f} m, opens {plan.opens}, {stands}")
    build_door(pen, wall, plan, thickness_at(house, door), door.name)  # type: ignore[arg-type]


def _beyond(house: House, edge: Edge) -> tuple[float, float]:
    """How far a wall goes on beyond its face at both ends: round outward bends of the room's outline up to the
    neighbour's back, and not quite to inward ones [m]."""
    around = edges(house.room(edge.room))
    before, after = around[edge.number - 2], around[edge.number % len(around)]
    own = skin(house, edge)
    reach = []
    for first, second, neighbour in ((before, edge, before), (edge, after, after)):
        sine = float(first.along[0] * second.along[1] - first.along[1] * second.along[0])
        cosine = float(first.along @ second.along)
        if sine > 0:  # the room is on the right: a left turn makes more than a half turn of it
            reach.append(-_FACE_GAP)
        else:
            reach.append(max(0.0, (skin(house, neighbour) - own * cosine) / -sine))
    return reach[0], reach[1]


def _add_levels(pen: Pen, asset: ElementTree.Element, building: Node, room: Room) -> None:
    corners = grown(room.polygon, _UNDER_WALLS)
    for name, bottom, top, finish in (
        (f"{room.name}_floor", -_SLAB, 0.0, room.floor),
        (f"{room.name}_ceiling", room.height, room.height + _SLAB, _CEILING),
    ):
        _add_prism(asset, name, corners, (bottom, top), finish)
        pen.mesh(building, name, finish)


def _add_prism(
    asset: ElementTree.Element, name: str, corners: NDArray[np.float64], levels: tuple[float, float], finish: Finish
) -> None:
    """A mesh of a level slab over a polygon, clockwise seen from above."""
    count = len(corners)
    inner = triangulated(corners)
    faces = [[c, b, a] for a, b, c in inner] + [[a + count, b + count, c + count] for a, b, c in inner]
    for k in range(count):
        n = (k + 1) % count
        faces += [[k, k + count, n], [n, k + count, n + count]]
    vertices = [[x, y, z] for z in levels for x, y in corners]
    mesh = ElementTree.SubElement(asset, "mesh", name=name)
    mesh.set("vertex", "  ".join(numbers(vertex) for vertex in vertices))
    if isinstance(finish, Named) and finish.texture:
        mesh.set("texcoord", "  ".join(numbers(np.array(v[:2]) / finish.texture.metres) for v in vertices))
    mesh.set("face", "  ".join(" ".join(map(str, face)) for face in faces))


def _add_starts_and_lights(building: Node, house: House) -> None:
    building.comment("Where the robot is set down")
    for start in house.starts:
        attributes = {"name": start.name, "pos": numbers((*start.at, 0.0)), "euler": numbers((0, 0, start.heading))}
        ElementTree.SubElement(building.element, "site", {**attributes, "size": "0.05", "group": "4"})
    building.comment("Lights, for viewers: the robot's camera has its own flash")
    for room in house.rooms:
        for x, y in room.lamps:
            light = {"pos": numbers((x, y, room.height - 0.6)), "dir": "0 0 -1", "diffuse": "0.45 0.45 0.43"}
            ElementTree.SubElement(building.element, "light", {**light, "cutoff": "90", "castshadow": "false"})


def _add_materials(pen: Pen, asset: ElementTree.Element) -> None:
    for texture in pen.textures.values():
        ElementTree.SubElement(asset, "texture", {"name": texture.name, "type": "2d", **dict(texture.attributes)})
    for name, finish in pen.materials.items():
        material = ElementTree.SubElement(asset, "material", name=name)
        if isinstance(finish, Named) and finish.texture:
            material.set("texture", finish.texture.name)
            if name not in pen.of_meshes:  # which have texture coordinates
                material.set("texuniform", "true")
                material.set("texrepeat", numbers([_BOX_SPAN / side for side in finish.texture.metres]))
        material.set("rgba", numbers([*finish.colour, finish.alpha], digits=2))
        material.set("specular", numbers([finish.specular]))
        material.set("roughness", numbers([finish.roughness]))


def _area(corners: NDArray[np.float64]) -> float:
    x, y = corners.T
    return float(np.sum(np.roll(x, -1) * y - x * np.roll(y, -1))) / 2
