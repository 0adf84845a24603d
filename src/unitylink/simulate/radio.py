# SPDX-License-Identifier: BSD-3-Clause
"""The receiver of a remote control at an `rc_receiver`, as a plant uses it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import Protocol

from unitylink.errors import ValueRangeError

_SBUS_BAUD = 100_000.0
_SBUS_CHANNELS = 16
_SBUS_PAUSE_S = 4e-3
_PPM_PULSE_S = 300e-6
_PPM_PAUSE_S = 5e-3


class _Pins(Protocol):
    def play(self, port: str, levels: Sequence[tuple[float, bool]], bit: int = 0) -> None: ...


class Radio:
    """Frames of a remote control, as its receiver sends them.

        radio = board.components["pilot"].radio()
        radio.send([1500.0] * 8)                   # a frame, and the pause behind it
        radio.send([1500.0] * 8, lost=True)        # S.Bus: the receiver repeats old values
        radio.send([1500.0] * 8, failsafe=True)    # S.Bus: it gives up

    Channels are in microseconds. Those of S.Bus that are not given are 1500.
    """

    def __init__(self, pins: _Pins, *, sbus: bool, inverted: bool) -> None:
        self._pins = pins
        self._sbus = sbus
        self.rests_high = inverted != sbus

    def send(
        self, channels_us: Sequence[float], *, lost: bool = False, failsafe: bool = False, switches: int = 0
    ) -> None:
        """Send a frame behind those that are still on their way."""
        if self._sbus:
            levels = _levels(sbus_frame(channels_us, lost=lost, failsafe=failsafe, switches=switches))
        else:
            levels = _pulses(channels_us)
        self._pins.play("line", [(at_s, level == self.rests_high) for at_s, level in levels])

    def silence(self, seconds: float) -> None:
        """Send nothing for so long."""
        self._pins.play("line", [(0.0, self.rests_high), (seconds, self.rests_high)])


def sbus_frame(
    channels_us: Sequence[float], *, lost: bool = False, failsafe: bool = False, switches: int = 0
) -> bytes:
    """Return the 25 bytes of a frame of S.Bus.

    >>> sbus_frame([987.5, 1500.0]).hex(" ", 5)
    '0fac001ff8 c0073ef081 0f7ce0031f f8c0073ef0 810f7c0000'

    Raises ValueRangeError for a channel that the protocol cannot say.
    """
    given = [*channels_us, *[1500.0] * (_SBUS_CHANNELS - len(channels_us))]
    values = [round((one - 880) * 8 / 5) for one in given]
    if len(values) > _SBUS_CHANNELS or not all(0 <= value < 1 << 11 for value in values):
        raise ValueRangeError("S.Bus has 16 channels of 880 to 2159 us: choose those")
    bits = sum(value << 11 * place for place, value in enumerate(values))
    flags = (switches & 3) | lost << 2 | failsafe << 3
    return bytes([0x0F, *bits.to_bytes(22, "little"), flags, 0])


def _levels(frame: bytes) -> Iterator[tuple[float, bool]]:
    """Give the levels of a line that rests high: 8E2."""
    bits = [
        level
        for byte in frame
        for data in [[bool(byte >> place & 1) for place in range(8)]]
        for level in (False, *data, sum(data) % 2 == 1, True, True)
    ]
    yield from ((place / _SBUS_BAUD, level) for place, level in enumerate(bits))
    yield len(bits) / _SBUS_BAUD + _SBUS_PAUSE_S, True


def _pulses(channels_us: Iterable[float]) -> Iterator[tuple[float, bool]]:
    """Give the pulses of PPM, as low ones."""
    at_s = 0.0
    for distance_s in (*(one * 1e-6 for one in channels_us), _PPM_PAUSE_S):
        yield at_s, False
        yield at_s + _PPM_PULSE_S, True
        at_s += distance_s
    yield at_s, True
