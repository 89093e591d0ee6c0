"""Fitting the confidence, on evidence that was made up."""

from __future__ import annotations

import numpy as np

from detector.result import Candidate, Evidence, Rectangle
from mission.bench.walls.calibration import Sample, different, fit, held_out

PIECES = len(Evidence._fields)


def made_up(count: int = 4000) -> tuple[np.ndarray, np.ndarray]:
    """Evidence of which the first piece makes doors, the second speaks against them, and the others say nothing."""
    rng = np.random.default_rng(0)
    evidence = rng.uniform(0, 1, (count, PIECES))
    chance = 1 / (1 + np.exp(3 - 6 * evidence[:, 0] + 2 * (evidence[:, 1] - 0.5)))
    return evidence, rng.uniform(0, 1, count) < chance


def test_what_is_said_comes_true_as_often() -> None:
    evidence, is_door = made_up()
    said = fit(evidence, is_door)(evidence)
    for low in (0.1, 0.3, 0.5, 0.7):
        within = (said >= low) & (said < low + 0.2)
        # some 600 in each: the share of doors scatters by 0.02
        assert abs(said[within].mean() - is_door[within].mean()) < 0.06


def test_weights_follow_the_evidence_and_are_never_negative() -> None:
    weights = np.array(fit(*made_up()).weights)
    assert weights[0] > 3
    assert weights[1] == 0
    assert (weights[2:] >= 0).all() and (weights[2:] < 0.5).all()


def test_a_seed_is_judged_by_the_weights_of_the_others() -> None:
    # of the two seeds one has doors where the other has none: what is said of each is wrong
    evidence, is_door = made_up(400)
    found = [
        Sample(seed, "w", Evidence(*e), bool(d) == (seed == 0), True)
        for seed in (0, 1)
        for e, d in zip(evidence, is_door, strict=True)
    ]
    truth = np.array([sample.is_door for sample in found])
    assert held_out(found)[truth].mean() < held_out(found)[~truth].mean()


def test_of_candidates_that_are_much_alike_the_best_supported_counts() -> None:
    def candidate(left: float, support: float, rejected_by: str | None) -> Candidate:
        sides = (support, support, support, 1.0)
        return Candidate(Rectangle(left, 0.0, left + 0.9, 2.0), 1.0, 1.0, sides, 0.0, rejected_by)

    door, reading = candidate(1.0, 0.8, None), candidate(1.05, 0.9, "minimum size")
    faint, clear = candidate(3.0, 0.2, "location consistency"), candidate(3.1, 0.5, "location consistency")
    assert different([reading, faint, door, clear]) == [door, clear]
