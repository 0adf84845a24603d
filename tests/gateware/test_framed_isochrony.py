# SPDX-License-Identifier: BSD-3-Clause
"""From base strobe to first bus strobe in a framed session: the same time when idle, within the bound under
load.

`-s` prints the table of docs/gateware/isochrony.md with the measured values beside it.
"""

from __future__ import annotations

import re
from dataclasses import replace
from itertools import count
from pathlib import Path
from typing import Any

import pytest
from reference.framing import Frame, field

from tests.gateware.strobes import PUBLISHED, Watch
from unitylink import protocol as p
from unitylink.simulate import BoardConfiguration
from unitylink.spec.isochrony import framed, isochrony

EPOCH = 0x1234
# times between base strobes as parts of the bound, so that the load comes in other phases
PERIODS = (1.13, 1.37)
TICKS = 6
NEAR = 0.75  # the least share of the bound that the worst of so few strobes must reach
PAGE = Path(__file__).resolve().parents[2] / "docs" / "gateware" / "isochrony.md"


def gateware(address_bytes: int, data_bytes: int, byte_clocks: int) -> BoardConfiguration:
    return BoardConfiguration(
        address_bits=8 * address_bytes,
        data_bits=8 * data_bytes,
        groups=2,
        group_size=16,
        protocol="framed",
        baud_hz=0 if byte_clocks == 1 else 500_000_000 // byte_clocks,
    )


# Bytes of address and data, the most words of a request, clocks of a byte on the line, and the load that
# comes nearest to the bound: L a long reply, S a short one, F many to check, P the longest post.
CASES = {
    "16/32 bits": (2, 4, None, 1, "FP"),
    "16/32 bits, 10 clocks a byte": (2, 4, None, 10, "LSFP"),
    "8/8 bits, 10 clocks a byte": (1, 1, None, 10, "LSFP"),
    "16/32 bits, 40 clocks a byte, requests of 8 words": (2, 4, 8, 40, "LLSP"),
}


def ask(kind: int, *fields: tuple[int, int]) -> bytes:
    return Frame(kind, field(*fields)).encode(EPOCH)


