# SPDX-License-Identifier: BSD-3-Clause
"""Groups that publish on change, on a virtual board. It does what the gateware's comparator does."""

from __future__ import annotations

from collections.abc import Callable

from unitylink.errors import ValueRangeError
from unitylink.spec.model import Spec

from .registers import Registers


class ChangeWatch:
    """Pulses the event line of a group when one of its words has changed since the last look.

    A board looks after every step of its plant, so several changes within one step count as one.
    """

    def __init__(self, spec: Spec, registers: Registers, pulse: Callable[[int], None]) -> None:
        self._groups = [
            (group.number, group.addresses)
            for device in spec.devices
            for group in device.groups
            if group.trigger == "change"
        ]
        self._registers = registers
        self._pulse = pulse
        self._before: dict[int, tuple[int | None, ...]] = {}

    def __bool__(self) -> bool:
        return bool(self._groups)

    def look(self) -> None:
        for number, addresses in self._groups:
            words = tuple(self._word(address) for address in addresses)
            if self._before.setdefault(number, words) != words:
                self._before[number] = words
                self._pulse(number)

    def _word(self, address: int) -> int | None:
        try:
            return self._registers[address]
        except ValueRangeError:  # the board's side cannot see this word
            return None
