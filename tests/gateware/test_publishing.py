# SPDX-License-Identifier: BSD-3-Clause
"""Over time, the core publishes the same as the twin: contents, numbers and ticks."""

from __future__ import annotations

import random
from collections import defaultdict
from dataclasses import replace
from typing import Any

import pytest

from unitylink._native import Device
from unitylink_lab.conformance.bench import bench, play_on_twin

PERIODS = 30
CONFIGURATION = bench({"FREQ": 50000, "SG": 2, "SW": 3})
PERIOD = CONFIGURATION.clock_hz // CONFIGURATION.base_hz
ANSWERED = 1000  # clocks; longer than a request takes on the twin


def publishes(timed: list[tuple[int, int]]) -> dict[str, list[int]]:
    """Return, for each publish by its text, the clocks at which its head was sent."""
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


Steps = list[tuple[str, Any]]


def random_steps(seed: int) -> tuple[Steps, list[int]]:
    """Return steps and the rates of four groups.

    The rates are random, and requests come while the groups publish.
    """
    r = random.Random(seed)
    rates = [r.choice((1, 2, 3, 5, 7, 11)) for _ in range(4)]
    settings = ""
    for group, rate in enumerate(rates):
        addresses = r.randbytes(r.randint(1, 8)).hex().replace("e", "4").replace("f", "5")
        settings += f"#WSA:{group:02x}{len(addresses) // 2:02x}{addresses}\n#WSR:{group:02x}{rate:04x}\n"
    steps: Steps = [("send", settings), ("quiet", 200), ("send", r.choice(("#EPS\n", "#EPC\n")))]
    waits = [PERIODS * PERIOD // 9 + r.randint(-200, 200) for _ in range(8)]
    for wait in waits:
        steps += [("wait", wait), ("send", f"#R:{r.randrange(0x60):02x}\n")]
    return [*steps, ("wait", PERIODS * PERIOD - PERIOD // 2 - sum(waits))], rates


def ticks_and_replies(timed: list[tuple[int, int]]) -> tuple[dict[str, list[int]], list[str]]:
    """Return, for each publish by its text, the base strobes to which it belongs. Return the replies, too.

    The first head of all marks the first strobe. Each other head follows its strobe by the same time, except
    that messages before it may delay it, by less than half a period.
    """
    heads = publishes(timed)
    start = min(min(clocks) for clocks in heads.values())
    text = "".join(chr(byte) for _, byte in timed)
    replies = [line for line in text.splitlines() if line[0] not in "%&"]
    return {line: [round((at - start) / PERIOD) for at in clocks] for line, clocks in heads.items()}, replies


@pytest.mark.parametrize("seed", range(6))
def test_ticks_and_contents(rtl: Any, seed: int) -> None:
    configuration = replace(CONFIGURATION, publish_mode=1 + seed % 2)
    steps, rates = random_steps(seed)
    rtl(configuration, [steps])
    core = ticks_and_replies([(at, byte) for kind, at, byte in rtl.times if kind == "b"])

    device = Device(configuration)
    play: list[tuple[int, int]] = []
    for kind, argument in steps:
        if kind == "send":
            assert device.receive(argument.encode()) == len(argument)
            device.run_until(device.clock + ANSWERED)
        elif kind == "wait":
            device.run_until(device.clock + argument - ANSWERED)
        play += device.take_timed()
    twin = ticks_and_replies([(at, byte) for at, byte in play])

    assert core == twin
    counts = {int(text[5:7], 16): len(ticks) for text, ticks in core[0].items()}
    assert counts == {group: PERIODS // rate for group, rate in enumerate(rates)}


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
    """The most that the protocol can name: 256 groups (a count of 00) of 255 addresses, and a mask of 32
    bytes.
    """
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
