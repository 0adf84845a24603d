# SPDX-License-Identifier: BSD-3-Clause
"""The small engine in VHDL gives the bytes of the reference.

Some tests need time, which the reference does not have.
"""

from __future__ import annotations

import re
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest
from reference import dead_man_session
from reference.bus import Bus
from reference.dead_man_session import SAFE
from reference.device import ReferenceDevice
from reference.framing import Frame, field
from reference.host import EPOCH, ask, frames_of, opening, without_clock
from reference.scenario import Scenario
from reference.small_engine import small_settings

from tests.gateware.small_core import BAD, SILENCE, play
from unitylink import protocol as p
from unitylink_lab.conformance.chip import ChipPlayer

TICK = 5000  # clocks
LINE = 40  # clocks of a byte on the fastest line that the engine is made for
PAGE = Path(__file__).resolve().parents[2] / "docs" / "gateware" / "framed_small.md"


@pytest.mark.parametrize(
    "bench", ["byte_processor_tb", "framed_small_tb", "small_clock_tb", "small_publishing_tb"]
)
def test_bench(ghdl: Any, bench: str) -> None:
    ghdl.run(bench)


def test_the_processor_with_the_longer_program(ghdl: Any) -> None:
    ghdl.run("byte_processor_tb", length=2048)


def test_what_is_synthesised_does_the_same(ghdl: Any, tmp_path: Path) -> None:
    ghdl.run_netlist("framed_small", tmp_path)


@pytest.mark.parametrize(
    ("generics", "message"),
    [
        ({"window": 16}, "window is 16; it has places for 8"),
        ({"window": 6}, "window is 6; set it to a power of two"),
        ({"lists": True}, "set lists false, exchanges 0"),
        ({"publish_mode": 2, "groups": 7, "group_size": 5}, "groups is 7; it has room for 6"),
        (
            {"publish_mode": 2, "groups": 1, "group_size": 18},
            "group_size is 18; a group has room for 17 words of these widths",
        ),
        ({"publish_mode": 2, "groups": 1, "group_size": 5, "rate_bytes": 3}, "rate_bytes is 3; set it to 2"),
    ],
)
def test_what_it_does_not_have_is_refused(ghdl: Any, generics: dict[str, Any], message: str) -> None:
    ghdl.refuse("framed_small_tb", message, **generics)


def test_a_base_rate_above_the_clock_is_refused(ghdl: Any) -> None:
    ghdl.refuse("small_publishing_tb", "lower base_hz", base_hz=2000)


def test_a_program_of_another_length_is_refused(ghdl: Any) -> None:
    ghdl.refuse("byte_processor_tb", "a program has 1024 or 2048 instructions", length=512)


RUNS = [  # seed, window, generics
    (0, 8, {}),
    (1, 2, {"stall_percent": 30}),
    (2, 4, {"bus_stall_percent": 30}),
    (3, 8, {"byte_clocks": 40}),
    (4, 2, {"bus_waits": 3, "byte_clocks": 4}),
    (5, 8, {"fifo_words": 16, "stall_percent": 20}),
    *(pytest.param(seed, (8, 2, 4)[seed % 3], {}, marks=pytest.mark.long) for seed in range(6, 36)),
]


@pytest.mark.parametrize(("seed", "window", "generics"), RUNS)
def test_a_scenario(rtl: Any, seed: int, window: int, generics: dict[str, Any]) -> None:
    a, d = [(2, 4), (1, 4), (4, 4), (2, 2), (1, 1), (3, 4)][seed % 6]
    settings = small_settings(a, d, window, safe=SAFE)
    bad = dict.fromkeys(range(BAD, BAD + 4), p.REPLY_STATUS_BUS_ERROR)
    bad |= dict.fromkeys(range(BAD + 4, BAD + 8), p.REPLY_STATUS_BUS_TIMEOUT)
    reference = ReferenceDevice(settings, Bus(bad))
    steps = [step for step in Scenario(seed, settings, steps=15) if step]
    memory = [Frame(p.REQUEST_KIND_READ, field((n, 2), (n, a))).encode(EPOCH) for n in range(BAD)]
    expected = [reference.feed(step) for step in steps]
    again = [opening(reference.nonce + 1), b"".join(memory)]
    steps += again
    expected += [reference.feed(step) for step in again]
    answers = play(rtl, settings, steps, **generics)
    for number, (step, told) in enumerate(zip(steps, answers, strict=True)):
        assert without_clock(told) == without_clock(expected[number]), f"step {number}: {step.hex(' ')}"


@pytest.mark.long
@pytest.mark.parametrize(("seed", "window"), [(0, 8), (4, 2)])
def test_a_scenario_on_a_chip(seed: int, window: int) -> None:
    """The core is unpacked from a bitstream."""
    test_a_scenario(ChipPlayer(), seed, window, {})


