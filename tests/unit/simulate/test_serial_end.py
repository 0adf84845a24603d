# SPDX-License-Identifier: BSD-3-Clause
"""The far end of a serial line: parity, rates, and characters that are broken or not yet whole."""

from __future__ import annotations

from collections.abc import Sequence

import pytest

from unitylink.simulate.serial_end import SerialEnd


class Wire:
    """What one end plays is what the other end sees, a second later."""

    def __init__(self) -> None:
        self.levels: list[tuple[float, bool]] = []
        self.now_s = 0.0
        self.level = True

    def play(self, port: str, levels: Sequence[tuple[float, bool]], bit: int = 0) -> None:
        assert (port, bit) == ("rx", 0)
        self.levels += [(self.now_s + at_s, level) for at_s, level in levels]

    def edges(self, port: str, bit: int = 0) -> list[tuple[float, bool]]:
        assert (port, bit) == ("tx", 0)
        found = []
        for at_s, level in self.levels:
            if level != self.level and at_s <= self.now_s:
                found.append((at_s, level))
                self.level = level
        self.levels = [one for one in self.levels if one[0] > self.now_s]
        return found

    def time_s(self) -> float:
        return self.now_s


@pytest.mark.parametrize(("parity", "stop_bits"), [(0, 1), (1, 1), (2, 2)])
def test_what_is_sent_is_heard(parity: int, stop_bits: int) -> None:
    wire = Wire()
    end = SerialEnd(wire, 1000.0, parity, stop_bits)
    data = bytes([0x00, 0xFF, 0x55, 0xAA, 0x01, 0x80])
    end.send(data)
    wire.now_s = 1.0
    assert end.take() == data
    assert end.take() == b"" and end.broken == 0


def test_a_frame_that_has_not_ended_waits() -> None:
    wire = Wire()
    end = SerialEnd(wire, 1000.0)
    end.send(b"\xff\xff")
    wire.now_s = 0.0105  # all further bits are high, but the second byte has only begun
    first = end.take()
    wire.now_s = 0.1
    assert (first, end.take()) == (b"\xff", b"\xff")


def test_a_wrong_rate_and_a_wrong_parity_are_counted() -> None:
    wire = Wire()
    end = SerialEnd(wire, 1000.0, parity=1)
    SerialEnd(wire, 1000.0, parity=2).send(b"\x01\x03")
    wire.now_s = 1.0
    assert (end.take(), end.broken) == (b"", 2)
