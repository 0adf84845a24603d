# SPDX-License-Identifier: BSD-3-Clause
"""What the sensors at the pins of components share, as a plant uses them."""

from __future__ import annotations

from .device_registers import DeviceRegisters


class Sensor:
    """A sensor whose state is in registers. Calls may come from any thread."""

    def __init__(self, registers: DeviceRegisters, clock_hz: int) -> None:
        self._registers = registers
        self._clock_hz = clock_hz

    @property
    def plugged(self) -> bool:
        """Whether it is there. If not, it neither hears nor answers."""
        return self._registers.plugged

    @plugged.setter
    def plugged(self, plugged: bool) -> None:
        self._registers.plugged = plugged

    def _put(self, first: int, number: int, count: int) -> None:
        """Set so many registers to a number, low byte first, at the same time."""
        self._registers[first : first + count] = number.to_bytes(count, "little")

    def _clocks(self, first: int) -> int:
        """Return the clocks that four registers have."""
        return int.from_bytes(bytes(self._registers[first : first + 4]), "little")
