# SPDX-License-Identifier: BSD-3-Clause
"""The plant of a spec that has no other: every READ counts."""

from __future__ import annotations

from unitylink.spec.model import Spec

from ..registers import Registers
from .words import WordPlant


class RampPlant(WordPlant):
    """Every READ counts up at its own pace: signed ones from -1000 to 999, others from 0 to 1999.

    The counters of a FIFO and the words of a double buffer do not change.
    """

    def fill(self, spec: Spec | None, registers: Registers) -> None:
        for _, element in spec.walk() if spec else ():
            if element.pollable and not element.writable and element.link.kind in ("memory", "tosnet"):
                self.ramp(element, registers.data_bits)
