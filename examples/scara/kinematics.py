# SPDX-License-Identifier: BSD-3-Clause
"""The arm's geometry and the units of its joints: counts, degrees, millimetres."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

UPPER_ARM_MM = 250.0
FOREARM_MM = 200.0


@dataclass(frozen=True)
class Joint:
    """A joint with the counts of its encoder."""

    name: str  # its name in the spec
    role: str
    unit: str
    counts_per_unit: float

    def counts(self, position: float) -> int:
        return round(position * self.counts_per_unit)

    def position(self, counts: Array) -> Array:
        return counts / self.counts_per_unit


JOINTS = (
    Joint("j1", "shoulder", "deg", 100.0),
    Joint("j2", "elbow", "deg", 100.0),
    Joint("j3", "lift", "mm", 100.0),
    Joint("j4", "tool", "deg", 100.0),
)


def tool_position(shoulder_deg: Array, elbow_deg: Array) -> tuple[Array, Array]:
    """Return x, y of the tool in mm.

    >>> x, y = tool_position(np.array(0.0), np.array(90.0))
    >>> round(float(x)), round(float(y))
    (250, 200)
    """
    shoulder, both = np.radians(shoulder_deg), np.radians(shoulder_deg + elbow_deg)
    x = UPPER_ARM_MM * np.cos(shoulder) + FOREARM_MM * np.cos(both)
    y = UPPER_ARM_MM * np.sin(shoulder) + FOREARM_MM * np.sin(both)
    return x, y


def joint_angles(x_mm: Array, y_mm: Array) -> tuple[Array, Array]:
    """Return shoulder and elbow in degrees for a tool position within reach. The elbow bends to the left.

    >>> shoulder, elbow = joint_angles(np.array(250.0), np.array(200.0))
    >>> round(float(shoulder)), round(float(elbow))
    (0, 90)
    """
    square = x_mm**2 + y_mm**2 - UPPER_ARM_MM**2 - FOREARM_MM**2
    elbow = np.arccos(np.clip(square / (2 * UPPER_ARM_MM * FOREARM_MM), -1.0, 1.0))
    inner = np.arctan2(FOREARM_MM * np.sin(elbow), UPPER_ARM_MM + FOREARM_MM * np.cos(elbow))
    return np.degrees(np.arctan2(y_mm, x_mm) - inner), np.degrees(elbow)
