"""Registration: point-to-plane ICP of a scan against the map of the scans before it, from the odometry guess.

Written with numpy and a k-d tree rather than Open3D, whose parallel sums on two cores give other last bits every run.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from mission.rigid import Pose, angle_between, from_rotation_vector, rotated, transformed
from mission.samples import PosedSample, ScanSample, place, thinned
from sim.parameters import Parameters

if TYPE_CHECKING:
    from scipy.spatial import cKDTree

Points = NDArray[np.floating]


class RegistrationParameters(Parameters):
    """The ICP's schedule, and what a good registration is."""

    points: int = Field(
        default=6000, ge=500, le=1_000_000, description="points of the scan that look for a partner in the map"
    )
    max_range: float = Field(default=15.0, gt=2, le=900, description="of these points from the scanner [m]")
    reaches: tuple[Annotated[float, Field(gt=0, le=10)], ...] = Field(
        default=(1.0, 0.5, 0.25, 0.12, 0.06, 0.04),
        min_length=1,
        max_length=50,
        description="distance to a partner, round by round [m]",
    )
    iterations: int = Field(default=10, ge=1, le=1000, description="at most, a round")
    min_fitness: float = Field(
        default=0.35, ge=0, le=1, description="share of the points with a partner in the last round"
    )
    max_rmse: float = Field(default=0.010, gt=0, le=0.2, description="point-to-plane residual in the last round [m]")
    min_constraint: float = Field(
        default=0.01, ge=0, le=1, description="share of the partners that must hold the least held direction"
    )
    max_shift: float = Field(default=0.6, gt=0, le=10, description="of the guess by the registration [m]")
    max_turn: float = Field(
        default=math.radians(12), gt=0, le=math.pi, description="of the guess by the registration [rad]"
    )
    spacing: float = Field(default=0.03, ge=0.005, le=0.2, description="of the map's points [m]")


@dataclass(frozen=True, eq=False)
class Registration:
    """Where a scan was taken, and how well that is known."""

    world_from_scanner: Pose
    """The registered pose; the guess if the registration is rejected."""
    fitness: float
    """Share of the sampled points with a partner in the map; 1 for the first scan."""
    rmse: float
    """Point-to-plane residual of the partners [m]; 0 for the first scan."""
    accepted: bool
    reason: str
    """Why it was taken or rejected."""


class Registrar:
    """Registers scan after scan against the map that the accepted ones make up.

    Args:
        parameters: Schedule and limits.
    """

    def __init__(self, parameters: RegistrationParameters | None = None) -> None:
        self.parameters = parameters or RegistrationParameters()
        self._map = _Map(np.zeros((0, 3), np.float32), np.zeros((0, 3), np.float32))

    def register(self, sample: ScanSample, guess_world_from_scanner: Pose) -> Registration:
        """Find a scan's pose; an accepted scan joins the map, the first one as it is guessed."""
        if len(self._map.points) == 0:
            registration = Registration(guess_world_from_scanner, 1.0, 0.0, True, "the first scan starts the map")
        else:
            registration = register(sample, guess_world_from_scanner, self._map, self.parameters)
        if registration.accepted:
            self._map = self._map.joined(place(sample, registration.world_from_scanner), self.parameters.spacing)
        return registration

    def compare(
        self, scans: Iterable[tuple[ScanSample, Pose]], parameters: RegistrationParameters
    ) -> list[Registration]:
        """Find the poses of scans from guesses (world_from_scanner) by other limits, and leave the map as it is."""
        world = replace(self._map)  # its tree goes with it
        return [register(sample, guess, world, parameters) for sample, guess in scans]


@dataclass(frozen=True, eq=False)
class _Map:
    """Points on flat surfaces, in the world, and a tree to find them: what remains of the scans of earlier rooms."""

    points: NDArray[np.float32]
    """(N, 3) [m]."""
    normals: NDArray[np.float32]
    """(N, 3) unit normals towards the scanner that saw them."""

    @cached_property
    def tree(self) -> cKDTree:
        """Finds the points; of the map of a room's last scan nobody asks for it."""
        from scipy.spatial import cKDTree

        return cKDTree(self.points)

    def joined(self, scan: PosedSample, spacing: float) -> _Map:
        flat = np.isfinite(scan.normals_in_world[:, 0])
        points = np.concatenate([self.points, scan.points_in_world[flat]])
        normals = np.concatenate([self.normals, scan.normals_in_world[flat]])
        older = np.arange(len(points)) < len(self.points)  # they drift less
        kept = thinned(points.astype(float), spacing, first=older)
        return _Map(points[kept], normals[kept])


def register(sample: ScanSample, guess: Pose, world: _Map, parameters: RegistrationParameters) -> Registration:
    """Coarse-to-fine point-to-plane ICP; rejected with a reason where it does not hold."""
    chosen = _balanced(sample, parameters)
    points, normals = sample.points[chosen].astype(float), sample.normals[chosen].astype(float)
    if len(points) < parameters.points / 10:
        return Registration(guess, 0.0, np.inf, False, f"only {len(points)} points on flat surfaces")
    pose = guess
    for reach in parameters.reaches:
        for _ in range(parameters.iterations):
            partners = _partners(points, normals, pose, world, reach)
            if len(partners.residuals) < 100:
                return Registration(guess, 0.0, np.inf, False, f"fewer than 100 points meet the map within {reach} m")
            step = _step(partners, reach, final=reach == parameters.reaches[-1])
            pose = step @ pose
            if np.abs(step - np.eye(4)).max() < 1e-5:
                break
    partners = _partners(points, normals, pose, world, parameters.reaches[-1])
    return _judged(guess, pose, partners, len(points), parameters)