def test_an_open_from_before_a_reset_opens_no_session(rtl: Any) -> None:
    """The nonce outlives the reset, so the first HELLO after it gets the second nonce."""
    hello, old_open, _ = opening().removeprefix(b"\0").split(b"\0")
    write = ask(p.REQUEST_KIND_WRITE, (0, 2), (0x10, 2), (7, 4))  # a write in the session before the reset
    steps = [opening(), ("reset", 3), b"\0" + hello + b"\0", old_open + b"\0" + write, opening(3, EPOCH + 1)]
    _, _, offered, late, opened = play(rtl, small_settings(), steps)
    assert [int.from_bytes(f.payload[1:3], "big") for f in frames_of(offered, p.FRAME_OPEN_EPOCH)] == [2]
    assert [f.kind for f in frames_of(late, p.FRAME_OPEN_EPOCH)] == [p.DEVICE_KIND_CLOSED]
    kinds = [f.kind for f in frames_of(opened, p.FRAME_OPEN_EPOCH)]
    assert kinds == [p.DEVICE_KIND_HELLO, p.DEVICE_KIND_OPEN]


def test_the_clock_counts_beyond_its_bits_in_hardware(rtl: Any) -> None:
    """The hardware counts 16 bits, and the program counts how often they wrap.

    `time_high` is frozen when `time_low` is read.
    """
    read = [ask(p.REQUEST_KIND_READ_CONTROL, (n, 2), (p.CONTROL_TIME_LOW, 2), (2, 1)) for n in range(3)]
    steps = [opening(), read[0], ("wait", 140_000), read[1], read[2]]
    answers = play(rtl, small_settings(), steps)
    asked = [clock for kind, clock, _ in rtl.times if kind == "i"][1:]
    told = [int.from_bytes(frames_of(answers[n])[0].payload[4:], "big") for n in (1, 3, 4)]
    low = [time >> 32 for time in told]
    assert [time & 0xFFFFFFFF for time in told] == [0, 0, 0]
    assert low[1] > 2 << 16
    for (one, another), (before, behind) in zip(pairwise(low), pairwise(asked), strict=True):
        assert abs((another - one) - (behind - before)) < 100