class Host:
    """What a host sends: a session, a group that publishes at every strobe, and its load."""

    def __init__(self, configuration: BoardConfiguration, words: int | None) -> None:
        self.a, self.d = configuration.address_bits // 8, configuration.data_bits // 8
        self.words = 255 if words is None else words
        self.ids, self.posts = count(), count()

    def ask(self, kind: int, *fields: tuple[int, int]) -> bytes:
        return ask(kind, (next(self.ids) % 0x10000, 2), *fields)

    def opening(self) -> bytes:
        hello = Frame(p.REQUEST_KIND_HELLO, b"\1\1").encode()
        begin = Frame(p.REQUEST_KIND_OPEN, field((1, 2), (EPOCH, 2), (0, 1))).encode()
        group = ((0, 1), (1, 4), (0, 1), (1, 1), (PUBLISHED, self.a))
        return b"\0" + hello + begin + self.ask(p.REQUEST_KIND_DEFINE_GROUP, *group)

    def enable(self, on: bool) -> bytes:
        return self.ask(p.REQUEST_KIND_WRITE_CONTROL, (p.CONTROL_PUBLISH, 2), (on, 4))

    def message(self, letter: str) -> bytes:
        address = (0x20, self.a)
        told = min(self.words, (p.FRAMED_LATENCY_PAYLOAD_MAX - 6) // self.d)
        if letter == "L":
            one = (p.LIST_OPERATION_READ_UP, 1), (told, 1), address
            return self.ask(p.REQUEST_KIND_LIST, (0, 1), *one)
        if letter == "-":  # nothing but a border
            return b"\0"
        if letter == "S":
            return self.ask(p.REQUEST_KIND_READ, address)
        if letter == "F":
            read = (p.LIST_OPERATION_READ_UP, 1), (1, 1), address
            reads = min(told, (p.FRAMED_LATENCY_PAYLOAD_MAX - 3) // (2 + self.a))
            return self.ask(p.REQUEST_KIND_LIST, (0, 1), *read * reads)
        add = (p.LIST_OPERATION_ADD, 1), (1, 1), address, (1, self.d)
        adds = min(self.words, (p.FRAMED_LATENCY_PAYLOAD_MAX - 2) // (2 + self.a + self.d))
        return ask(p.REQUEST_KIND_POST_LIST, (next(self.posts) % 0x10000, 2), *add * adds)


def delays(
    watch: Watch, configuration: BoardConfiguration, host: Host, period: int, letters: str
) -> list[int]:
    """Return the clocks from each base strobe but the first to the first bus strobe of the publish."""
    told = replace(configuration, base_hz=configuration.clock_hz // period, baud_hz=0)
    opening, enable = host.opening(), host.enable(True)
    load = b"".join(map(host.message, letters)) + host.enable(False)
    sent = [opening, ("quiet", 700), enable, ("wait", 200), load, ("quiet", 700)]
    steps = [("send", step.decode("latin-1")) if isinstance(step, bytes) else step for step in sent]
    byte_clocks = max(1, configuration.byte_clocks)
    return watch.delays(told, steps, protocol="framed", byte_clocks=byte_clocks)


@pytest.fixture
def watch(rtl: Any, tmp_path: Path) -> Watch:
    return Watch(rtl, tmp_path)


@pytest.mark.parametrize(("address_bytes", "data_bytes"), [(2, 4), (1, 1), (4, 4)])
def test_idle_is_always_the_same(watch: Watch, address_bytes: int, data_bytes: int) -> None:
    configuration = gateware(address_bytes, data_bytes, 1)
    host = Host(configuration, None)
    found = delays(watch, configuration, host, 501, "-" * 501 * 20)
    assert len(found) >= 18
    assert set(found) == {isochrony(configuration).idle_clocks}


@pytest.mark.parametrize(
    "name",
    [pytest.param(n, marks=pytest.mark.long if n == "16/32 bits, 10 clocks a byte" else ()) for n in CASES],
)
def test_late_is_bounded_and_the_bound_is_near(watch: Watch, name: str) -> None:
    address_bytes, data_bytes, words, byte_clocks, letters = CASES[name]
    configuration = gateware(address_bytes, data_bytes, byte_clocks)
    result = isochrony(configuration, read_many=words)
    found: list[int] = []
    for part in PERIODS:
        period = round(part * result.late_clocks) + 100
        rounds = TICKS * period // result.late_clocks + 2  # each round takes nearly as long as the bound
        found += delays(watch, configuration, Host(configuration, words), period, letters * rounds)
    late = max(found) - result.idle_clocks
    print(
        f"\n| {name} | {result.idle_clocks} | {result.longest.name} | {result.late_clocks} | {late} measured"
    )
    assert min(found) >= result.idle_clocks
    assert late <= result.late_clocks
    assert late >= NEAR * result.late_clocks


def test_page_has_these_figures() -> None:
    rows = re.findall(
        r"^\| (.+?) \| (\d+) \| (\w+) \| (\d+) \| framed \|$", PAGE.read_text("utf-8"), re.MULTILINE
    )
    expected = []
    for name, (address_bytes, data_bytes, words, byte_clocks, _) in CASES.items():
        result = isochrony(gateware(address_bytes, data_bytes, byte_clocks), read_many=words)
        expected.append((name, str(result.idle_clocks), result.longest.name, str(result.late_clocks)))
    assert rows == expected


WORDS = 16  # words of a group: as many as the gateware allows
COUNTERS = p.CONTROL_DEADMAN_TRIPS - p.CONTROL_FRAMES + 1  # the longest answer about the device itself


def _costs(d: int = 4) -> dict[str, int]:
    """Return the longest times that are stated for 16-bit addresses and 32-bit data."""
    group = p.FRAMED_LATENCY_DEFINE_GROUP_ADDRESS + 4
    exchange = p.FRAMED_LATENCY_DEFINE_EXCHANGE_WORD + 4
    return {
        "DEFINE_GROUP": p.FRAMED_LATENCY_DEFINE_GROUP + 2 + WORDS * group,
        "DEFINE_EXCHANGE": p.FRAMED_LATENCY_DEFINE_EXCHANGE + WORDS * exchange,
        "publish": framed._publish(WORDS, d, 0).clocks,
    }


def test_constants_are_what_the_gateware_takes(rtl: Any) -> None:
    """These are the constants that no case above depends on.

    The gateware takes at most so long, and nearly so long.
    """
    configuration = replace(gateware(2, 4, 1), base_hz=50_000)
    host = Host(configuration, None)
    hello = b"\0" + Frame(p.REQUEST_KIND_HELLO, b"\1\1").encode()
    begin = Frame(p.REQUEST_KIND_OPEN, field((1, 2), (EPOCH, 2), (0, 1))).encode()
    members = [0x20 + n for n in range(WORDS)]
    first = ((1, 1), (1, 4), (0, 1), (WORDS, 1), *((at, 2) for at in members))
    second = ((0, 1), (1, 4), (0, 1), (1, 1), (PUBLISHED, 2))
    exchange = ((0, 1), (8, 1), (8, 1), *(f for at in members for f in ((at, 2), (4, 1))))
    requests = {
        "HELLO": hello,
        "OPEN": begin,
        "DEFINE_GROUP": host.ask(p.REQUEST_KIND_DEFINE_GROUP, *first),
        "DEFINE_EXCHANGE": host.ask(p.REQUEST_KIND_DEFINE_EXCHANGE, *exchange),
        "READ_CONTROL": host.ask(p.REQUEST_KIND_READ_CONTROL, (p.CONTROL_FRAMES, 2), (COUNTERS, 1)),
        "second": host.ask(p.REQUEST_KIND_DEFINE_GROUP, *second),
        "publish": host.enable(True),
    }
    steps = [step for one in requests.values() for step in (("send", one.decode("latin-1")), ("quiet", 400))]
    steps[-1] = ("wait", 3000)
    rtl(configuration, [steps], protocol="framed")
    came = dict(zip(requests, [at for kind, at, _ in rtl.times if kind == "i"], strict=True))
    left = [at for kind, at, _ in rtl.times if kind == "b"]
    took = {name: next(at for at in left if at > came[name]) - came[name] for name in requests}
    strobes = [(at, place) for kind, at, place in rtl.times if kind == "t"]
    starts = [at for at, place in strobes if place == members[0]]
    ends = [at for at, place in strobes if place == PUBLISHED]
    took["publish"] = max(next(end for end in ends if end > start) - start for start in starts[:-1])
    said = max(at for at in left if at < came["second"]) - came["READ_CONTROL"]  # it sends all the while
    assert said <= isochrony(configuration).late_clocks / 2, "not what the bound rests on"
    for name, most in _costs().items():
        print(f"{name}: {took[name]} of {most}")
        assert 0.9 * most <= took[name] <= most, name