def _balanced(sample: ScanSample, parameters: RegistrationParameters) -> NDArray[np.intp]:
    """Points on flat surfaces, as many of each direction of normals as there are (normal-space sampling).

    The directions are the 6 faces of a cube, 3 x 3 cells each, so that a small wall weighs as much as the floor.
    """
    near = np.sum(sample.points**2, axis=1) < parameters.max_range**2
    usable = np.flatnonzero(near & np.isfinite(sample.normals[:, 0]))
    normals = sample.normals[usable]
    axis = np.argmax(np.abs(normals), axis=1)
    rows = np.arange(len(usable))
    main = normals[rows, axis]
    cells = [((normals[rows, (axis + k) % 3] / main + 1) * 1.4999).astype(int) for k in (1, 2)]
    bins = ((axis * 2 + (main > 0)) * 3 + cells[0]) * 3 + cells[1]
    counts = np.bincount(bins, minlength=54)
    quota = _quota(counts, parameters.points)
    chosen = [
        members[(np.arange(quota[b]) * len(members)) // quota[b]]
        for b in np.flatnonzero(quota)
        for members in [usable[bins == b]]
    ]
    return np.sort(np.concatenate(chosen)) if chosen else usable


def _quota(counts: NDArray[np.int_], total: int) -> NDArray[np.int_]:
    """How many to take of each bin so that `total` are spread as evenly as the counts allow."""
    low, high = 0, int(counts.max(initial=0))
    while low < high:
        level = (low + high + 1) // 2
        low, high = (level, high) if np.minimum(counts, level).sum() <= total else (low, level - 1)
    return np.minimum(counts, low)


@dataclass(frozen=True, eq=False)
class _Partners:
    """Points of the scan that met the map."""

    points: Points
    """(K, 3) the scan's points, in the world as the pose has it [m]."""
    normals: Points
    """(K, 3) normals of their partners in the map."""
    residuals: NDArray[np.floating]
    """(K,) distance from the partner's plane, along its normal [m]."""


def _partners(points: Points, normals: Points, pose: Pose, world: _Map, reach: float) -> _Partners:
    here, facing = transformed(points, pose), rotated(normals, pose)
    distance, index = world.tree.query(here, distance_upper_bound=reach, workers=-1)
    met = np.flatnonzero(np.isfinite(distance))
    partner = index[met]
    across = world.normals[partner].astype(float)
    alike = _dot(facing[met], across) > 0.85
    met, partner, across = met[alike], partner[alike], across[alike]
    at = here[met]
    return _Partners(at, across, _dot(at - world.points[partner], across))


def _dot(a: Points, b: Points) -> NDArray[np.floating]:
    """(N,) products of vectors (N, 3)."""
    product = a * b
    return product[:, 0] + product[:, 1] + product[:, 2]


def _step(partners: _Partners, reach: float, *, final: bool) -> Pose:
    """The small motion that lessens the residuals, with Tukey weights as wide as 3 robust sigmas, at most the reach.

    Before the final round they are at least a quarter of the reach: along a corridor most points fit from the start,
    and the few at its ends that hold the way along it are no outliers.
    """
    sigma = 1.4826 * float(np.median(np.abs(partners.residuals)))
    width = max(min(reach, 4.685 * sigma), 1e-3 if final else reach / 4)
    weights = np.maximum(1 - (partners.residuals / width) ** 2, 0) ** 2
    middle = partners.points.mean(axis=0)  # rotate about the points: well conditioned far from the origin
    jacobian = np.concatenate([np.cross(partners.points - middle, partners.normals), partners.normals], axis=1)
    information = np.einsum("ni,nj->ij", jacobian * weights[:, None], jacobian)  # no BLAS: same bits on any core count
    gradient = np.einsum("ni,n->i", jacobian, weights * partners.residuals)
    damping = 1e-6 * np.diag(np.diag(information)) + 1e-9 * np.eye(6)
    motion = -np.linalg.solve(information + damping, gradient)
    step = from_rotation_vector(motion[:3], motion[3:])
    step[:3, 3] += middle - step[:3, :3] @ middle
    return step


def _judged(guess: Pose, pose: Pose, partners: _Partners, asked: int, limits: RegistrationParameters) -> Registration:
    fitness = len(partners.residuals) / asked
    rmse = float(np.sqrt(np.mean(partners.residuals**2))) if len(partners.residuals) else np.inf
    spread = np.einsum("ni,nj->ij", partners.normals, partners.normals) / max(len(partners.normals), 1)
    held = float(np.linalg.eigvalsh(spread)[0])
    shift, turn = float(np.sqrt(np.sum((pose - guess)[:3, 3] ** 2))), angle_between(guess, pose)
    objections = [
        (fitness < limits.min_fitness, f"only {fitness:.0%} of the points meet the map"),
        (rmse > limits.max_rmse, f"residual of {rmse * 1e3:.1f} mm"),
        (held < limits.min_constraint, "the surfaces leave a direction free"),
        (shift > limits.max_shift, f"{shift:.2f} m away from the guess"),
        (turn > limits.max_turn, f"turned {np.rad2deg(turn):.1f} deg from the guess"),
    ]
    reasons = [text for failed, text in objections if failed]
    if reasons:
        return Registration(guess, fitness, rmse, False, "; ".join(reasons))
    return Registration(pose, fitness, rmse, True, f"{fitness:.0%} of the points within {rmse * 1e3:.1f} mm of the map")
