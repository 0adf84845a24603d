# SPDX-License-Identifier: BSD-3-Clause
"""A device on the line of a `modbus_master`, as a plant uses it."""

from __future__ import annotations

from collections.abc import Iterator

from .serial_end import SerialEnd

_READS, _WRITES = (3, 4), (6, 16)
_WRONG_FUNCTION, _WRONG_REGISTER = 1, 2
_REQUEST_BYTES = 8
_LONG_REQUEST_BYTES = 11  # the function 16 with one register


class ModbusDevice:
    """A device with registers of 16 bits. It answers when it is told to, so a plant does so in each step.

        drive = board.components["pump"].modbus(unit=1)
        drive[0x2100] = 0          # its registers
        drive.answer()             # to what has come since the last call
        drive[0x2000]              # what was written
        drive.plugged = False      # it no longer answers

    A request for a register that it does not have is refused, with the exception 2.
    """

    def __init__(self, line: SerialEnd, unit: int) -> None:
        self.plugged = True
        self._line = line
        self._unit = unit
        self._registers: dict[int, int] = {}
        self._heard = bytearray()

    def __getitem__(self, register: int) -> int:
        return self._registers[register]

    def __setitem__(self, register: int, value: int) -> None:
        self._registers[register] = value & 0xFFFF

    def answer(self) -> None:
        """Answer the requests that have come."""
        self._heard += self._line.take()
        for request in self._requests():
            if self.plugged and request[0] == self._unit:
                body = bytes([self._unit]) + self._reply(request)
                self._line.send(body + crc16(body))

    def _requests(self) -> Iterator[bytes]:
        while len(self._heard) >= _REQUEST_BYTES:
            size = _LONG_REQUEST_BYTES if self._heard[1] == 16 else _REQUEST_BYTES
            if len(self._heard) < size:
                return
            request = bytes(self._heard[:size])
            if crc16(request[:-2]) == request[-2:]:
                del self._heard[:size]
                yield request
            else:
                del self._heard[0]

    def _reply(self, request: bytes) -> bytes:
        function = request[1]
        first, count = (int.from_bytes(request[place : place + 2], "big") for place in (2, 4))
        asked = range(first, first + (count if function in _READS else 1))
        if function not in (*_READS, *_WRITES):
            return bytes([function | 0x80, _WRONG_FUNCTION])
        if any(register not in self._registers for register in asked):
            return bytes([function | 0x80, _WRONG_REGISTER])
        if function in _READS:
            data = b"".join(self._registers[register].to_bytes(2, "big") for register in asked)
            return bytes([function, len(data)]) + data
        self[first] = count if function == 6 else int.from_bytes(request[7:9], "big")
        return request[1:6]


def crc16(data: bytes) -> bytes:
    """Return the check of Modbus, as it is sent.

    >>> crc16(bytes.fromhex("1103006B0003")).hex()
    '7687'
    """
    crc = 0xFFFF
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = crc >> 1 ^ 0xA001 if crc & 1 else crc >> 1
    return crc.to_bytes(2, "little")
