# SPDX-License-Identifier: BSD-3-Clause
"""A host, the chip and the gateware on one virtual clock."""

from __future__ import annotations

import math
from collections import deque

from .chip import Chip
from .gateware import CLOCK_HZ, Gateware
from .link_parameters import LinkParameters

_CLOCK_FRACTION = 1e-6  # allowance for the rounding of binary fractions


class VirtualLink:
    """A board as a program on the PC sees it. `now_s` moves only when the program waits.

    `received` has the time and the bytes of each transfer that reached the program. `lost` counts the bytes
    that met a full FIFO, on a line without flow control.

    >>> from unitylink_lab.experiments.gateware import Gateware2012
    >>> from unitylink_lab.experiments.link_parameters import FT245_ASYNC
    >>> link = VirtualLink(FT245_ASYNC, Gateware2012())
    >>> link.send(b"#R:12\\n")
    >>> link.wait(14)
    >>> round(link.now_s * 1e6), link.received[-1][1]
    (1125, b'#S_R:00000000\\n')
    """

    def __init__(self, parameters: LinkParameters, gateware: Gateware) -> None:
        self.parameters = parameters
        self.gateware = gateware
        self.chip = Chip(parameters)
        self.now_s = 0.0
        self.received: list[tuple[float, bytes]] = []
        self.lost = 0
        self._outgoing: deque[int] = deque()
        self._microframe = 0
        self._to_board_s = 0.0  # time from which the line is free
        self._to_host_s = 0.0
        self._publish = False  # whether the message on its way to the host is a publish
        self._begins = True  # whether the next byte to the host begins a message
        self._count = 0

    def send(self, data: bytes) -> None:
        """Give bytes to the chip now."""
        self._outgoing.extend(data)

    def wait(self, count: int, *, limit_s: float = 1.0) -> None:
        """Let time pass until `count` more bytes have come. Raises TimeoutError after `limit_s`."""
        target, end_s = self._count + count, self.now_s + limit_s
        while self._count < target:
            if self.now_s >= end_s:
                raise TimeoutError(f"{target - self._count} of {count} bytes are missing after {limit_s:g} s")
            self._microframe_passes()

    def run_until(self, time_s: float) -> None:
        """Let time pass until the end of the microframe that holds `time_s`."""
        while self.now_s < time_s:
            self._microframe_passes()

    def _microframe_passes(self) -> None:
        """Ask the chip for packets until it has none.

        The program gets these packets at the end of the microframe.
        """
        p = self.parameters
        packets: list[bytes] = []
        asking = True
        for token in range(p.packets_per_microframe):
            if asking:
                packet = self.chip.poll(self._token_s(token))
                asking = packet is not None
                packets += [packet] if packet else []
            self._carry(self._token_s(token), self._token_s(token + 1))
        self._microframe += 1
        self.now_s = self._token_s(0)
        self.gateware.run_until(int(self.now_s * CLOCK_HZ))
        self.received += [(self.now_s, packet) for packet in packets]
        self._count += sum(len(packet) for packet in packets)

    def _token_s(self, token: int) -> float:
        p = self.parameters
        return (self._microframe + token / p.packets_per_microframe) * p.microframe_s

    def _carry(self, time_s: float, end_s: float) -> None:
        """Move bytes over the lines from `time_s` to `end_s`. Those towards the host go first."""
        while time_s < end_s:
            self.gateware.run_until(math.ceil(time_s * CLOCK_HZ - _CLOCK_FRACTION))
            refused = False
            if time_s >= self._to_host_s and self.gateware.waiting and self.chip.room:
                self._carry_to_host(time_s)
            if time_s >= self._to_board_s and self._outgoing:
                refused = not self._carry_to_board(time_s)
            time_s = min(end_s, self._next_s(time_s, refused))

    def _carry_to_host(self, time_s: float) -> None:
        byte = self.gateware.take()
        if self._begins:
            self._publish = byte in self.gateware.publish_heads
        self._begins = byte == self.gateware.terminator
        self.chip.put(byte, ends_message=self._begins, publish=self._publish)
        self._to_host_s = time_s + self.parameters.byte_s
        if self.parameters.half_duplex:
            self._to_board_s = max(self._to_board_s, self._to_host_s)

    def _carry_to_board(self, time_s: float) -> bool:
        """Offer the oldest byte to the board. The result is False if the byte has to wait for room."""
        if not self.gateware.receive(self._outgoing[0]):
            if self.parameters.flow_controlled:
                return False
            self.lost += 1
        self._outgoing.popleft()
        self._to_board_s = time_s + self.parameters.byte_s
        if self.parameters.half_duplex:
            self._to_host_s = max(self._to_host_s, self._to_board_s)
        return True

    def _next_s(self, time_s: float, refused: bool) -> float:
        """Return when something can happen next."""
        times = [math.inf]
        if self.gateware.waiting and self.chip.room:
            times.append(self._to_host_s)
        if self._outgoing and not refused:
            times.append(self._to_board_s)
        if (event := self.gateware.next_event) is not None:
            if refused:  # wait until there is room
                times.append(event / CLOCK_HZ)
            elif not self.gateware.waiting:  # wait until there is a byte and the line is free for it
                times.append(max(event / CLOCK_HZ, self._to_host_s))
        return max(min(times), time_s + 1 / CLOCK_HZ)
