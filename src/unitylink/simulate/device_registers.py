# SPDX-License-Identifier: BSD-3-Clause
"""The registers of a device at the pins of a component, as a plant sets them."""

from __future__ import annotations

from unitylink import _native
from unitylink.errors import ValueRangeError

_REGISTERS = 256


class DeviceRegisters:
    """256 registers of 8 bits. The gateware reads and writes them over the pins, frame by frame.

        sensor[0x1D] = 0x12                      # one register
        sensor[0x1D:0x1F] = bytes([0x12, 0x34])  # two, at the same time
        bytes(sensor[0x1D:0x1F])                 # what is in them
        sensor.plugged = False                   # it neither hears nor answers

    Calls may come from any thread. Raises ValueRangeError for a register or a byte that there is not.
    """

    def __init__(self, native: _native.BoardDevice, path: str) -> None:
        self._native = native
        self._path = path
        self._plugged = True

    @property
    def plugged(self) -> bool:
        """Whether the device is there. It keeps its registers while it is not."""
        return self._plugged

    @plugged.setter
    def plugged(self, plugged: bool) -> None:
        self._plugged = plugged
        self._native.plug(plugged)

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
