"""The visible part of the wall, from coherent seeds of colour and depth (section 6.1)."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from detector.parallel import each
from detector.parameters import DetectorParameters
from detector.result import Mask, Orthoimage, WallArea

RESTARTS = 2
ITERATIONS = 40
COLOUR_SLACK = 0.02
"""Least half width of a cluster's box in each colour, of 1."""
DEPTH_SLACK = 0.012
"""Least half width of a cluster's box in depth [m]: 4 sigma of the scanner."""
ONE_COLOUR = 0.03
"""Standard deviation below which all seeds are one cluster, of 1."""
BLOCK = 128
"""Rows of a matrix of distances that stay in the processor's cache."""
BORDER_PX = 8
"""Width of the left, right and top borders that the wall shows on."""


def find_wall_area(merged: Orthoimage, parameters: DetectorParameters) -> WallArea:
    """Pixels that belong to the wall, by the three steps of section 6.1. Without any colour, depth decides alone."""
    values = rgbd(merged, parameters)
    known = np.isfinite(merged.depth) & (merged.coloured | ~merged.coloured.any())
    seeds, means = coherent_seeds(values, known, parameters)
    if len(seeds) == 0:
        nothing = np.zeros(known.shape, np.int32)
        return WallArea(seeds, np.zeros(0, np.int32), nothing, nothing > 0)
    distances = pair_distances(means, means)
    assigned = adaptive_kmeans(means, distances, parameters)
    # The paper removes seeds whose |silhouette| is *higher* than delta, which would throw away the consistent ones that
    # the step is to keep; read as: keep s >= delta. One cluster has no silhouette.
    kept = assigned
    if assigned.max() > 1:
        kept = np.where(silhouettes(distances, assigned) >= parameters.delta, assigned, 0)
    clusters = segment(values, known, means, kept, parameters)
    return WallArea(seeds, kept, clusters, clusters == _wall_cluster(clusters) if clusters.any() else clusters > 0)


def rgbd(merged: Orthoimage, parameters: DetectorParameters) -> NDArray[np.float32]:
    """(H, W, 4) colour in 0..1 and depth over `depth_scale`: four components that count alike."""
    depth = np.nan_to_num(merged.depth) / np.float32(parameters.depth_scale)
    return np.asarray(cv2.merge([*cv2.split(merged.colour.astype(np.float32) / 255), depth]), np.float32)


def coherent_seeds(
    values: NDArray[np.float32], known: Mask, parameters: DetectorParameters
) -> tuple[NDArray[np.int32], NDArray[np.float32]]:
    """Regularly sampled patches whose four components hardly vary.

    Returns:
        (S, 2) row and column of the top left pixels, and (S, 4) mean values.
    """
    side = parameters.seed_size
    rows, columns = known.shape[0] // side, known.shape[1] // side
    cut = known[: rows * side, : columns * side].reshape(rows, side, columns, side)
    full: Mask = np.asarray(cut.all(axis=(1, 3)))
    stride = max(1, int(np.sqrt(full.sum() / parameters.max_seeds)))
    seeds = np.argwhere(full[::stride, ::stride]).astype(np.int32) * stride * side
    inner = np.arange(side)
    patches = values[(seeds[:, 0, None] + inner)[:, :, None], (seeds[:, 1, None] + inner)[:, None, :]]
    patches = patches.reshape(len(seeds), side * side, 4)
    coherent = (patches.std(axis=1) <= parameters.max_sigma).all(axis=1)
    return seeds[coherent], patches.mean(axis=1)[coherent]


def adaptive_kmeans(
    means: NDArray[np.float32], distances: NDArray[np.float32], parameters: DetectorParameters
) -> NDArray[np.int32]:
    """(S,) cluster of each seed, from 1; the number of clusters is the one with the best mean silhouette.

    Args:
        distances: (S, S) between the seeds' means.
    """
    one = np.ones(len(means), np.int32)
    if len(means) < 4 or (means.std(axis=0) < ONE_COLOUR).all():
        return one

    def clustered(k: int) -> tuple[NDArray[np.int32], float]:
        assigned = kmeans(means, k)
        return assigned, float(silhouettes(distances, assigned).mean()) if len(np.unique(assigned)) == k else -np.inf

    best, best_score = one, parameters.min_silhouette
    for assigned, score in each(clustered, range(2, min(parameters.max_clusters, len(means) - 1) + 1)):
        if score > best_score + 1e-6:
            best, best_score = assigned, score
    return best


