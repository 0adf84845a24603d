# SPDX-License-Identifier: BSD-3-Clause
"""Geometry and gait of a walker with six legs of three servos; lengths in m, angles in rad.

A leg's foot is given as seen from its hip: x forward, y outwards, z up. Three legs are on the ground while
the other three swing forward (a tripod gait).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

COXA, FEMUR, TIBIA = 0.03, 0.06, 0.10
# (x, side), where side 1 is left
HIPS = np.array([[0.12, 1], [0.12, -1], [0.0, 1], [0.0, -1], [-0.12, 1], [-0.12, -1]])
HALF_WIDTH = 0.05  # half of the body's width
TRIPOD = np.array(
    [0.0, 0.5, 0.5, 0.0, 0.0, 0.5]
)  # phase of each leg: front left, front right, middle left, ..
REACH, HEIGHT = 0.10, -0.08  # position of a foot at rest, outwards and down
STRIDE, LIFT = 0.07, 0.03


def angles(foot: Array) -> Array:
    """Return hip, knee and foot angles (…, 3) that bring a foot to (…, 3) points."""
    x, y, z = foot[..., 0], foot[..., 1], foot[..., 2]
    reach = np.hypot(x, y) - COXA
    length = np.hypot(reach, z)
    inner = np.arccos((FEMUR**2 + length**2 - TIBIA**2) / (2 * FEMUR * length))
    bend = np.pi - np.arccos((FEMUR**2 + TIBIA**2 - length**2) / (2 * FEMUR * TIBIA))
    return np.stack([np.arctan2(x, y), np.arctan2(z, reach) + inner, -bend], axis=-1)


def foot_of(joints: Array) -> Array:
    """Return where the feet (…, 3) are for hip, knee and foot angles (…, 3)."""
    hip, knee, foot = joints[..., 0], joints[..., 1], joints[..., 2]
    reach = COXA + FEMUR * np.cos(knee) + TIBIA * np.cos(knee + foot)
    z = FEMUR * np.sin(knee) + TIBIA * np.sin(knee + foot)
    return np.stack([reach * np.sin(hip), reach * np.cos(hip), z], axis=-1)


def feet_at(phase: float, stride: float = STRIDE, lift: float = LIFT) -> Array:
    """Return the feet (6, 3) at a phase of the cycle: first on the ground and moving back, then up and
    forward.
    """
    at = (phase + TRIPOD) % 1.0
    swing = (at - 0.5) * 2
    x = np.where(at < 0.5, stride * (0.5 - 2 * at), -stride / 2 * np.cos(np.pi * np.clip(swing, 0, 1)))
    z = HEIGHT + lift * np.where(at < 0.5, 0.0, np.sin(np.pi * np.clip(swing, 0, 1)))
    return np.stack([x, np.full(6, REACH), z], axis=-1)


def on_body(feet: Array) -> Array:
    """Return feet (…, 6, 3) as seen from the middle of the body: x forward, y to the left."""
    x = HIPS[:, 0] + feet[..., 0]
    y = HIPS[:, 1] * (HALF_WIDTH + feet[..., 1])
    return np.stack([x, y, feet[..., 2]], axis=-1)


def grounded(feet: Array) -> NDArray[np.bool_]:
    """Return which of the feet (…, 6, 3) carry the body: those within 4 mm of the lowest."""
    z = feet[..., 2]
    carry: NDArray[np.bool_] = z <= z.min(axis=-1, keepdims=True) + 0.004
    return carry


def travelled(feet: Array) -> Array:
    """Return how far (n,) the body has moved forward. The feet that carry it stand still on the ground."""
    both = grounded(feet)[1:] & grounded(feet)[:-1]
    back = np.diff(feet[..., 0], axis=0)
    moved = -(back * both).sum(axis=1) / np.maximum(1, both.sum(axis=1))
    return np.concatenate([[0.0], np.cumsum(moved)])