def test_the_dead_man_at_its_tick(rtl: Any) -> None:
    settings = small_settings(base_hz=50_000_000 // TICK, safe=SAFE)
    answers = play(rtl, settings, dead_man_session.steps(TICK, limit=4))
    late = figures_of_page()["read, last byte in to strobe"]  # the sign of life comes before the strobe
    dead_man_session.judge(answers, rtl.times, tick=TICK, limit=4, late=late + 10)


def test_a_host_that_reads_nothing_counts_as_alive_while_it_sends(rtl: Any) -> None:
    """While nobody takes a reply, frames wait in the ring. They still count as signs of life."""
    settings = small_settings(base_hz=50_000_000 // TICK, safe=SAFE)
    read = [ask(p.REQUEST_KIND_READ, (n, 2), (0x11, 2)) for n in range(1, 9)]
    steps: list[Any] = [
        opening(),
        ask(p.REQUEST_KIND_WRITE_CONTROL, (0, 2), (p.CONTROL_DEADMAN_TICKS, 2), (3, 4)),
        ("deaf", 1),
    ]
    for frame in read:
        steps += [("send", frame.decode("latin-1")), ("wait", 2 * TICK)]
    steps += [("wait", 3 * TICK), ("deaf", 0), ("quiet", SILENCE), opening(2)]
    play(rtl, settings, steps)
    said = [clock for kind, clock, _ in rtl.times if kind == "i"]
    tripped = [clock for kind, clock, _ in rtl.times if kind == "p"]
    assert len(tripped) == 1
    last = said[2 + len(read) - 1]
    assert last - said[2] > 4 * TICK, "it lives longer than a silence may be"
    assert 2 * TICK <= tripped[0] - last <= 3 * TICK + 1000


def test_an_overrun_of_the_line_is_counted(rtl: Any) -> None:
    ask_them = [
        ask(p.REQUEST_KIND_READ_CONTROL, (n, 2), (p.CONTROL_RECEIVE_OVERRUNS, 2), (1, 1)) for n in range(2)
    ]
    steps = [opening(), ("rx_error", 4), ask_them[0], ("rx_error", 3), ("rx_error", 4), ask_them[1]]
    answers = play(rtl, small_settings(), steps)
    told = [int.from_bytes(frames_of(answers[n])[0].payload[4:], "big") for n in (2, 5)]
    assert told == [1, 2], "parity and framing are no overruns"


def test_a_session_that_is_taken_over_trips_the_dead_man(rtl: Any) -> None:
    ticks = ask(p.REQUEST_KIND_WRITE_CONTROL, (0, 2), (p.CONTROL_DEADMAN_TICKS, 2), (1 << 30, 4))
    state = ask(p.REQUEST_KIND_READ_CONTROL, (0, 2), (p.CONTROL_DEADMAN_TICKS, 2), (2, 1))
    *_, told = play(rtl, small_settings(safe=SAFE), [opening(), ticks, opening(2), state])
    assert [frame.payload[4:].hex() for frame in frames_of(told)] == ["00000000" + "00000001"]
    assert [address for kind, _, address in rtl.times if kind == "u"] == [address for address, _ in SAFE]


def test_bus_errors_and_bus_timeouts_are_reported(rtl: Any) -> None:
    """Each request is executed once. A repeat gets the kept answer and makes no bus access."""
    error, silent = (BAD, 2), (BAD + 4, 2)
    requests = [
        ask(p.REQUEST_KIND_READ, (0, 2), error),
        ask(p.REQUEST_KIND_READ, (1, 2), silent),
        ask(p.REQUEST_KIND_WRITE, (2, 2), error, (7, 4)),
        ask(p.REQUEST_KIND_WRITE, (3, 2), silent, (7, 4)),
    ]
    posts = [
        ask(p.REQUEST_KIND_POST, (0, 2), silent, (7, 4)),
        ask(p.REQUEST_KIND_POST, (1, 2), error, (7, 4)),
    ]
    sync = ask(p.REQUEST_KIND_SYNC, (4, 2))
    counters = ask(p.REQUEST_KIND_READ_CONTROL, (5, 2), (p.CONTROL_POST_ERRORS, 2), (3, 1))
    steps = [opening(), b"".join(requests), b"".join(requests), b"".join(posts) + sync + counters]
    _, told, again, behind = play(rtl, small_settings(), steps)
    expected = [p.REPLY_STATUS_BUS_ERROR, p.REPLY_STATUS_BUS_TIMEOUT] * 2
    for answer in (told, again):
        assert [frame.kind - p.DEVICE_KIND_REPLY for frame in frames_of(answer)] == expected
    synced, counted = [frame.payload[4:].hex() for frame in frames_of(behind)]
    assert synced == field((2, 2), (2, 2), (0, 2), (p.REPLY_STATUS_BUS_TIMEOUT, 1)).hex()
    assert counted == field((2, 4), (3, 4), (3, 4)).hex(), "failed posts, errors, timeouts"
    assert len([1 for kind, _, _ in rtl.times if kind == "t"]) == 6


def test_replies_tell_truly_what_was_written_at_a_trip(rtl: Any) -> None:
    """At whatever clock it trips: what the replies say was written, was written.

    Then come the safe values.
    """
    tick, places = 1500, range(0x40, 0x43)  # two posts and a WRITE
    settings = small_settings(base_hz=50_000_000 // tick, safe=SAFE)
    steps: list[Any] = []
    for number in range(10):
        epoch = EPOCH + number

        def say(kind: int, *fields: tuple[int, int], epoch: int = epoch) -> bytes:
            return Frame(kind, field(*fields)).encode(epoch)

        arm = say(p.REQUEST_KIND_WRITE_CONTROL, (0, 2), (p.CONTROL_ARM, 2), (1, 4))
        start = say(p.REQUEST_KIND_WRITE_CONTROL, (1, 2), (p.CONTROL_DEADMAN_TICKS, 2), (1, 4))
        posts = [say(p.REQUEST_KIND_POST, (n, 2), (places[n], 2), (number, 4)) for n in range(2)]
        write = say(p.REQUEST_KIND_WRITE, (2, 2), (places[2], 2), (number, 4))
        steps += [opening(number + 1, epoch) + arm, ("wait", 149 * number)]
        steps += [start + b"".join(posts) + write, say(p.REQUEST_KIND_SYNC, (3, 2))]
    answers = play(rtl, settings, steps, bus_waits=4)
    values = [value & 0xFFFFFFFF for kind, _, value in rtl.times if kind == "v"]
    addresses = [address for kind, _, address in rtl.times if kind == "u"]
    made = list(zip(addresses, values, strict=True))
    seen = set()
    for number in range(10):
        started, *replies = frames_of(answers[4 * number + 2], EPOCH + number)
        assert started.kind == p.DEVICE_KIND_REPLY
        (sync,) = frames_of(answers[4 * number + 3], EPOCH + number)
        executed, failed = (int.from_bytes(sync.payload[at : at + 2], "big") for at in (4, 6))
        assert executed == 2
        told = [(at, number) for at in places[: 2 - failed]]
        told += [(places[2], number)] if replies[0].kind == p.DEVICE_KIND_REPLY else []
        assert [word for word in made if word[0] in places and word[1] == number] == told
        behind = made[made.index(told[-1]) + 1 :] if told else made
        assert not told or behind[:2] == list(SAFE), "the safe values come next"
        seen.add(len(told))
    assert len(seen) > 2, "it trips at different moments"


def test_posts_among_reads_are_all_executed_on_a_uart(rtl: Any) -> None:
    """The line is never too fast for the ring: nothing is lost, and all is executed in order."""
    count = 24
    posts = [ask(p.REQUEST_KIND_POST, (n, 2), (0x20, 2), (n, 4)) for n in range(count)]
    reads = [ask(p.REQUEST_KIND_READ, (n, 2), (0x20, 2)) for n in range(7)]
    mixed = [b"".join(posts[4 * n : 4 * n + 4]) + reads[n] for n in range(6)]
    sync = ask(p.REQUEST_KIND_SYNC, (6, 2))
    overruns = ask(p.REQUEST_KIND_READ_CONTROL, (7, 2), (p.CONTROL_RECEIVE_OVERRUNS, 2), (1, 1))
    steps = [opening(), b"".join(mixed) + sync + overruns]
    _, told = play(rtl, small_settings(), steps, physical="uart")
    *values, executed, lost = [frame.payload[4:].hex() for frame in frames_of(told)]
    assert values == [f"{4 * n + 3:08x}" for n in range(6)]
    assert executed[:4] == f"{count:04x}"
    assert lost == "00000000"


def test_a_full_ring_makes_the_line_wait(rtl: Any) -> None:
    """During a long reply there is room for 127 bytes. The rest comes when the reply has been sent."""
    reads = [ask(p.REQUEST_KIND_READ, (n, 2), (0x20, 2)) for n in range(8)]
    posts = [ask(p.REQUEST_KIND_POST, (n, 2), (0x20, 2), (n + 1, 4)) for n in range(12)]
    steps = [opening(), b"".join(reads[:2]) + b"".join(posts) + b"".join(reads[2:])]
    _, told = play(rtl, small_settings(), steps, byte_clocks=400)
    frames = frames_of(told)
    assert [frame.payload[:2].hex() for frame in frames] == [f"{n:04x}" for n in range(8)]
    assert [int.from_bytes(frame.payload[4:], "big") for frame in frames] == [0, 0, *[12] * 6]


def figures_of_page() -> dict[str, int]:
    page = PAGE.read_text(encoding="utf-8")
    return {row: int(value) for row, value in re.findall(r"^\| (\w.*?) \| (\d+) \|$", page, re.MULTILINE)}


def figures(rtl: Any) -> dict[str, int]:
    """Return the clocks with two address and four data bytes. Each way, a byte takes two clocks."""
    settings = small_settings()
    reads = [ask(p.REQUEST_KIND_READ, (n, 2), (0x20, 2)) for n in range(9)]
    play(rtl, settings, [opening(), reads[0], reads[1]])
    sent = [at for kind, at, _ in rtl.times if kind == "i"][-1]
    strobe = [at for kind, at, _ in rtl.times if kind == "t"][-1]
    bytes_out = [at for kind, at, _ in rtl.times if kind == "b" and at > sent]
    play(rtl, settings, [opening(), b"".join(reads)], byte_clocks=LINE)
    strobes = [at for kind, at, _ in rtl.times if kind == "t"]
    posts = [ask(p.REQUEST_KIND_POST, (n, 2), (0x20, 2), (0x12345678 + n, 4)) for n in range(9)]
    play(rtl, settings, [opening(), b"".join(posts)])
    writes = [at for kind, at, _ in rtl.times if kind == "t"]
    zeros = [ask(p.REQUEST_KIND_POST, (n, 2), (0, 2), (0, 4)) for n in range(9)]
    play(rtl, settings, [opening(), b"".join(zeros)])
    zeroed = [at for kind, at, _ in rtl.times if kind == "t"]
    short = [ask(p.REQUEST_KIND_POST, (n, 2), (0, 1), (0, 1)) for n in range(9)]
    play(rtl, small_settings(1, 1), [opening(), b"".join(short)])
    shortest = [at for kind, at, _ in rtl.times if kind == "t"]
    return {
        "read, last byte in to strobe": strobe - sent,
        "read, last byte in to first out": bytes_out[0] - sent,
        "period of reads, 40 clocks a byte out": max(b - a for a, b in pairwise(strobes[2:])),
        "period of posts": max(b - a for a, b in pairwise(writes[2:])),
        "period of posts of zeros": max(b - a for a, b in pairwise(zeroed[2:])),
        "period of posts of zeros, one address and data byte": max(b - a for a, b in pairwise(shortest[2:])),
    }


def test_figures_are_those_of_the_page(rtl: Any) -> None:
    told, page = figures(rtl), figures_of_page()
    assert {row: page[row] for row in told} == told
    post = len(ask(p.REQUEST_KIND_POST, (1, 2), (0, 2), (0, 4)))
    assert told["period of posts of zeros"] <= LINE * post, "posts are executed as fast as they arrive"
