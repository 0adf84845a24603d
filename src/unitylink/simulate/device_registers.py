# SPDX-License-Identifier: BSD-3-Clause
"""The registers of a device at the pins of a component, as a plant sets them."""

from __future__ import annotations

from unitylink import _native
from unitylink.errors import ValueRangeError

_REGISTERS = 256
_WORDS = 16
_WORD_BYTES = 4

_FRAME_BEGINS = 0x2000  # in a word of the program of a device, if its bits 15 and 14 are not both 1


def i2c_address(program: str) -> int:
    """Return the address of a device on I²C: it is in the byte that begins a frame."""
    words = (int(program[place : place + 4], 16) for place in range(0, len(program), 4))
    return next((word & 0xFF) >> 1 for word in words if word < 0xC000 and word & _FRAME_BEGINS)


class DeviceRegisters:
    """256 registers of 8 bits. The gateware reads and writes them over the pins, frame by frame.

        sensor[0x1D] = 0x12                      # one register
        sensor[0x1D:0x1F] = bytes([0x12, 0x34])  # two, at the same time
        bytes(sensor[0x1D:0x1F])                 # what is in them
        sensor.plugged = False                   # it neither hears nor answers

    Calls may come from any thread. Raises ValueRangeError for a register or a byte that there is not.
    """

    def __init__(self, native: _native.BoardDevice, path: str, *, clock_hz: int = 0) -> None:
        self._native = native
        self._path = path
        self._clock_hz = clock_hz
        self._plugged = True

    @property
    def plugged(self) -> bool:
        """Whether the device is there. It keeps its registers while it is not."""
        return self._plugged

    @plugged.setter
    def plugged(self, plugged: bool) -> None:
        self._plugged = plugged
        self._native.plug(plugged)

    @property
    def shortest_s(self) -> dict[str, float]:
        """The shortest times that the device has seen at its lines, to compare with those of its datasheet.

        On SPI: `sclk_high`, `sclk_low`, `select_setup` (select_n falls, then sclk changes), `select_hold` and
        `select_high`. On I²C: `scl_high`, `scl_low`, `data_setup`, `start_setup`, `start_hold`, `stop_setup`
        and `bus_free`. A time that has not ended yet is not there.
        """
        return {what: clocks / self._clock_hz for what, clocks in self._native.shortest().items()}

    def set_word(self, number: int, value: int) -> None:
        """Set a word of a device that has no registers, but sends words: 0 to 15, with at most 32 bits."""
        if not 0 <= number < _WORDS or not 0 <= value < 1 << 8 * _WORD_BYTES:
            raise ValueRangeError(
                f"the device of {self._path} has words 0 to {_WORDS - 1} of 32 bits: choose another than "
                f"word {number} with {value}"
            )
        self._native.set(_WORD_BYTES * number, value.to_bytes(_WORD_BYTES, "big"))

    def __getitem__(self, place: int | slice) -> int | bytes:
        found = self._native.get()
        return found[place] if isinstance(place, slice) else found[self._checked(place)]

    def __setitem__(self, place: int | slice, values: int | bytes) -> None:
        if isinstance(place, slice):
            first, stop, step = place.indices(_REGISTERS)
            count = max(0, stop - first)
            if isinstance(values, int) or step != 1 or len(values) != count:
                raise ValueRangeError(
                    f"the device of {self._path}: registers {first} to {stop - 1} take {count} bytes"
                )
            self._native.set(first, bytes(values))
        elif isinstance(values, int) and 0 <= values <= 255:
            self._native.set(self._checked(place), bytes([values]))
        else:
            raise ValueRangeError(f"the device of {self._path}: a register is 0 to 255, not {values!r}")

    def _checked(self, place: int) -> int:
        if not 0 <= place < _REGISTERS:
            raise ValueRangeError(
                f"the device of {self._path} has registers 0 to {_REGISTERS - 1}, not {place}"
            )
        return place
