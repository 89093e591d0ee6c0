"""What hangs on walls and doors: posters, signs, sockets, switches, extinguishers, radiators, boards, cupboards."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from mission.bench.walls import textures
from mission.bench.walls.finishes import BLACK, GREEN, RED, STEEL, WHITE, Finish, jittered, plain, seed, wood
from mission.bench.walls.kit import Body, Kit


@dataclass(frozen=True)
class Sheet:
    """Anything flat: a poster, a sign, a notice board."""

    width: float
    height: float
    finish: Finish
    depth: float = 0.002
    rim: Finish | None = None

    def build(self, kit: Kit, body: Body) -> None:
        half = self.width / 2, self.height / 2
        finish = self.finish
        kit.slab(body, (-half[0], -self.depth, -half[1]), (half[0], 0, half[1]), finish)
        if self.rim:
            for low, high in ((-half[0] - 0.02, -half[0]), (half[0], half[0] + 0.02)):
                kit.box(body, (low, -self.depth - 0.006, -half[1] - 0.02), (high, 0, half[1] + 0.02), self.rim)
            for low, high in ((-half[1] - 0.02, -half[1]), (half[1], half[1] + 0.02)):
                kit.box(body, (-half[0], -self.depth - 0.006, low), (half[0], 0, high), self.rim)


@dataclass(frozen=True)
class Socket:
    """A row of power sockets or light switches."""

    count: int = 1
    finish: Finish = WHITE
    depth: float = 0.012

    @property
    def width(self) -> float:
        return 0.085 * self.count

    def build(self, kit: Kit, body: Body) -> None:
        kit.box(body, (-self.width / 2, -self.depth, -0.042), (self.width / 2, 0, 0.042), self.finish)
        for k in range(self.count):
            x = -self.width / 2 + 0.085 * (k + 0.5)
            kit.cylinder(body, (x, -0.01, 0), (x, -0.0135, 0), 0.022, BLACK)


@dataclass(frozen=True)
class Extinguisher:
    """A fire extinguisher on its bracket."""

    width: float = 0.18
    depth: float = 0.19

    def build(self, kit: Kit, body: Body) -> None:
        kit.box(body, (-0.03, -0.02, -0.1), (0.03, 0, 0.2), STEEL)
        kit.cylinder(body, (0, -0.1, -0.25), (0, -0.1, 0.2), 0.08, RED)
        kit.ball(body, (0, -0.1, 0.2), (0.078, 0.078, 0.06), RED)
        kit.cylinder(body, (0, -0.1, 0.24), (0, -0.1, 0.30), 0.025, BLACK)
        kit.tube(body, (0.03, -0.1, 0.28), (0.1, -0.12, 0.05), 0.012, BLACK)


@dataclass(frozen=True)
class Radiator:
    """A ribbed panel radiator under a window."""

    width: float
    height: float = 0.6
    depth: float = 0.11

    def build(self, kit: Kit, body: Body) -> None:
        half = self.width / 2
        kit.box(body, (-half, -0.1, -self.height / 2), (half, -0.03, self.height / 2), WHITE)
        for x in np.arange(-half + 0.04, half - 0.02, 0.08):
            kit.box(body, (x - 0.02, -0.11, -self.height / 2 + 0.02), (x + 0.02, -0.1, self.height / 2 - 0.02), WHITE)
        for x in (-half + 0.1, half - 0.1):
            kit.box(body, (x - 0.02, -0.03, -0.1), (x + 0.02, 0, 0.1), WHITE)


@dataclass(frozen=True)
class Clock:
    """A round wall clock."""

    width: float = 0.32
    depth: float = 0.04

    def build(self, kit: Kit, body: Body) -> None:
        kit.cylinder(body, (0, 0, 0), (0, -0.035, 0), 0.16, BLACK)
        kit.cylinder(body, (0, -0.035, 0), (0, -0.04, 0), 0.145, WHITE)
        kit.box(body, (-0.006, -0.043, 0), (0.006, -0.04, 0.11), BLACK)
        kit.box(body, (0, -0.043, -0.006), (0.08, -0.04, 0.006), BLACK)


@dataclass(frozen=True)
class Cupboard:
    """A wall cupboard or, on the floor with a plinth, a fitted one; its doors look like doors."""

    width: float
    height: float
    depth: float
    finish: Finish
    plinth: float = 0.0
    """Height of the recess below its doors [m]; 0 for one that hangs."""

    def build(self, kit: Kit, body: Body) -> None:
        half, top = self.width / 2, self.height
        if self.plinth:
            kit.box(body, (-half + 0.01, -self.depth + 0.06, 0), (half - 0.01, 0, self.plinth), BLACK)
        kit.box(body, (-half, -self.depth + 0.02, self.plinth), (half, 0, top), self.finish)
        count = max(1, round(self.width / 0.55))
        for k in range(count):
            left, right = (-half + self.width * n / count for n in (k, k + 1))
            front = (left + 0.002, -self.depth, self.plinth + 0.003), (right - 0.002, -self.depth + 0.02, top - 0.003)
            kit.box(body, *front, self.finish)
            x = right - 0.04 if k % 2 == 0 else left + 0.04
            z = self.plinth + (top - self.plinth) * (0.5 if self.plinth else 0.12)
            kit.tube(body, (x, -self.depth - 0.025, z - 0.06), (x, -self.depth - 0.025, z + 0.06), 0.006, STEEL)


def random_poster(rng: np.random.Generator) -> Sheet:
    """A poster or a framed picture."""
    colour = (0.93, 0.92, 0.88) if rng.random() < 0.5 else jittered(rng, (0.5, 0.5, 0.5), 0.4)
    finish = Finish(colour, textures.poster, 0.02, seed=seed(rng))
    width = float(rng.uniform(0.3, 0.65))
    return on_sheet(Sheet(width, width * float(rng.uniform(1.25, 1.5)), finish, rim=_rim(rng)))


def random_notice(rng: np.random.Generator) -> Sheet:
    """A sheet of A4."""
    finish = Finish((0.94, 0.94, 0.92), textures.poster, 0.02, seed=seed(rng))
    return on_sheet(Sheet(0.21, 0.297, finish))


def random_sign(rng: np.random.Generator) -> Sheet:
    """A safety sign."""
    colour = (GREEN.colour, RED.colour, (0.1, 0.25, 0.55))[rng.integers(3)]
    finish = Finish(colour, textures.sign, 0.02, seed=seed(rng))
    width = float(rng.uniform(0.2, 0.32))
    return on_sheet(Sheet(width, width * 0.66, finish, depth=0.003))


def random_board(rng: np.random.Generator) -> Sheet:
    """A white or a pin board."""
    width, height = float(rng.uniform(0.9, 1.5)), float(rng.uniform(0.7, 1.0))
    if rng.random() < 0.5:
        return Sheet(width, height, plain((0.95, 0.95, 0.95), specular=0.2, roughness=0.25), 0.02, STEEL)
    cork = Finish((0.68, 0.50, 0.32), textures.carpet, 0.12, (0.5, 0.5), seed(rng))
    return Sheet(width, height, cork, 0.015, wood(rng, (0.5, 0.35, 0.2)))


def on_sheet(sheet: Sheet) -> Sheet:
    """The sheet with its picture spread over it once."""
    return replace(sheet, finish=replace(sheet.finish, period=(sheet.width, sheet.height)))


def _rim(rng: np.random.Generator) -> Finish | None:
    return (None, BLACK, WHITE)[rng.integers(3)]
