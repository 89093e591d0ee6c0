"""Rigid transforms without BLAS: the same bits on one core and on two."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Pose = NDArray[np.float64]
"""(4, 4) rigid transform, right-handed, z up, [m]."""


def rotated(vectors: NDArray[np.floating], pose: Pose) -> NDArray[np.floating]:
    """(N, 3) vectors turned by the pose's rotation, in the vectors' own precision."""
    r = pose[:3, :3].astype(vectors.dtype)
    x, y, z = vectors[:, 0], vectors[:, 1], vectors[:, 2]
    return np.stack([x * r[i, 0] + y * r[i, 1] + z * r[i, 2] for i in range(3)], axis=1)


def transformed(points: NDArray[np.floating], pose: Pose) -> NDArray[np.floating]:
    """(N, 3) points moved by the pose, in the points' own precision [m]."""
    return rotated(points, pose) + pose[:3, 3].astype(points.dtype)


def inverted(pose: Pose) -> Pose:
    """The transform back: `a_from_b` from `b_from_a`."""
    back = np.eye(4)
    back[:3, :3] = pose[:3, :3].T
    back[:3, 3] = -(pose[:3, :3].T @ pose[:3, 3])
    return back


def from_rotation_vector(rotation: NDArray[np.float64], translation: NDArray[np.float64]) -> Pose:
    """The pose of a rotation vector (3,) [rad] (Rodrigues) and a translation (3,) [m]."""
    angle = float(np.sqrt(np.sum(rotation**2)))
    pose = np.eye(4)
    if angle > 0:
        x, y, z = rotation / angle
        skew = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        pose[:3, :3] += np.sin(angle) * skew + (1 - np.cos(angle)) * (skew @ skew)
    pose[:3, 3] = translation
    return pose


def angle_between(a: Pose, b: Pose) -> float:
    """Angle of the rotation that leads from one pose to the other [rad]."""
    turn = a[:3, :3].T @ b[:3, :3]
    axis = np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]])
    return float(np.arctan2(np.sqrt(np.sum(axis**2)), np.trace(turn) - 1))
