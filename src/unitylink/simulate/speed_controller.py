# SPDX-License-Identifier: BSD-3-Clause
"""A speed controller at a line of `dshot`, as a plant uses it."""

from __future__ import annotations

import math

from unitylink.errors import ValueRangeError

from .device_registers import DeviceRegisters

_STANDS = 0xFFF  # the longest period
_MANTISSA_MOST = 0x1FF
_EXPONENT_MOST = 7
_US = 1_000_000


class SpeedController:
    """A speed controller (ESC) and its motor. It hears each frame, and sends what a plant says is the speed.

        esc = board.components["motor"].controller(0)
        esc.throttle        # from 0 to 1, of the last frame
        esc.turn(2000.0)    # the motor turns at 2000 electrical rad/s
        esc.plugged = False # it neither hears nor answers

    Calls may come from any thread.
    """

    def __init__(self, registers: DeviceRegisters) -> None:
        self._registers = registers

    @property
    def plugged(self) -> bool:
        """Whether the controller is there."""
        return self._registers.plugged

    @plugged.setter
    def plugged(self, plugged: bool) -> None:
        self._registers.plugged = plugged

    @property
    def value(self) -> int:
        """The number of the last frame: 0 stops, 1 to 47 are commands, the others are throttles."""
        return int.from_bytes(self._heard()[:2], "little")

    @property
    def throttle(self) -> float:
        """The throttle of the last frame, from 0 to 1. A command counts as 0."""
        return max(0, self.value - 47) / 2000

    @property
    def frames(self) -> int:
        """How many right frames it has heard, modulo 256."""
        return self._heard()[3]

    def turn(self, rad_per_s: float) -> None:
        """Let the motor turn at an electrical speed, which is that of the shaft times its pole pairs.

        Below 96 rad/s the protocol has no period, and the motor stands. Raises ValueRangeError for what is no
        speed.
        """
        if not math.isfinite(rad_per_s):
            raise ValueRangeError(f"a motor cannot turn at {rad_per_s} rad/s: give a finite speed")
        turns = abs(rad_per_s) / (2 * math.pi)
        period = round(_US / turns) if turns > 0 else _US
        exponent = max(0, period.bit_length() - _MANTISSA_MOST.bit_length())
        code = _STANDS if exponent > _EXPONENT_MOST else exponent << 9 | max(1, period >> exponent)
        self._registers[8:10] = code.to_bytes(2, "little")

    def _heard(self) -> bytes:
        return bytes(self._registers[0:4])
