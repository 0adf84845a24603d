# SPDX-License-Identifier: BSD-3-Clause
"""The gateware behind the chip: the 2012 one clock for clock, and ours by the clocks its tests hold it to."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from typing import Protocol

from unitylink import _native
from unitylink.board_configuration import BoardConfiguration

CLOCK_HZ = 50_000_000
_LINE_FEED = 0x0A
_LARGE = 1 << 16  # bytes: what fifo 0 means
_IN_FLIGHT_CLOCKS = 16  # from the word a byte comes of


class Gateware(Protocol):
    """Bytes in, bytes out, and when each message was executed and answered."""

    answered: list[int]  # clock at which the last byte of each message left the core
    peak: int  # most bytes that have waited in the transmit FIFO

    @property
    def waiting(self) -> int: ...  # bytes in the transmit FIFO
    @property
    def next_event(self) -> int | None: ...
    def receive(self, byte: int) -> bool: ...  # False: the receive FIFO is full
    def run_until(self, clock: int) -> None: ...
    def take(self) -> int: ...  # the oldest byte; `waiting` must not be 0


class Gateware2012:
    """The gateware of 2012: the twin, which has its clocks, between FIFOs of `fifo` bytes.

    `watch` is an address; `effects` gets the clock of each change of its word.

    >>> gateware = Gateware2012(fifo=256)
    >>> all(gateware.receive(byte) for byte in b"#R:12\\n")
    True
    >>> gateware.run_until(100); gateware.answered, gateware.waiting
    ([57], 14)
    """

    def __init__(self, *, fifo: int = 256, fifo_latency: int = 2, watch: int | None = None) -> None:
        self._device = _native.Device(
            BoardConfiguration(fifo=fifo, fifo_latency=fifo_latency, clock_hz=CLOCK_HZ, protocol="classic")
        )
        self._depth = fifo or _LARGE
        self._latency = fifo_latency  # a byte can be taken so long after it was sent
        self._stalled = 0  # clocks for which the transmit FIFO was full and the core stood still
        self._transmit: deque[int] = deque()
        self._watch = watch
        self._word = None if watch is None else self._device.get(watch)
        self.answered: list[int] = []
        self.effects: list[int] = []
        self.peak = 0

    @property
    def waiting(self) -> int:
        return len(self._transmit)

    @property
    def next_event(self) -> int | None:
        if len(self._transmit) >= self._depth:
            return None
        device = self._device
        if device.clock < device.last_activity + self._latency + _IN_FLIGHT_CLOCKS:
            return device.clock + 1 + self._stalled  # what was sent is on its way through the FIFO
        return None if (event := device.next_event) is None else event + self._stalled

    def receive(self, byte: int) -> bool:
        return self._device.receive(bytes([byte])) == 1

    def run_until(self, clock: int) -> None:
        device = self._device
        while device.clock + self._stalled < clock:
            if len(self._transmit) >= self._depth:
                self._stalled = clock - device.clock
                return
            end, event = clock - self._stalled, device.next_event
            device.run_until(end if event is None else max(device.clock + 1, min(end, event)))
            if self._watch is not None and (word := device.get(self._watch)) != self._word:
                self._word = word
                self.effects.append(device.clock + self._stalled)
            for at, byte in device.take_timed():
                self._transmit.append(byte)
                if byte == _LINE_FEED:
                    self.answered.append(at + self._stalled)
            self.peak = max(self.peak, len(self._transmit))

    def take(self) -> int:
        return self._transmit.popleft()


@dataclass(frozen=True)
class CoreClocks:
    """What a request costs our core: last byte in to first and to last byte out, and the period of many."""

    first_out: int
    last_out: int
    period: int


FIFO_CLOCKS = 4  # through both FIFOs
# docs/gateware/core.md, which the RTL is held to; a write's answer comes from the figure through both FIFOs.
CORE = {b"#R": CoreClocks(6, 23, 14), b"#W": CoreClocks(14, 18, 14)}
CORE_CHECKED_PERIOD = {b"$R": 17, b"$W": 17}
_REPLY = {b"#R": b"#S_R:00000000\n", b"#W": b"#S_W\n"}


class Core:
    """Our core between FIFOs of `fifo` bytes, by its clocks; it knows reads and writes
    without checksum.

    >>> core = Core(fifo=256)
    >>> all(core.receive(byte) for byte in b"#R:12\\n")
    True
    >>> core.run_until(100); core.answered, core.waiting
    ([27], 14)
    """

    def __init__(self, *, fifo: int = 256) -> None:
        self._fifo = fifo
        self._clock = 0
        self._received = bytearray()
        self._due: deque[tuple[int, int]] = deque()
        self._transmit: deque[int] = deque()
        self._free_at = 0
        self.answered: list[int] = []
        self.peak = 0

    @property
    def waiting(self) -> int:
        return len(self._transmit)

    @property
    def next_event(self) -> int | None:
        stalled = len(self._transmit) >= self._fifo
        return self._due[0][0] if self._due and not stalled else None

    def receive(self, byte: int) -> bool:
        if len(self._received) >= self._fifo:
            return False
        self._received.append(byte)
        self._execute()
        return True

    def run_until(self, clock: int) -> None:
        self._clock = max(self._clock, clock)
        while self._due and self._due[0][0] <= clock and len(self._transmit) < self._fifo:
            at, byte = self._due.popleft()
            self._transmit.append(byte)
            if byte == _LINE_FEED:
                self.answered.append(at)
        self.peak = max(self.peak, len(self._transmit))
        self._execute()

    def take(self) -> int:
        return self._transmit.popleft()

    def _execute(self) -> None:
        """Begin each request that is whole while the transmitter is not stalled."""
        while (end := self._received.find(_LINE_FEED)) >= 0 and len(self._transmit) + len(
            self._due
        ) < self._fifo:
            kind = bytes(self._received[: self._received.find(b":")])
            del self._received[: end + 1]
            clocks, reply = CORE[kind], _REPLY[kind]
            start = max(self._clock + FIFO_CLOCKS, self._free_at)
            self._free_at = start + clocks.period
            slope = (clocks.last_out - clocks.first_out) / (len(reply) - 1)
            for index, byte in enumerate(reply):
                self._due.append((start + clocks.first_out + round(index * slope), byte))
