# SPDX-License-Identifier: BSD-3-Clause
"""Orientations as 3 x 3 matrices: made from what MJCF says, and told as roll, pitch and yaw."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from .body import Vector

Matrix = NDArray[np.float64]


def of_quaternion(w: float, x: float, y: float, z: float) -> Matrix:
    """Return the matrix of a quaternion, which need not be of length 1.

    >>> of_quaternion(1, 0, 0, 1).round(3).tolist()
    [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]
    """
    w, x, y, z = np.array([w, x, y, z]) / math.sqrt(w * w + x * x + y * y + z * z)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def about(axis: Sequence[float], angle: float) -> Matrix:
    """Return the turn by `angle` in rad about `axis`, which is not zero."""
    x, y, z = np.array(axis) / np.linalg.norm(axis) * math.sin(angle / 2)
    return of_quaternion(math.cos(angle / 2), x, y, z)


def of_eulers(angles: Sequence[float], order: str) -> Matrix:
    """Return the turns about axes one after the other. A letter of `order` in capitals is a fixed axis.

    >>> of_eulers((0, 0, math.pi / 2), "xyz").round(3).tolist()
    [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]
    """
    turned = np.eye(3)
    for angle, letter in zip(angles, order, strict=True):
        one = about([letter.lower() == axis for axis in "xyz"], angle)
        turned = turned @ one if letter.islower() else one @ turned
    return turned


def with_z(direction: Sequence[float]) -> Matrix:
    """Return the shortest turn that takes the z axis to `direction`, which is not zero."""
    x, y, z = np.array(direction) / np.linalg.norm(direction)
    if math.hypot(x, y) < 1e-12:
        return np.eye(3) if z > 0 else about((1, 0, 0), math.pi)
    return about((-y, x, 0), math.acos(max(-1.0, min(1.0, float(z)))))


def with_x_and_y(x: Sequence[float], y: Sequence[float]) -> Matrix:
    """Return the frame whose x axis is `x` and whose y axis is `y`, made square to it."""
    first = np.array(x) / np.linalg.norm(x)
    second = np.array(y) - first * (first @ np.array(y))
    second /= np.linalg.norm(second)
    return np.stack([first, second, np.cross(first, second)], axis=1)


def rpy_of(turned: Matrix) -> Vector:
    """Return roll, pitch and yaw in rad: turns about the fixed x, y and z axes.

    >>> [round(angle, 3) for angle in rpy_of(of_eulers((0.1, 0.2, 0.3), "XYZ"))]
    [0.1, 0.2, 0.3]
    """
    pitch = math.asin(max(-1.0, min(1.0, -float(turned[2, 0]))))
    if math.hypot(turned[2, 1], turned[2, 2]) < 1e-9:  # straight up or down: roll and yaw are one turn
        return 0.0, pitch, math.atan2(-turned[0, 1], turned[1, 1])
    return math.atan2(turned[2, 1], turned[2, 2]), pitch, math.atan2(turned[1, 0], turned[0, 0])
