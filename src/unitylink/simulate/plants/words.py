# SPDX-License-Identifier: BSD-3-Clause
"""Plants of words that count and words that echo. The board steps them itself, without Python."""

from __future__ import annotations

from typing import NamedTuple

from unitylink.errors import UnityLinkError
from unitylink.spec.model import Element, Spec

from ..registers import Registers


class Ramp(NamedTuple):
    """A word that counts from `low` through `span` values, `pace_hz` of them a second, and then starts again
    at `low`.
    """

    address: int
    low: int
    span: int
    pace_hz: float


class Echo(NamedTuple):
    """A word at address `target` that follows what the PC wrote to `source`."""

    source: int
    target: int


class WordPlant:
    """Ramps and echoes. A subclass chooses them in `fill`."""

    period_s: float = 0.001

    def __init__(self, ramps: list[Ramp] | None = None, echoes: list[Echo] | None = None) -> None:
        self.ramps: list[Ramp] = ramps or []
        self.echoes: list[Echo] = echoes or []
        self._registers: Registers | None = None

    def attach(self, spec: Spec | None, registers: Registers) -> None:
        """Fill `ramps` and `echoes` for the elements of `spec`, in `fill`."""
        self._registers = registers
        self.fill(spec, registers)
        owns = registers.components.owns
        self.ramps = [ramp for ramp in self.ramps if not owns(ramp.address)]
        self.echoes = [echo for echo in self.echoes if not owns(echo.target)]

    def fill(self, spec: Spec | None, registers: Registers) -> None:
        """Choose ramps and echoes, in a subclass."""

    def step(self, time_s: float) -> None:
        """Move on to `time_s` in Python, for a board that looks after every step."""
        registers = self._registers
        if registers is None:
            raise UnityLinkError("plant of words: step() before attach()")
        mask = (1 << registers.data_bits) - 1
        for ramp in self.ramps:
            count = int(time_s * ramp.pace_hz) % ramp.span
            registers[ramp.address] = ramp.low + count & mask
        for echo in self.echoes:
            registers[echo.target] = registers[echo.source]

    def ramp(self, element: Element, data_bits: int) -> None:
        """Let a READ count at a pace of its own, through negative values too if it is signed.

        A truth value blinks. An enumeration without gaps goes through its members. Other kinds do not change,
        because a count would not be one of their values.
        """
        kind = element.type
        width = data_bits if kind.bus else kind.width
        if kind.kind == "bool":
            self.ramps.append(Ramp(element.address, 0, 2, 2.0))
        elif kind.enum is not None:
            numbers = {item.value for item in kind.enum.values}
            if numbers == set(range(len(numbers))):
                self.ramps.append(Ramp(element.address, 0, len(numbers), 2.0))
        elif kind.kind in ("int", "uint", "fixed", "ufixed"):
            half = min(1000, 100 if width == 8 else 1 << (width - 1))
            pace_hz = 100.0 + 10.0 * len(self.ramps)
            low = -half if element.signed and element.words == 1 else 0
            self.ramps.append(Ramp(element.address, low, 2 * half, pace_hz))
