# SPDX-License-Identifier: BSD-3-Clause
"""A bus in a dictionary, with a log. The log tells a test what a device has really done."""

from __future__ import annotations

from dataclasses import dataclass, field

from unitylink import protocol as p


class BusError(Exception):
    """The bus did not answer with a word. `status` is the reply status."""

    def __init__(self, status: int) -> None:
        super().__init__(status)
        self.status = status


@dataclass
class Bus:
    """Words at all addresses. Some of them answer with an error. It keeps a log of every access."""

    bad: dict[int, int] = field(default_factory=dict)  # address -> status: bus_error or bus_timeout
    words: dict[int, int] = field(default_factory=dict)
    fifos: dict[int, list[int]] = field(default_factory=dict)
    log: list[tuple[str, int, int]] = field(default_factory=list)

    def read(self, address: int) -> int:
        if address in self.bad:
            raise BusError(self.bad[address])
        fifo = self.fifos.get(address)
        if fifo is not None and not fifo:
            raise BusError(p.REPLY_STATUS_BUS_ERROR)
        value = fifo.pop(0) if fifo is not None else self.words.get(address, 0)
        self.log.append(("read", address, value))
        return value

    def write(self, address: int, value: int) -> None:
        if address in self.bad:
            raise BusError(self.bad[address])
        self.words[address] = value
        self.log.append(("write", address, value))
