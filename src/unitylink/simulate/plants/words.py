# SPDX-License-Identifier: BSD-3-Clause
"""Plants made of words that count and words that echo; the board steps them itself, without Python."""

from __future__ import annotations

from typing import NamedTuple

from unitylink.spec.model import Element, Spec

from ..registers import Registers


class Ramp(NamedTuple):
    """A word that counts from `low` over `span` values, `pace_hz` of them a second, then from `low` again."""

    address: int
    low: int
    span: int
    pace_hz: float


class Echo(NamedTuple):
    """A word at address `target` that follows what the PC wrote to `source`."""

    source: int
    target: int


class WordPlant:
    """Ramps and echoes; a subclass decides which in `attach`."""

    period_s: float = 0.001

    def __init__(self, ramps: list[Ramp] | None = None, echoes: list[Echo] | None = None) -> None:
        self.ramps: list[Ramp] = ramps or []
        self.echoes: list[Echo] = echoes or []

    def attach(self, spec: Spec | None, registers: Registers) -> None:
        """Fill `ramps` and `echoes` for the elements of `spec`."""

    def ramp(self, element: Element, data_bits: int) -> None:
        """Let a READ count at a pace of its own, through negative values too if it is signed."""
        half = min(1000, 100 if data_bits <= 8 else 1 << (data_bits - 1))
        pace_hz = 100.0 + 10.0 * len(self.ramps)
        self.ramps.append(Ramp(element.address, -half if element.signed else 0, 2 * half, pace_hz))
