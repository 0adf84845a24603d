# SPDX-License-Identifier: BSD-3-Clause
"""The FT232H chip, seen from the host: which bytes it keeps, and when it sends a packet."""

from __future__ import annotations

from .link_parameters import LinkParameters

_TOLERANCE_S = 1e-9  # sums of microframe times are rounded, so they are not exact


class Chip:
    """A chip that collects bytes of the board and answers the host's IN tokens. The caller owns the clock.

    >>> from unitylink_lab.experiments.link_parameters import FT245_ASYNC
    >>> chip = Chip(FT245_ASYNC)
    >>> chip.put(0x41, ends_message=True)
    >>> chip.poll(125e-6), chip.poll(1e-3)
    (None, b'A')
    """

    def __init__(self, parameters: LinkParameters) -> None:
        self.parameters = parameters
        self.held = False  # send-immediate asks for this, until the next IN token
        self._bytes = bytearray()
        self._event = False
        self._timer_from_s = 0.0

    @property
    def room(self) -> int:
        """How many more bytes the chip can take now."""
        if self.held:
            return 0
        return self.parameters.chip_packets * self.parameters.payload_bytes - len(self._bytes)

    def put(self, byte: int, *, ends_message: bool, publish: bool = False) -> None:
        """Take a byte from the board. The last byte of a message may make the chip send a packet."""
        self._bytes.append(byte)
        if byte == self.parameters.event_character:
            self._event = True
        immediate = self.parameters.send_immediate
        if ends_message and (immediate == "all" or (immediate == "publishes" and publish)):
            self.held = True

    def poll(self, time_s: float) -> bytes | None:
        """Return the packet that answers an IN token at `time_s`, without its status.

        None stands for a NAK.
        """
        p = self.parameters
        full = len(self._bytes) >= p.payload_bytes
        expired = time_s - self._timer_from_s >= p.latency_timer_s - _TOLERANCE_S
        if not (full or expired or self.held or self._event):
            return None
        packet = bytes(self._bytes[: p.payload_bytes])
        del self._bytes[: p.payload_bytes]
        self._timer_from_s = time_s
        if not self._bytes:
            self.held = self._event = False
        return packet
