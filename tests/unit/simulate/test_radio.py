# SPDX-License-Identifier: BSD-3-Clause
"""The frames of a radio: known bytes, the levels of both protocols, and channels that do not exist."""

from __future__ import annotations

from collections.abc import Sequence

import pytest

from unitylink.errors import ValueRangeError
from unitylink.simulate.radio import Radio, sbus_frame


class Line:
    def __init__(self) -> None:
        self.levels: list[tuple[float, bool]] = []

    def play(self, port: str, levels: Sequence[tuple[float, bool]], bit: int = 0) -> None:
        assert (port, bit) == ("line", 0)
        self.levels = list(levels)


def test_a_known_frame() -> None:
    frame = sbus_frame([987.5, 1500.0, 2011.875, *[1520.0] * 13])
    known = "0F AC 00 DF C4 01 08 40 00 02 10 80 00 04 20 00 01 08 40 00 02 10 80 00 00"
    assert frame == bytes.fromhex(known)
    assert sbus_frame([], lost=True)[23] == 4 and sbus_frame([], failsafe=True, switches=3)[23] == 11


@pytest.mark.parametrize("channels", [[879.0], [2160.0], [1500.0] * 17])
def test_channels_that_do_not_exist_are_refused(channels: list[float]) -> None:
    with pytest.raises(ValueRangeError, match="16 channels of 880 to 2159 us"):
        sbus_frame(channels)


@pytest.mark.parametrize("inverted", [False, True])
def test_the_line_of_sbus(inverted: bool) -> None:
    line = Line()
    radio = Radio(line, sbus=True, inverted=inverted)
    assert radio.rests_high is not inverted
    radio.send([1500.0])
    assert line.levels[-1] == (pytest.approx(7e-3), radio.rests_high)
    first = [level == radio.rests_high for _, level in line.levels[:12]]
    assert first == [False, True, True, True, True, False, False, False, False, False, True, True]


@pytest.mark.parametrize("inverted", [False, True])
def test_the_line_of_ppm(inverted: bool) -> None:
    line = Line()
    radio = Radio(line, sbus=False, inverted=inverted)
    radio.send([1000.0, 2000.0])
    assert [at for at, level in line.levels if level != radio.rests_high] == pytest.approx([0, 1e-3, 3e-3])
    radio.silence(0.1)
    assert line.levels == [(0.0, radio.rests_high), (0.1, radio.rests_high)]
