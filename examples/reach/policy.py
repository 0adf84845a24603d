# SPDX-License-Identifier: BSD-3-Clause
"""The policy: two torques, from what the arm measures and where the hand shall go.

Twelve numbers of it are learned.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

UPPER_M, FORE_M = 0.3, 0.25
OBSERVED = ["shoulder.position", "elbow.position", "shoulder.speed", "elbow.speed"]
COMMANDED = ["shoulder.torque", "elbow.torque"]
MOST_NM = 1.0
NUMBERS = 12
_NEAR_M = 0.1  # farther away the pull grows no more


def hand(seen: Array) -> Array:
    """Return where the hand is, (…, 2) in m, for observations (…, 4)."""
    first = seen[..., 0]
    both = first + seen[..., 1]
    return np.stack(
        [UPPER_M * np.cos(first) + FORE_M * np.cos(both), UPPER_M * np.sin(first) + FORE_M * np.sin(both)], -1
    )


def torques(numbers: Array, seen: Array, targets: Array) -> Array:
    """Return torques in N m, (…, 2). `numbers` (…, 12) are what was learned, `targets` (…, 2) are in m."""
    away = targets - hand(seen)
    distance = np.linalg.norm(away, axis=-1, keepdims=True)
    pull = away / np.maximum(distance, _NEAR_M)
    angles = np.stack([seen[..., 0], seen[..., 0] + seen[..., 1]], -1)
    along = pull[..., :1] * np.cos(angles) + pull[..., 1:] * np.sin(angles)  # seen from each link
    across = pull[..., 1:] * np.cos(angles) - pull[..., :1] * np.sin(angles)
    features = np.concatenate([along, across, 0.3 * seen[..., 2:]], -1)
    weights = numbers.reshape(*numbers.shape[:-1], 2, 6)
    return MOST_NM * np.tanh(np.einsum("...ij,...j->...i", weights, features))


def draw_targets(source: np.random.Generator, count: int) -> Array:
    """Return places that the hand can reach, (count, 2) in m."""
    radius = source.uniform(0.2, 0.5, count)
    angle = source.uniform(-1.6, 1.6, count)
    return np.stack([radius * np.cos(angle), radius * np.sin(angle)], -1)


def save(numbers: Array, path: Path) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    np.savetxt(path, numbers)


def load(path: Path) -> Array:
    return np.loadtxt(path)
