# SPDX-License-Identifier: BSD-3-Clause
"""An encoder at the lines of `absolute_encoder`, as a plant uses it."""

from __future__ import annotations

import math
from collections.abc import Callable

from unitylink import _native
from unitylink.errors import ValueRangeError
from unitylink.interface.components import ComponentConfiguration

from .device_registers import DeviceRegisters

_SSI, _ON_SPI = 0, 2  # kinds of an absolute_encoder
_FAULTS = 4
_ERROR, _WARNING = 1, 2


class SerialEncoder:
    """An absolute encoder with SSI, BiSS-C, or the frames of an AS5047P, as the component says.

        encoder = board.components["joint"].serial_encoder()
        encoder.turn(4711.0)     # counts; whole turns are added to what it shows, which is within one
        encoder.error = True     # it says that it does not work
        encoder.plugged = False  # it does not answer

    Calls may come from any thread.
    """

    def __init__(self, registers: DeviceRegisters, bits: int) -> None:
        self._registers, self._bits = registers, bits

    @classmethod
    def at(
        cls,
        native: _native.Board,
        number: int,
        configuration: ComponentConfiguration,
        pin: Callable[[str, str, int], int],
    ) -> SerialEncoder | None:
        """Return one that is put at a component. None: its pins cannot be reached."""
        facts = {name: int(value) for name, value in configuration.generics}
        kind, sclk, miso = facts["kind"], pin("out", "sclk", 0), pin("in", "miso", 0)
        select_n, mosi = (pin("out", one, 0) if kind == _ON_SPI else sclk for one in ("select_n", "mosi"))
        around = (facts["lead_bits"], facts["tail_bits"]) if kind == _SSI else (0, 0)
        # it is ready sooner than the reader asks again, but not between two clocks
        quiet_s = max(0.75e-6 * facts["pause_us"], 1.5 / facts["sclk_hz"])
        form = (kind, facts["bits"], *around)
        lines = sclk, select_n, mosi, miso
        quiet = quiet_s * facts["clock_hz"]
        found = native.attach_serial_encoder(number, lines, form, bool(facts["gray"]), quiet)
        return cls(DeviceRegisters(found, configuration.path), facts["bits"]) if found else None

    @property
    def plugged(self) -> bool:
        """Whether the encoder is there."""
        return self._registers.plugged

    @plugged.setter
    def plugged(self, plugged: bool) -> None:
        self._registers.plugged = plugged

    @property
    def reading(self) -> int:
        """What it shows, within one turn."""
        return int.from_bytes(bytes(self._registers[0:4]), "little")

    def turn(self, counts: float) -> None:
        """Turn it to so many counts. The next frame shows them; fractions are cut off downwards.

        Raises ValueRangeError for what is no position.
        """
        if not math.isfinite(counts):
            raise ValueRangeError(f"an encoder cannot be at {counts} counts: give a finite position")
        self._registers[0:4] = (math.floor(counts) % (1 << self._bits)).to_bytes(4, "little")

    @property
    def error(self) -> bool:
        """Whether it reports an error. SSI has no bit for it."""
        return self._has(_ERROR)

    @error.setter
    def error(self, on: bool) -> None:
        self._let(_ERROR, on)

    @property
    def warning(self) -> bool:
        """Whether it warns. Only BiSS-C has a bit for it."""
        return self._has(_WARNING)

    @warning.setter
    def warning(self, on: bool) -> None:
        self._let(_WARNING, on)

    def _has(self, bit: int) -> bool:
        return bool(bytes(self._registers[_FAULTS : _FAULTS + 1])[0] & bit)

    def _let(self, bit: int, on: bool) -> None:
        others = bytes(self._registers[_FAULTS : _FAULTS + 1])[0] & ~bit
        self._registers[_FAULTS] = others | bit if on else others
