# SPDX-License-Identifier: BSD-3-Clause
"""What the core publishes over time equals what the twin publishes: contents, numbers and ticks."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import replace
from typing import Any

import pytest

from unitylink._native import Device
from unitylink.tools.conformance_bench import bench, play_on_twin

PERIODS = 30
CONFIGURATION = bench({"FREQ": 50000, "SG": 2, "SW": 3})
PERIOD = CONFIGURATION.clock_hz // CONFIGURATION.base_hz
SETTINGS = "#WSA:0003101112\n#WSR:000001\n#WSA:010120\n#WSR:010002\n#WSA:02084041424344454647\n#WSR:020005\n"


def publishes(timed: list[tuple[int, int]]) -> dict[str, list[int]]:
    """The clocks of the heads of each publish, by its text."""
    found: dict[str, list[int]] = defaultdict(list)
    line, start = "", 0
    for at, byte in timed:
        start = start if line else at
        line += chr(byte)
        if byte == 10:
            if line[0] in "%&":
                found[line].append(start)
            line = ""
    return found


@pytest.mark.parametrize("enable", ["#EPS\n", "#EPC\n"], ids=["plain", "checked"])
def test_ticks_and_contents(rtl: Any, enable: str) -> None:
    steps = [("send", SETTINGS), ("quiet", 200), ("send", enable), ("wait", PERIODS * PERIOD - PERIOD // 2)]
    rtl(CONFIGURATION, [steps])
    core = publishes([(at, byte) for kind, at, byte in rtl.times if kind == "b"])

    device = Device(CONFIGURATION)
    play: list[tuple[int, int]] = []
    for kind, argument in steps:
        if kind == "send":
            assert device.receive(argument.encode()) == len(argument)
            device.run_until(device.clock + 1000)
        elif kind == "wait":
            device.run_until(device.clock + argument - 1000)
        play += device.take_timed()
    twin = publishes([(at, byte) for at, byte in play])

    assert set(core) == set(twin)
    assert [len(heads) for heads in core.values()] == [PERIODS, PERIODS // 2, PERIODS // 5]
    for text in core:
        # The first tick is the first head of all; the others follow their ticks by that much, give or take
        # the messages before them: less than half a period.
        ticks = []
        for side in (core, twin):
            start = min(min(heads) for heads in side.values())
            ticks.append([round((at - start) / PERIOD) for at in side[text]])
        assert ticks[0] == ticks[1], text


def test_events_by_edge_and_level(rtl: Any) -> None:
    configuration = bench({"SG": 2, "IRQEDGE": 0b1010})
    steps: list[tuple[str, Any]] = [
        ("send", "".join(f"#WSA:0{group}01{16 + group:02x}\n" for group in range(4)) + "#WIC:0007\n#EPS\n"),
        ("quiet", 200),
    ]
    for mask in (0b0010, 0, 0b1000, 0, 0b0001, 0, 0b0110, 0b0100, 0):
        steps += [("events", mask), ("wait", 5), ("events", 0), ("quiet", 200)]
    expected, got = play_on_twin(configuration, [steps])[0], rtl(configuration, [steps])[0]
    assert set(got.splitlines()) == set(expected.splitlines())
    assert got.count(b"%PUB:01") == expected.count(b"%PUB:01") == 2
    assert b"%PUB:03" not in got


def test_256_groups(rtl: Any) -> None:
    """The most the protocol can name: 256 groups (a count of 00) of 255 addresses, a mask of 32 bytes."""
    configuration = bench({"SG": 8, "SW": 7})
    configuration = replace(configuration, group_size=255)
    addresses = "".join(f"{(7 * n) % 128:02x}" for n in range(255))
    exchanges: list[list[tuple[str, Any]]] = [
        [("send", text), ("quiet", 2000)]
        for text in (
            "#RLC\n",
            f"#WSA:ffff{addresses}\n",
            "#WSA:80020102\n",
            "#RSI:ff\n",
            "#RSI:80\n",
            "#RSI:7f\n",
            "#WIC:80" + "00" * 31 + "\n",
            "#RIC\n",
            "#WSR:ff0001\n#WSR:800001\n",
            "#EPS\n",
        )
    ]
    exchanges[-1].append(("quiet", 3000))
    expected, got = play_on_twin(configuration, exchanges), rtl(configuration, exchanges)
    assert got == expected
    assert got[0] == b"#CNF:01,04,20,02,03e8,00,ff,02\n"
    assert got[7] == b"#S_RIC:80" + b"00" * 31 + b"\n"
    assert got[9].count(b"%PUB:ffff") == 1
