# SPDX-License-Identifier: BSD-3-Clause
"""Geometry of the PA10 and a path for two of them. Its seven joints turn about z and y by turns.

Lengths are in m, angles in rad. x points to the work of the arms, z points up.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

SHOULDER, UPPER, FORE, HAND = 0.317, 0.45, 0.48, 0.13
BASES = np.array([[0.0, 0.45, 0.0], [0.0, -0.45, 0.0]])  # for the left and the right arm
REST = np.array([0.0, 0.5, 0.0, 1.4, 0.0, 0.8, 0.0])
RADIUS, CENTRE_Z = 0.14, 0.62
HANDS_APART = 0.1  # in m, while the hands go around the loop


def points(joints: Array) -> Array:
    """Return shoulder, elbow, wrist and hand (…, 4, 3) of an arm for its joint angles (…, 7)."""
    about = "zyzyzyz"
    lengths = (0.0, UPPER, 0.0, FORE, 0.0, HAND, 0.0)
    turned = np.broadcast_to(np.eye(3), (*joints.shape[:-1], 3, 3))
    at = np.broadcast_to(np.array([0.0, 0.0, SHOULDER]), (*joints.shape[:-1], 3))
    found = [at]
    for index, (axis, length) in enumerate(zip(about, lengths, strict=True)):
        turned = turned @ _turn(axis, joints[..., index])
        if length:
            at = at + length * turned[..., :, 2]
            found.append(at)
    return np.stack(found, axis=-2)


def hands(joints: Array) -> Array:
    """Return where the hands (…, 2, 3) of both arms are for joint angles (…, 2, 7)."""
    at: Array = points(joints)[..., -1, :] + BASES
    return at


def hands_apart(joints: Array) -> Array:
    """Return the distance (…) between the hands."""
    at = hands(joints)
    return np.asarray(np.linalg.norm(at[..., 0, :] - at[..., 1, :], axis=-1))


def _turn(axis: str, angle: Array) -> Array:
    c, s, o, e = np.cos(angle), np.sin(angle), np.zeros_like(angle), np.ones_like(angle)
    rows = [[c, -s, o], [s, c, o], [o, o, e]] if axis == "z" else [[c, o, s], [o, e, o], [-s, o, c]]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def follow(targets: Array, start: Array) -> Array:
    """Return joint angles (n, 7) that bring the hand to `targets` (n, 3).

    Each row starts from the row before.

    Seven joints for three coordinates have many solutions. This takes the one nearest to `start` (damped
    least squares).
    """
    joints, way = start.copy(), []
    for target in targets:
        for _ in range(60):
            missing = target - points(joints)[-1]
            if np.abs(missing).max() < 1e-5:
                break
            small = 1e-6 * np.eye(7)
            jacobian = (points(joints + small)[:, -1] - points(joints)[-1]).T / 1e-6
            inverse = jacobian.T @ np.linalg.inv(jacobian @ jacobian.T + 1e-6 * np.eye(3))
            joints = joints + inverse @ missing + (np.eye(7) - inverse @ jacobian) @ (0.05 * (start - joints))
        way.append(joints)
    return np.array(way)


def demonstration(period_s: float, pace: float = 1.0) -> Array:
    """Return joint angles (n, 2, 7): from rest to a loop, around it hand in hand, and back to rest.

    `pace` 2 is twice as fast.
    """

    def ease(duration_s: float) -> Array:
        steps = round(duration_s / pace / period_s)
        t = np.arange(1, steps + 1) / steps
        return t**3 * (10 - 15 * t + 6 * t**2)

    turn = 2 * np.pi * ease(3.2)
    sideways = (
        RADIUS * np.sin(turn) * (1 - np.cos(turn)) / 1.3
    )  # straight up at first, and straight down at last
    loop = np.stack([0.55 + 0 * turn, sideways, CENTRE_Z - RADIUS * np.cos(turn)], axis=-1)
    arms = []
    for base in BASES:
        grip = loop + np.array([0.0, HANDS_APART / 2 * np.sign(base[1]), 0.0]) - base
        start = follow(grip[:1], REST)[0]
        around = follow(grip, start)
        # the last joint turns the hand without moving it
        around[:, 6] = 0.35 * np.sin(turn) * np.sign(base[1])
        reach = REST + ease(1.6)[:, None] * (start - REST)
        back = around[-1] + ease(1.6)[:, None] * (REST - around[-1])
        arms.append(np.concatenate([reach, around, back]))
    return np.stack(arms, axis=1)
