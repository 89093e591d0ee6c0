"""What stands on floors: cupboards, shelves, tables, chairs, sofas, plants, boxes, screens, curtains."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mission.bench.walls import textures
from mission.bench.walls.finishes import BLACK, DOOR_PAINTS, STEEL, WOODS, Finish, jittered, pick, plain, seed
from mission.bench.walls.fixtures import Cupboard
from mission.bench.walls.kit import Body, Kit
from mission.bench.walls.plans import Thing
from mission.bench.walls.textures import Colour

_FABRICS: tuple[Colour, ...] = ((0.30, 0.36, 0.46), (0.55, 0.20, 0.20), (0.45, 0.42, 0.36), (0.25, 0.40, 0.30))
_LEAVES: tuple[Colour, ...] = ((0.18, 0.38, 0.16), (0.28, 0.46, 0.20), (0.20, 0.34, 0.22))


@dataclass(frozen=True)
class Shelf:
    """Open shelves with books and folders."""

    width: float
    height: float
    depth: float
    finish: Finish
    seed: int

    def build(self, kit: Kit, body: Body) -> None:
        rng = np.random.default_rng(self.seed)
        half, deep = self.width / 2, -self.depth
        for x in (-half, half - 0.02):
            kit.box(body, (x, deep, 0), (x + 0.02, 0, self.height), self.finish)
        kit.box(body, (-half, -0.01, 0), (half, 0, self.height), self.finish)
        levels = np.linspace(0.06, self.height - 0.02, max(3, round(self.height / 0.36) + 1))
        for low, high in zip(levels, levels[1:], strict=False):
            kit.box(body, (-half, deep, low - 0.02), (half, 0, low), self.finish)
            self._fill(kit, body, rng, float(low), float(high) - 0.05)
        kit.box(body, (-half, deep, self.height - 0.02), (half, 0, self.height), self.finish)

    def _fill(self, kit: Kit, body: Body, rng: np.random.Generator, low: float, high: float) -> None:
        x, end = -self.width / 2 + 0.03, self.width / 2 - 0.03
        while x < end - 0.1:
            run = float(rng.uniform(0.08, 0.3))
            top = float(rng.uniform(low + 0.6 * (high - low), high))
            if rng.random() < 0.75:
                colour = plain(jittered(rng, (0.45, 0.42, 0.4), 0.35))
                kit.box(body, (x, -self.depth + 0.04, low), (min(x + run, end), -0.02, top), colour)
            x += run + 0.01


@dataclass(frozen=True)
class Table:
    """A table or desk, with something on it."""

    width: float
    depth: float
    height: float
    finish: Finish
    seed: int

    def build(self, kit: Kit, body: Body) -> None:
        rng = np.random.default_rng(self.seed)
        half, deep = self.width / 2, -self.depth
        kit.box(body, (-half, deep, self.height - 0.03), (half, 0, self.height), self.finish)
        for x in (-half + 0.04, half - 0.04):
            for y in (deep + 0.04, -0.04):
                kit.box(body, (x - 0.02, y - 0.02, 0), (x + 0.02, y + 0.02, self.height - 0.03), STEEL)
        x = float(rng.uniform(-half + 0.25, half - 0.25))
        kit.box(
            body, (x - 0.24, deep * 0.35, self.height + 0.1), (x + 0.24, deep * 0.35 + 0.03, self.height + 0.42), BLACK
        )
        kit.box(body, (x - 0.1, deep * 0.5, self.height), (x + 0.1, deep * 0.25, self.height + 0.015), BLACK)
        kit.cylinder(body, (x, deep * 0.33, self.height), (x, deep * 0.33, self.height + 0.12), 0.02, BLACK)


@dataclass(frozen=True)
class Chair:
    """A chair with a back."""

    finish: Finish
    width: float = 0.45
    depth: float = 0.48

    def build(self, kit: Kit, body: Body) -> None:
        kit.box(body, (-0.22, -0.46, 0.42), (0.22, -0.02, 0.46), self.finish)
        kit.box(body, (-0.21, -0.04, 0.58), (0.21, -0.015, 0.88), self.finish)
        for x in (-0.2, 0.2):
            kit.tube(body, (x, -0.03, 0.02), (x, -0.03, 0.86), 0.012, STEEL)
            kit.tube(body, (x, -0.44, 0.02), (x, -0.44, 0.42), 0.012, STEEL)


@dataclass(frozen=True)
class Sofa:
    """A sofa."""

    width: float
    finish: Finish
    depth: float = 0.85

    def build(self, kit: Kit, body: Body) -> None:
        half = self.width / 2
        kit.box(body, (-half, -0.85, 0.06), (half, 0, 0.40), self.finish)
        kit.box(body, (-half, -0.24, 0.40), (half, 0, 0.82), self.finish)
        for x in (-half, half - 0.18):
            kit.box(body, (x, -0.85, 0.40), (x + 0.18, -0.24, 0.60), self.finish)


@dataclass(frozen=True)
class Plant:
    """A potted plant as high as a man."""

    height: float
    spread: float
    seed: int
    leaves: int = 24

    @property
    def width(self) -> float:
        return 2 * self.spread

    @property
    def depth(self) -> float:
        return 2 * self.spread

    def build(self, kit: Kit, body: Body) -> None:
        rng = np.random.default_rng(self.seed)
        middle = -self.spread
        kit.cylinder(body, (0, middle, 0), (0, middle, 0.36), 0.17, plain((0.66, 0.36, 0.25)))
        kit.tube(body, (0, middle, 0.36), (0, middle, self.height - 0.3), 0.02, plain((0.35, 0.25, 0.15)))
        green = [plain(pick(rng, _LEAVES)) for _ in range(3)]
        for k in range(self.leaves):
            radius = self.spread * float(np.sqrt(rng.random())) * 0.75
            turn = float(rng.uniform(0, 2 * np.pi))
            z = float(rng.uniform(0.55, self.height - 0.1))
            size = self.spread * float(rng.uniform(0.22, 0.4))
            x, y = radius * np.cos(turn), middle + radius * np.sin(turn)
            kit.ball(body, (x, y, z), (size, size, size * float(rng.uniform(0.3, 0.7))), green[k % 3])


@dataclass(frozen=True)
class Boxes:
    """A pile of cardboard boxes."""

    width: float
    height: float
    seed: int
    depth: float = 0.5

    def build(self, kit: Kit, body: Body) -> None:
        rng = np.random.default_rng(self.seed)
        z = 0.0
        while z < self.height - 0.15:
            high = min(float(rng.uniform(0.25, 0.42)), self.height - z)
            wide = self.width * float(rng.uniform(0.75, 1.0)) / 2
            shift = float(rng.uniform(-1, 1)) * (self.width / 2 - wide)
            finish = plain(jittered(rng, (0.66, 0.52, 0.36), 0.05))
            kit.box(body, (shift - wide, -self.depth, z), (shift + wide, -0.03, z + high), finish)
            kit.box(
                body,
                (shift - wide, -self.depth - 0.001, z + high * 0.45),
                (shift + wide, -self.depth, z + high * 0.55),
                plain((0.75, 0.66, 0.5)),
            )
            z += high


@dataclass(frozen=True)
class Pair:
    """Two equally wide things with a way between them."""

    left: Thing
    right: Thing
    gap: float
    """Between them [m]."""

    @property
    def width(self) -> float:
        return self.left.width + self.gap + self.right.width

    @property
    def depth(self) -> float:
        return max(self.left.depth, self.right.depth)

    def build(self, kit: Kit, body: Body) -> None:
        for thing, side in ((self.left, -1), (self.right, 1)):
            thing.build(kit, body.add_body(pos=[side * (self.width - thing.width) / 2, 0, 0]))


@dataclass(frozen=True)
class Screen:
    """A folding screen or a mobile board on feet."""

    width: float
    height: float
    finish: Finish
    depth: float = 0.3

    def build(self, kit: Kit, body: Body) -> None:
        half = self.width / 2
        kit.box(body, (-half, -0.165, 0.12), (half, -0.135, self.height), self.finish)
        for x in (-half + 0.03, half - 0.03):
            kit.box(body, (x - 0.02, -0.3, 0), (x + 0.02, 0, 0.04), STEEL)
            kit.box(body, (x - 0.015, -0.175, 0.04), (x + 0.015, -0.125, self.height), STEEL)


@dataclass(frozen=True)
class Curtain:
    """A curtain in folds, on a rail over a door."""

    width: float
    height: float
    rail: float
    """Length of the rail, which is centred over the curtain [m]."""
    finish: Finish
    depth: float = 0.14

    def build(self, kit: Kit, body: Body) -> None:
        folds = max(3, round(self.width / 0.085))
        edges = np.linspace(-self.width / 2, self.width / 2, folds + 1)
        for k, (left, right) in enumerate(zip(edges, edges[1:], strict=False)):
            y = -0.09 + 0.018 * (-1) ** k
            radius = float(right - left) * 0.62
            kit.cylinder(body, ((left + right) / 2, y, 0.03), ((left + right) / 2, y, self.height), radius, self.finish)
        kit.tube(
            body, (-self.rail / 2, -0.09, self.height + 0.03), (self.rail / 2, -0.09, self.height + 0.03), 0.014, STEEL
        )


@dataclass(frozen=True)
class Bin:
    """A waste-paper bin."""

    finish: Finish
    width: float = 0.3
    depth: float = 0.3

    def build(self, kit: Kit, body: Body) -> None:
        kit.cylinder(body, (0, -0.16, 0), (0, -0.16, 0.38), 0.14, self.finish)


@dataclass(frozen=True)
class CoatStand:
    """A stand with a coat on it."""

    finish: Finish
    width: float = 0.5
    depth: float = 0.5

    def build(self, kit: Kit, body: Body) -> None:
        kit.cylinder(body, (0, -0.25, 0), (0, -0.25, 0.03), 0.2, BLACK)
        kit.tube(body, (0, -0.25, 0.03), (0, -0.25, 1.75), 0.018, BLACK)
        for x, y in ((0.15, 0), (-0.15, 0), (0, 0.15), (0, -0.15)):
            kit.tube(body, (0, -0.25, 1.62), (x, -0.25 + y, 1.72), 0.01, BLACK)
        kit.ball(body, (0.12, -0.25, 1.15), (0.15, 0.11, 0.5), self.finish)


def wood_colour(rng: np.random.Generator) -> Finish:
    """Plain wood or paint, for furniture."""
    return plain(pick(rng, WOODS if rng.random() < 0.6 else DOOR_PAINTS, 0.05))


def fabric(rng: np.random.Generator) -> Finish:
    """Upholstery or curtain cloth."""
    return plain(pick(rng, _FABRICS, 0.06))


def screen_cloth(rng: np.random.Generator) -> Finish:
    """The cloth of a partition."""
    return Finish(pick(rng, _FABRICS, 0.08), textures.carpet, 0.06, (0.6, 0.6), seed(rng))


def random_low(rng: np.random.Generator) -> Thing:
    """Something lower than a window sill."""
    kind = rng.integers(4)
    if kind == 0:
        width = float(rng.uniform(1.1, 1.6))
        return Table(width, float(rng.uniform(0.6, 0.8)), float(rng.uniform(0.70, 0.76)), wood_colour(rng), seed(rng))
    if kind == 1:
        return Sofa(float(rng.uniform(1.3, 1.9)), fabric(rng))
    if kind == 2:
        return Shelf(float(rng.uniform(0.7, 1.2)), float(rng.uniform(0.75, 1.1)), 0.35, wood_colour(rng), seed(rng))
    return Bin(wood_colour(rng))


def random_tall(rng: np.random.Generator) -> Thing:
    """Something as high as a man that stands at a wall."""
    kind = rng.integers(3)
    width = float(rng.uniform(0.7, 1.1))
    height = float(rng.uniform(1.6, 1.95))
    if kind == 0:
        return Shelf(width, height, float(rng.uniform(0.28, 0.4)), wood_colour(rng), seed(rng))
    if kind == 1:
        return Cupboard(width, height, float(rng.uniform(0.35, 0.45)), wood_colour(rng), plinth=0.06)
    return Plant(height - 0.2, 0.32, seed(rng))
