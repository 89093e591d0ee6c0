"""Furniture that flats have and the benchmark's offices have not: beds, kitchens, wardrobes, screens."""

from __future__ import annotations

from dataclasses import dataclass

from mission.bench.walls.finishes import BLACK, STEEL, WHITE, Finish
from mission.bench.walls.kit import Body, Kit

_LINEN = Finish((0.90, 0.89, 0.85))


@dataclass(frozen=True)
class Bed:
    """A bed whose head is at the wall."""

    width: float
    frame: Finish
    cover: Finish
    depth: float = 2.05

    def build(self, kit: Kit, body: Body) -> None:
        half, foot = self.width / 2, -self.depth
        kit.box(body, (-half, -0.05, 0), (half, 0, 0.95), self.frame)
        kit.box(body, (-half, foot, 0.18), (half, -0.05, 0.30), self.frame)
        for x in (-half, half - 0.06):
            kit.box(body, (x, foot, 0), (x + 0.06, foot + 0.06, 0.18), self.frame)
        kit.box(body, (-half + 0.02, foot + 0.02, 0.30), (half - 0.02, -0.06, 0.48), _LINEN)
        kit.box(body, (-half, foot, 0.40), (half, -0.65, 0.52), self.cover)
        for k in range(max(1, round(self.width / 0.8))):
            x = -half + self.width * (k + 0.5) / max(1, round(self.width / 0.8))
            kit.ball(body, (x, -0.32, 0.53), (0.32, 0.2, 0.09), _LINEN)


@dataclass(frozen=True)
class Wardrobe:
    """A wardrobe with plain doors and bar handles."""

    width: float
    height: float
    finish: Finish
    depth: float = 0.6

    def build(self, kit: Kit, body: Body) -> None:
        half, doors = self.width / 2, max(2, round(self.width / 0.5))
        kit.box(body, (-half, -self.depth + 0.02, 0.08), (half, 0, self.height), self.finish)
        kit.box(body, (-half + 0.02, -self.depth + 0.06, 0), (half - 0.02, -0.02, 0.08), BLACK)
        for k in range(doors):
            left = -half + self.width * k / doors
            right = left + self.width / doors
            kit.box(
                body, (left + 0.003, -self.depth, 0.09), (right - 0.003, -self.depth + 0.02, self.height), self.finish
            )
            x = right - 0.06 if k % 2 == 0 else left + 0.06
            kit.tube(body, (x, -self.depth - 0.02, 0.9), (x, -self.depth - 0.02, 1.15), 0.008, STEEL)


@dataclass(frozen=True)
class Kitchen:
    """A kitchen unit: base cupboards under a worktop with sink and hob, cupboards above."""

    width: float
    finish: Finish
    worktop: Finish
    depth: float = 0.6

    def build(self, kit: Kit, body: Body) -> None:
        half, count = self.width / 2, max(2, round(self.width / 0.6))
        kit.box(body, (-half, -0.54, 0), (half, 0, 0.1), BLACK)
        kit.box(body, (-half, -0.56, 0.1), (half, 0, 0.86), self.finish)
        kit.box(body, (-half, -0.6, 0.86), (half, 0, 0.9), self.worktop)
        kit.box(body, (-half, -0.35, 1.45), (half, 0, 2.1), self.finish)
        for k in range(count):
            left = -half + self.width * k / count + 0.004
            right = left + self.width / count - 0.008
            kit.box(body, (left, -0.58, 0.11), (right, -0.56, 0.84), self.finish)
            kit.box(body, (left, -0.37, 1.46), (right, -0.35, 2.09), self.finish)
            kit.tube(body, (left + 0.1, -0.6, 0.78), (right - 0.1, -0.6, 0.78), 0.006, STEEL)
        kit.box(body, (-0.75 * half, -0.48, 0.9), (-0.3 * half, -0.12, 0.905), STEEL)
        kit.tube(body, (-0.5 * half, -0.1, 0.9), (-0.5 * half, -0.1, 1.15), 0.014, STEEL)
        kit.tube(body, (-0.5 * half, -0.1, 1.15), (-0.5 * half, -0.28, 1.12), 0.012, STEEL)
        kit.box(body, (0.3 * half, -0.53, 0.9), (0.75 * half, -0.08, 0.906), BLACK)


@dataclass(frozen=True)
class Television:
    """A low board with a television on it."""

    width: float
    finish: Finish
    depth: float = 0.42

    def build(self, kit: Kit, body: Body) -> None:
        half = self.width / 2
        kit.box(body, (-half, -self.depth, 0.08), (half, 0, 0.45), self.finish)
        for x in (-half + 0.1, half - 0.1):
            kit.box(body, (x - 0.03, -self.depth + 0.05, 0), (x + 0.03, -0.05, 0.08), BLACK)
        kit.box(body, (-0.15, -0.3, 0.45), (0.15, -0.12, 0.47), BLACK)
        kit.box(body, (-0.03, -0.22, 0.47), (0.03, -0.18, 0.6), BLACK)
        kit.box(body, (-0.55, -0.22, 0.55), (0.55, -0.18, 1.17), BLACK)


@dataclass(frozen=True)
class Low:
    """A low table, a chest or a bench: a top on legs."""

    width: float
    depth: float
    height: float
    finish: Finish

    def build(self, kit: Kit, body: Body) -> None:
        half = self.width / 2
        kit.box(body, (-half, -self.depth, self.height - 0.04), (half, 0, self.height), self.finish)
        for x in (-half + 0.03, half - 0.08):
            for y in (-self.depth + 0.03, -0.08):
                kit.box(body, (x, y, 0), (x + 0.05, y + 0.05, self.height - 0.04), self.finish)


@dataclass(frozen=True)
class Hedge:
    """Something to look at outside: a hedge or a neighbour's wall, from a little below the floor."""

    width: float
    height: float
    depth: float
    finish: Finish

    def build(self, kit: Kit, body: Body) -> None:
        kit.box(body, (-self.width / 2, -self.depth, -0.2), (self.width / 2, 0, self.height), self.finish)


@dataclass(frozen=True)
class DiningTable:
    """A table on four legs with a bowl on it and nothing else."""

    width: float
    depth: float
    finish: Finish

    def build(self, kit: Kit, body: Body) -> None:
        half = self.width / 2
        kit.box(body, (-half, -self.depth, 0.71), (half, 0, 0.745), self.finish)
        for x in (-half + 0.04, half - 0.1):
            for y in (-self.depth + 0.04, -0.1):
                kit.box(body, (x, y, 0), (x + 0.06, y + 0.06, 0.71), self.finish)
        kit.ball(body, (0.2, -self.depth / 2, 0.79), (0.14, 0.14, 0.045), WHITE)
