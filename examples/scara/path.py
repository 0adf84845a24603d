# SPDX-License-Identifier: BSD-3-Clause
"""The path of the demonstration: reach out, lower the tool, draw a flower, lift, go home."""

from __future__ import annotations

import numpy as np
from kinematics import Array, joint_angles

CENTRE_MM = (300.0, 0.0)
RADIUS_MM = 115.0
PETALS = 5
DEPTH_MM = 40.0
HOME = np.zeros(4)


def ease(duration_s: float, period_s: float) -> Array:
    """Return progress from just above 0 to 1, at rest at both ends (minimum jerk)."""
    steps = max(1, round(duration_s / period_s))
    t = np.arange(1, steps + 1) / steps
    return t**3 * (10 - 15 * t + 6 * t**2)


def flower(progress: Array) -> Array:
    """Return joint positions (n, 4) on the flower. The tool keeps pointing outwards."""
    turn = 2 * np.pi * progress
    radius = RADIUS_MM * (0.74 + 0.26 * np.cos(PETALS * turn))
    x, y = CENTRE_MM[0] + radius * np.cos(turn), CENTRE_MM[1] + radius * np.sin(turn)
    shoulder, elbow = joint_angles(x, y)
    return np.stack([shoulder, elbow, np.full_like(x, DEPTH_MM), -(shoulder + elbow)], axis=1)


def move(start: Array, end: Array, duration_s: float, period_s: float) -> Array:
    """Return joint positions (n, 4) from just after `start` to `end`. All joints move together."""
    return start + ease(duration_s, period_s)[:, None] * (end - start)


def demonstration(period_s: float) -> list[tuple[str, Array]]:
    """Return (name, joint positions (n, 4) in deg, deg, mm, deg) for each part of the path.

    There is one row each `period_s`.
    """
    down = flower(np.array([0.0]))[0]
    up = down * [1, 1, 0, 1]
    return [
        ("reach", move(HOME, up, 1.4, period_s)),
        ("lower", move(up, down, 0.6, period_s)),
        ("draw a flower", flower(ease(4.5, period_s))),
        ("lift", move(down, up, 0.6, period_s)),
        ("home", move(up, HOME, 1.4, period_s)),
    ]
