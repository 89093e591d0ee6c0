"""Fit the weights of the detector's confidence: `python -m mission.bench.walls.calibration --help`.

A detector that is hardly ever wrong teaches nothing about being wrong, so the candidates that it rejected are judged
against the joints, too: those that share nothing with a door are the near-misses, those that are nearly a missed one
are doors. A logistic function of the evidence is fitted to all. Its weights are kept from being negative, since no
piece of evidence speaks against a door, and small.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from detector.candidates import Scene
from detector.confidence import measure
from detector.detect import judge_wall
from detector.doors import find_doors
from detector.looking import look_at_walls
from detector.metrics import overlap
from detector.parameters import DetectorParameters
from detector.result import Candidate, Evidence
from detector.room import Room, Wall
from mission.bench.walls.cache import cached_scan, default_folder
from mission.bench.walls.judging import is_on_face
from mission.bench.walls.rooms import BenchRoom, rooms
from mission.bench.walls.scanning import judged_doors
from mission.config import read_config
from mission.evaluation import doorway_on
from sim.door_truth import DoorTruth

IS_DOOR = 0.8
"""A candidate that shares this much of its union with a true doorway is that door."""
IS_NONE = 0.2
"""One that shares less with every true doorway is none; what lies between says nothing."""
ALIKE = 0.5
"""Of candidates that share more than this only the best supported counts."""
PENALTY = 0.005
"""On the squares of the weights, per detection."""


class Sample(NamedTuple):
    """One candidate."""

    seed: int
    wall: str
    evidence: Evidence
    is_door: bool
    accepted: bool


class Fit(NamedTuple):
    """A logistic function of the evidence."""

    bias: float
    weights: Evidence

    def __call__(self, evidence: NDArray[np.float64]) -> NDArray[np.float64]:
        """(N,) probabilities of evidence (N, pieces)."""
        return 1 / (1 + np.exp(-self.bias - evidence @ np.array(self.weights)))


def fit(evidence: NDArray[np.float64], is_door: NDArray[np.bool_]) -> Fit:
    """The most likely weights, each at least 0.

    Args:
        evidence: (N, pieces) in [0, 1].
        is_door: (N,)
    """
    from scipy.optimize import minimize

    inputs = np.column_stack([np.ones(len(evidence)), evidence])

    def loss(weights: NDArray[np.float64]) -> tuple[float, NDArray[np.float64]]:
        logits = inputs @ weights
        likelihood = np.logaddexp(0, np.where(is_door, -logits, logits)).mean()
        slope = inputs.T @ (1 / (1 + np.exp(-logits)) - is_door) / len(inputs)
        shrunk = np.append(0, weights[1:])
        return float(likelihood + PENALTY * (shrunk**2).mean()), slope + 2 * PENALTY * shrunk / len(weights)

    bounds = [(None, None), *[(0, None)] * evidence.shape[1]]
    bias, *weights = minimize(loss, np.zeros(inputs.shape[1]), jac=True, bounds=bounds).x.tolist()
    return Fit(bias, Evidence(*weights))


def samples(room: BenchRoom, truths: Mapping[frozenset[str], DoorTruth], given: Room, seed: int) -> Iterator[Sample]:
    """Candidates on the judged walls of a room, accepted and rejected, and what they are."""
    parameters = DetectorParameters()
    for judged in room.walls:
        doors = [truths[frozenset(door.bodies)] for door in judged.doors]
        for wall in (w for w in given.walls if is_on_face(w, judged)):
            rectangles = [r for door in doors if (r := doorway_on(wall, door)) is not None]
            candidates, scene = search(given, wall, parameters)
            for candidate in different(candidates):
                shared = max((overlap(candidate.rectangle, r).iou for r in rectangles), default=0.0)
                if shared < IS_NONE or shared > IS_DOOR:
                    evidence = measure(candidate, scene, wall.height)
                    yield Sample(seed, judged.name, evidence, shared > IS_DOOR, candidate.rejected_by is None)


def search(room: Room, wall: Wall, parameters: DetectorParameters) -> tuple[tuple[Candidate, ...], Scene]:
    """Candidates on a wall, the accepted ones first, and the images that they were judged on."""
    (look,) = look_at_walls(replace(room, walls=(wall,)), parameters)
    result = judge_wall(look, parameters)
    seen, heights = result.openings.visibility, (wall.height, look.floor)
    found, scene = find_doors(result.merged, seen, look.face, result.wall_area, heights, parameters)
    return found.candidates, scene


def different(candidates: Sequence[Candidate]) -> list[Candidate]:
    """Candidates of which no two are much alike, accepted ones and then the best supported first."""
    kept: list[Candidate] = []
    for candidate in sorted(candidates, key=lambda c: (c.rejected_by is not None, -sum(c.side_support))):
        if all(overlap(candidate.rectangle, other.rectangle).iou < ALIKE for other in kept):
            kept.append(candidate)
    return kept


def held_out(found: Sequence[Sample]) -> NDArray[np.float64]:
    """(N,) confidence of each sample by weights that were fitted to the other seeds'."""
    evidence, is_door = np.array([s.evidence for s in found]), np.array([s.is_door for s in found])
    seeds = np.array([s.seed for s in found])
    result = np.full(len(found), np.nan)
    for seed in np.unique(seeds):
        others = seeds != seed
        result[~others] = fit(evidence[others], is_door[others])(evidence[~others])
    return result


def main(arguments: Sequence[str] | None = None) -> None:
    """Print weights for `detector.confidence`, and how reliable they are on seeds that they were not fitted to."""
    parser = argparse.ArgumentParser(prog="python -m mission.bench.walls.calibration", description=__doc__)
    parser.add_argument("--seed", type=int, nargs="+", default=[1, 2, 3], help="at least two (default: 1 2 3)")
    parser.add_argument("--cache", type=Path, default=default_folder(), help="folder of scanned rooms")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="scanner.pattern=draft, say")
    options = parser.parse_args(arguments)
    config = read_config(None, options.set)
    found = [
        sample
        for seed in options.seed
        for room in rooms(seed)
        for sample in samples(
            room, judged_doors(room), cached_scan(room, config, seed=seed, folder=options.cache).room(), seed
        )
    ]
    is_door = np.array([sample.is_door for sample in found])
    best = fit(np.array([sample.evidence for sample in found]), is_door)
    print(f"{is_door.sum()} doors, {(~is_door).sum()} others")
    print(f"BIAS = {best.bias:.2f}")
    for name, weight in best.weights._asdict().items():
        print(f"    {name}={weight:.2f},")
    said = held_out(found)
    for low in np.arange(0, 1, 0.2):
        within = (said >= low) & (said < low + 0.2 + (low > 0.7))
        if within.any():
            print(f"said {said[within].mean():.2f}, true {is_door[within].mean():.2f} of {within.sum()}")


if __name__ == "__main__":
    main()
