# SPDX-License-Identifier: BSD-3-Clause
"""An incremental encoder: from an angle to edges on the lines a, b and index."""

from __future__ import annotations

import math

from ..components import BoardComponent
from .checks import check_number, check_whole


class Encoder:
    """Shows an angle to a `quadrature_encoder`, in whole counts. Four counts are a pulse of a line.

        encoder = Encoder(registers.components["wheel"], pulses_per_turn=512)
        encoder.show(motor.rotor_angle_rad, self.period_s)  # in each step

    The lines pass through all counts, evenly within a step. It begins at 0 where it is shown first, as a
    counter does when the power comes. With `index`, the third line is high at each whole turn.
    """

    def __init__(
        self,
        component: BoardComponent,
        pulses_per_turn: int,
        *,
        index: bool = False,
        reversed_lines: bool = False,
    ) -> None:
        self._pins = component
        self._where = f"encoder at {component.configuration.path}"
        pulses = check_whole(
            self._where,
            "pulses_per_turn",
            pulses_per_turn,
            remedy="a datasheet with counts has 4 for a pulse",
        )
        self.counts_per_turn = 4 * pulses
        self._factor = (-1 if reversed_lines else 1) * self.counts_per_turn / (2 * math.pi)
        self._per_turn = self.counts_per_turn if index else 0
        self._start: float | None = None

    def show(self, angle_rad: float, seconds: float) -> int:
        """Turn to an angle within a step of the plant. Return the counts since the start."""
        check_number(self._where, "angle_rad", angle_rad, remedy="look at what the plant computes")
        if self._start is None:
            self._start = angle_rad
        counts = math.floor((angle_rad - self._start) * self._factor)
        self._pins.turn(counts, seconds, per_turn=self._per_turn)
        return counts