def kmeans(samples: NDArray[np.float32], k: int) -> NDArray[np.int32]:
    """(S,) cluster of each sample, from 1: Lloyd's algorithm from the best of a few fixed k-means++ starts."""
    best, best_cost = np.ones(len(samples), np.int32), np.inf
    for start in range(RESTARTS):
        rng = np.random.default_rng(start)
        centres = samples[[rng.integers(len(samples))]]
        while len(centres) < k:
            nearest = pair_distances(samples, centres).min(axis=1).astype(np.float64) ** 2
            if nearest.sum() == 0:
                break
            centres = np.vstack([centres, samples[[rng.choice(len(samples), p=nearest / nearest.sum())]]])
        assigned = pair_distances(samples, centres).argmin(axis=1)
        for _ in range(ITERATIONS):
            counts = np.bincount(assigned, minlength=len(centres))
            sums = np.stack(
                [np.bincount(assigned, samples[:, i], len(centres)) for i in range(samples.shape[1])], axis=1
            )
            centres = np.where(counts[:, None] > 0, sums / np.maximum(counts, 1)[:, None], centres).astype(np.float32)
            before, assigned = assigned, pair_distances(samples, centres).argmin(axis=1)
            if np.array_equal(before, assigned):
                break
        cost = float((pair_distances(samples, centres).min(axis=1) ** 2).sum())
        if cost < best_cost - 1e-9:
            best, best_cost = assigned.astype(np.int32) + 1, cost
    return best


def silhouettes(distances: NDArray[np.float32], assigned: NDArray[np.int32]) -> NDArray[np.float64]:
    """(S,) silhouette (b - a) / max(a, b) of each sample; 0 for one that is alone in its cluster.

    Args:
        distances: (S, S) between the samples.
    """
    numbers = np.unique(assigned)
    members = (assigned[:, None] == numbers).astype(np.float32)
    counts = members.sum(axis=0)
    # no product of matrices: its last digits depend on the number of cores
    columns = (distances.compress(assigned == number, axis=0) for number in numbers)  # symmetric: rows are faster
    sums = np.stack([cv2.reduce(c, 0, cv2.REDUCE_SUM, dtype=cv2.CV_64F)[0] for c in columns], axis=1)
    own = members > 0
    a = sums[own] / np.maximum(counts[own.argmax(axis=1)] - 1, 1)
    b = np.where(own, np.inf, sums / counts).min(axis=1)
    alone = counts[own.argmax(axis=1)] == 1
    return np.where(alone, 0.0, (b - a) / np.maximum(np.maximum(a, b), 1e-12)).astype(np.float64)


def segment(
    values: NDArray[np.float32], known: Mask, means: NDArray, kept: NDArray[np.int32], parameters: DetectorParameters
) -> NDArray[np.int32]:
    """(H, W) cluster of each pixel by thresholds on all four components; exclusive: the nearer cluster if two match."""
    smooth = cv2.blur(values, (3, 3))
    slack = np.array([COLOUR_SLACK] * 3 + [DEPTH_SLACK / parameters.depth_scale], np.float32)
    result, contested = np.zeros(known.size, np.int32), np.zeros(known.size, bool)
    boxes = {}
    for number in range(1, kept.max(initial=0) + 1):
        members = means[kept == number]
        if len(members) == 0:
            continue
        low, centre, high = np.quantile(members, [0.01, 0.5, 0.99], axis=0).astype(np.float32)
        within = cv2.inRange(smooth, tuple((low - slack).tolist()), tuple((high + slack).tolist()))
        matches = known.ravel() & (within.ravel() > 0)
        contested |= matches & (result > 0)
        result[matches] = number
        boxes[number] = centre, matches
    pixels = np.flatnonzero(contested)
    nearest = np.full(len(pixels), np.inf, np.float32)
    colours = smooth.reshape(-1, 4).take(pixels, axis=0)
    for number, (centre, matches) in boxes.items():
        distance = np.where(matches.take(pixels), ((colours - centre) ** 2).sum(axis=1), np.inf)
        result[pixels[distance < nearest]] = number
        nearest = np.minimum(nearest, distance)
    return result.reshape(known.shape)


def _wall_cluster(clusters: NDArray[np.int32]) -> int:
    """The cluster with the most pixels on the left, right and top borders; of all pixels if the borders are empty."""
    borders = [clusters[:, :BORDER_PX], clusters[:, -BORDER_PX:], clusters[:BORDER_PX]]
    counts = np.bincount(np.concatenate([b.ravel() for b in borders]), minlength=clusters.max() + 1)
    counts[0] = 0
    if counts.sum() == 0:
        counts = np.bincount(clusters.ravel())
        counts[0] = 0
    return int(counts.argmax())


def pair_distances(a: NDArray, b: NDArray) -> NDArray[np.float32]:
    """(N, M) Euclidean distances, summed component by component so that the order of summation is fixed."""
    if len(b) < len(a):
        return pair_distances(b, a).T  # the long axis last: short rows are slow
    squares = np.zeros((len(a), len(b)), np.float32)
    for start in range(0, len(a), BLOCK):
        rows, part = a[start : start + BLOCK], squares[start : start + BLOCK]
        for i in range(a.shape[1]):
            difference = rows[:, i, None] - b[None, :, i]
            part += np.square(difference, out=difference)
    return np.sqrt(squares, out=squares)
