# SPDX-License-Identifier: BSD-3-Clause
"""The core with the framed protocol gives the reference's bytes.

Some tests need time, which the reference does not have.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
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
from reference.scenario import Scenario, under_a_used_id
from reference.settings import Settings

from unitylink import protocol as p
from unitylink.interface.board_configuration import BoardConfiguration
from unitylink_lab.conformance.chip import ChipPlayer

BAD = 0x38  # four addresses answer with an error, and the next four do not answer
TICK = 500  # clocks
PAGE = Path(__file__).resolve().parents[2] / "docs" / "gateware" / "framed.md"


def play(rtl: Any, settings: Settings, steps: Sequence[Any], **generics: Any) -> list[bytes]:
    """Return what the core answers to each step.

    A step is bytes, sent until all is quiet, or a step of the bench.
    """
    configuration = BoardConfiguration(
        address_bits=8 * settings.a,
        data_bits=8 * settings.d,
        base_hz=settings.base_hz,
        groups=settings.groups,
        group_size=settings.group_size,
    )
    exchanges = [
        [("send", step.decode("latin-1")), ("quiet", 700)] if isinstance(step, bytes) else [step]
        for step in steps
    ]
    own = {
        "protocol": "both",
        "exchanges": settings.exchanges,
        "window": settings.window,
        "bad_base": BAD,
    }
    answers: list[bytes] = rtl(configuration, exchanges, **{**own, **generics})
    return answers


def reference_of(settings: Settings) -> ReferenceDevice:
    bad = dict.fromkeys(range(BAD, BAD + 4), p.REPLY_STATUS_BUS_ERROR)
    bad |= dict.fromkeys(range(BAD + 4, BAD + 8), p.REPLY_STATUS_BUS_TIMEOUT)
    return ReferenceDevice(settings, Bus(bad))


REGISTERS = 6  # addresses from 0 on, of a slave that freezes its words while the bus is held

RUNS = [  # seed, window, generics
    (0, 8, {}),
    (1, 2, {"stall_percent": 30}),
    (2, 32, {"bus_stall_percent": 30}),
    (3, 8, {"protocol": "framed"}),
    (4, 2, {"bus_waits": 3, "byte_clocks": 4}),
    (5, 32, {"fifo_words": 16, "stall_percent": 20}),
    (6, 128, {}),
    (7, 2, {"protocol": "framed", "stall_percent": 10}),
    *((seed, 8, {"registers": REGISTERS}) for seed in (8, 9)),
    *(pytest.param(seed, 8, {"registers": REGISTERS}, marks=pytest.mark.long) for seed in (10, 11)),
]


@pytest.mark.parametrize(("seed", "window", "generics"), RUNS)
def test_a_scenario(rtl: Any, seed: int, window: int, generics: dict[str, Any]) -> None:
    a, d = [(2, 4), (1, 4), (4, 4), (2, 2), (1, 1), (3, 4)][seed % 6]
    framed_alone = generics.get("protocol") == "framed"
    settings = Settings(a, d, window=window, features=0x1E if framed_alone else 0x1F, safe=SAFE)
    reference = reference_of(settings)
    # There are few addresses, so that lists come back to words that they have written.
    addresses = REGISTERS if "registers" in generics else 64
    steps = [step for step in Scenario(seed, settings, addresses=addresses) if step]
    memory = [Frame(p.REQUEST_KIND_READ, field((n, 2), (n, a))).encode(EPOCH) for n in range(BAD)]
    expected = [reference.feed(step) for step in steps]
    again = [opening(reference.nonce + 1), b"".join(memory)]
    steps += again
    expected += [reference.feed(step) for step in again]
    answers = play(rtl, settings, steps, **generics)
    for number, (step, told) in enumerate(zip(steps, answers, strict=True)):
        assert without_clock(told) == without_clock(expected[number]), f"step {number}: {step.hex(' ')}"


@pytest.mark.long
@pytest.mark.parametrize(("seed", "window"), [(3, 8), (7, 2)])
def test_a_scenario_on_a_chip(seed: int, window: int) -> None:
    """The core is unpacked from a bitstream. With both protocols it does not fit."""
    test_a_scenario(ChipPlayer(), seed, window, {"protocol": "framed"})


def test_an_id_that_was_another_requests(rtl: Any) -> None:
    settings = Settings(window=2)
    reference = reference_of(settings)
    steps = [opening(), *under_a_used_id(settings, EPOCH)]
    expected = [reference.feed(step) for step in steps]
    assert [without_clock(answer) for answer in play(rtl, settings, steps)] == [
        without_clock(answer) for answer in expected
    ]


def test_an_open_from_before_a_reset_opens_no_session(rtl: Any) -> None:
    """The nonce outlives the reset, so the first HELLO after it gets another nonce than before."""
    settings = Settings(window=8)
    hello, old_open, _ = opening().removeprefix(b"\0").split(b"\0")
    new = opening(3, EPOCH + 1)
    write = ask(p.REQUEST_KIND_WRITE, (0, 2), (0x10, 2), (7, 4))  # a write in the session before the reset
    steps = [opening(), ("reset", 3), b"\0" + hello + b"\0", old_open + b"\0" + write, new]
    _, _, offered, late, opened = play(rtl, settings, steps)
    assert [int.from_bytes(f.payload[1:3], "big") for f in frames_of(offered, p.FRAME_OPEN_EPOCH)] == [2]
    assert [f.kind for f in frames_of(late, p.FRAME_OPEN_EPOCH)] == [p.DEVICE_KIND_CLOSED]
    assert [f.kind for f in frames_of(opened, p.FRAME_OPEN_EPOCH)] == [
        p.DEVICE_KIND_HELLO,
        p.DEVICE_KIND_OPEN,
    ]


def list_of(reads: int, writes: int) -> bytes:
    """Return a LIST of scattered words, with 2 address bytes and 4 data bytes."""
    written = [((0x10 + n, 2), (n, 4)) for n in range(writes)]
    told = (
        [(p.LIST_OPERATION_WRITE, 1), (writes, 1), *(f for word in written for f in word)] if writes else []
    )
    asked = [(p.LIST_OPERATION_READ, 1), (reads, 1), *((0x10 + n, 2) for n in range(reads))] if reads else []
    return ask(p.REQUEST_KIND_LIST, (0, 2), (0, 1), *told, *asked)


def list_figures(rtl: Any) -> dict[str, int]:
    settings = Settings(window=32)

    def wait(reads: int, writes: int) -> int:
        play(rtl, settings, [opening(), list_of(reads, writes)])
        sent = max(at for kind, at, _ in rtl.times if kind == "i")
        return min(at for kind, at, _ in rtl.times if kind == "b" and at > sent) - sent

    read, written = wait(18, 0) - wait(8, 0), wait(0, 18) - wait(0, 8)
    assert read % 10 == written % 10 == 0
    return {
        "list, each word read": read // 10,
        "list, each word written": written // 10,
        "list of 18 reads and 18 writes, last byte in to first out": wait(18, 18),
    }


def figures(rtl: Any, address_bytes: int) -> dict[str, int]:
    settings = Settings(a=address_bytes, window=32)
    reads = [ask(p.REQUEST_KIND_READ, (n, 2), (0x20, address_bytes)) for n in range(21)]
    play(rtl, settings, [opening(), reads[0]])
    sent = max(at for kind, at, _ in rtl.times if kind == "i")
    latency = min(at for kind, at, _ in rtl.times if kind == "b" and at > sent) - sent
    whole = max(at for kind, at, _ in rtl.times if kind == "b") - sent
    play(rtl, settings, [opening(), b"".join(reads)])
    strobes = [at for kind, at, _ in rtl.times if kind == "t"]
    (period,) = {later - earlier for earlier, later in pairwise(strobes[4:])}
    posts = [ask(p.REQUEST_KIND_POST, (n, 2), (0x20, address_bytes), (n, 4)) for n in range(20)]
    play(rtl, settings, [opening(), b"".join(posts)])
    strobes = [at for kind, at, _ in rtl.times if kind == "t"]
    post = max(later - earlier for earlier, later in pairwise(strobes[4:]))
    return {
        "read, last byte in to first out": latency,
        "read, last byte in to last out": whole,
        "period of pipelined reads": period,
        "period of posts": post,
    }


def publish_figures(rtl: Any) -> dict[str, int]:
    settings = Settings(base_hz=50_000_000 // TICK, groups=1)
    words = tuple((0x20 + n, 2) for n in range(8))
    steps = [
        opening(),
        ask(p.REQUEST_KIND_DEFINE_GROUP, (0, 2), (0, 1), (1, 4), (0, 1), (8, 1), *words),
        ask(p.REQUEST_KIND_WRITE_CONTROL, (1, 2), (p.CONTROL_PUBLISH, 2), (1, 4))[:-1],
        ("send", "\0"),
        ("wait", 2 * TICK),
    ]
    play(rtl, settings, steps)
    strobes = [at for kind, at, _ in rtl.times if kind == "t"][-8:]
    (word,) = {later - earlier for earlier, later in pairwise(strobes)}
    sent = [at for kind, at, _ in rtl.times if kind == "b"][-32:]  # of the last payload
    (byte,) = {later - earlier for earlier, later in pairwise(sent)}
    return {"publish, each word read": word, "publish, each byte sent": byte}


def test_figures_are_those_of_the_page_and_in_budget(rtl: Any) -> None:
    told = figures(rtl, 2) | list_figures(rtl) | publish_figures(rtl)
    page = PAGE.read_text(encoding="utf-8")
    assert {
        row: int(value) for row, value in re.findall(r"^\| (\w.*?) \| (\d+) \|$", page, re.MULTILINE)
    } == told
    assert told["read, last byte in to first out"] <= 14
    assert told["period of pipelined reads"] <= 20
    assert told["list, each word read"] <= 8, "as the classic read-many"
    assert told["list, each word written"] <= 9
    assert told["publish, each word read"] <= 9
    assert told["publish, each byte sent"] == 1
    assert told["period of posts"] <= len(ask(p.REQUEST_KIND_POST, (1, 2), (0x20, 2), (1, 4)))


def test_publishes_carry_sequence_and_clock(rtl: Any) -> None:
    settings = Settings(base_hz=50_000_000 // TICK, groups=2)
    define = ((0, 2), (1, 1), (2, 4), (1, 1), (2, 1), (0x10, 2), (0x11, 2))
    steps = [
        opening(),
        ask(p.REQUEST_KIND_WRITE, (0x7F, 2), (0x10, 2), (0xAABBCCDD, 4)),
        ask(p.REQUEST_KIND_DEFINE_GROUP, *define),
        b"".join([ask(p.REQUEST_KIND_WRITE_CONTROL, (1, 2), (p.CONTROL_PUBLISH, 2), (1, 4))]),
        ("wait", 4 * TICK),
        ("events", 2),
        ("wait", TICK),
        ("events", 0),
        ask(p.REQUEST_KIND_WRITE_CONTROL, (2, 2), (p.CONTROL_PUBLISH, 2), (0, 4)),
        ("wait", 4 * TICK),
        ask(p.REQUEST_KIND_READ_CONTROL, (3, 2), (p.CONTROL_PUBLISHES, 2), (1, 1)),
    ]
    answers = play(rtl, settings, steps, edge_events=2)
    published = [f.payload for f in frames_of(b"".join(answers[3:-2])) if f.kind == p.DEVICE_KIND_PUBLISH]
    assert [payload[:3] for payload in published] == [field((1, 1), (n, 2)) for n in range(len(published))]
    assert {payload[7:] for payload in published} == {bytes.fromhex("aabbccdd00000000")}
    clocks = [int.from_bytes(payload[3:7], "big") for payload in published]
    steps_of_clock = [later - earlier for earlier, later in pairwise(clocks)]
    assert sum(1 for step in steps_of_clock if step % (2 * TICK) != 0) in (1, 2), (
        "the event's, between two ticks"
    )
    assert steps_of_clock[0] == 2 * TICK
    assert frames_of(answers[-2]) == []
    (told,) = frames_of(answers[-1])
    assert int.from_bytes(told.payload[4:], "big") == len(published)


def test_a_group_that_is_due_again_too_soon_is_counted(rtl: Any) -> None:
    settings = Settings(base_hz=50_000_000 // TICK, groups=1)
    words = tuple((0x20 + n, 2) for n in range(16))
    steps = [
        opening(),
        ask(p.REQUEST_KIND_DEFINE_GROUP, (0, 2), (0, 1), (1, 4), (0, 1), (16, 1), *words),
        ask(p.REQUEST_KIND_WRITE_CONTROL, (1, 2), (p.CONTROL_PUBLISH, 2), (1, 4))[:-1],
        ("send", "\0"),
        ("wait", 20 * TICK),
        ("send", ask(p.REQUEST_KIND_WRITE_CONTROL, (2, 2), (p.CONTROL_PUBLISH, 2), (0, 4)).decode("latin-1")),
        ("quiet", 4 * TICK),
        ask(p.REQUEST_KIND_READ_CONTROL, (3, 2), (p.CONTROL_PUBLISHES, 2), (2, 1)),
    ]
    answers = play(rtl, settings, steps, byte_clocks=16)  # on its line, a publish takes longer than two ticks
    published = [f for f in frames_of(b"".join(answers[2:-1])) if f.kind == p.DEVICE_KIND_PUBLISH]
    (told,) = frames_of(answers[-1])
    counts = [int.from_bytes(told.payload[start : start + 4], "big") for start in (4, 8)]
    assert counts[0] == len(published)
    assert counts[1] >= 5
    clocks = [int.from_bytes(frame.payload[3:7], "big") for frame in published]
    assert abs(sum(counts) - (clocks[-1] - clocks[0]) / TICK) <= 4, "every tick published, or was counted"


def test_the_dead_man_at_its_tick(rtl: Any) -> None:
    settings = Settings(base_hz=50_000_000 // TICK, safe=SAFE)
    answers = play(rtl, settings, dead_man_session.steps(TICK, limit=8))
    dead_man_session.judge(answers, rtl.times, tick=TICK, limit=8, late=40)


def test_what_is_left_out_is_invalid(rtl: Any) -> None:
    settings = Settings(groups=2, exchanges=0)
    kinds = (
        p.REQUEST_KIND_LIST,
        p.REQUEST_KIND_EXCHANGE,
        p.REQUEST_KIND_DEFINE_GROUP,
        p.REQUEST_KIND_DEFINE_EXCHANGE,
    )
    steps = [
        opening(),
        *(ask(kind, (0, 2), (0, 1), (1, 1), (1, 1), (0x20, 2)) for kind in kinds),
        ask(p.REQUEST_KIND_POST_LIST, (0, 2), (0x11, 1), (1, 1), (0x20, 2), (1, 4)),
        *(
            ask(p.REQUEST_KIND_WRITE_CONTROL, (0, 2), (register, 2), (1, 4))
            for register in (p.CONTROL_PUBLISH, p.CONTROL_ARM, p.CONTROL_DEADMAN_TICKS)
        ),
        ask(p.REQUEST_KIND_READ_CONTROL, (0, 2), (p.CONTROL_FEATURES, 2), (1, 1)),
        ask(p.REQUEST_KIND_POST, (0, 2), (0x20, 2), (7, 4)) + ask(p.REQUEST_KIND_READ, (1, 2), (0x20, 2)),
        ask(p.REQUEST_KIND_SYNC, (2, 2)),
    ]
    answers = play(rtl, settings, steps, protocol="framed", lists=False, deadman=False, publish_mode=0)
    shown = [[(frame.kind - 0xC0, frame.payload.hex()) for frame in frames_of(answer)] for answer in answers]
    assert shown[1:5] == [[(p.REPLY_STATUS_INVALID, "00000000")]] * 4
    assert shown[5] == []
    assert shown[6:9] == [[(p.REPLY_STATUS_BAD_ADDRESS, "00000000")]] * 3
    assert shown[9] == [(0, "00000000" + "00000000")]
    assert shown[10] == [(0, "00010001" + "00000007")]
    assert shown[11] == [(0, "00020001" + "0001" + "0000" + "0000" + "00")]


def test_a_session_locks_the_classic_side(rtl: Any) -> None:
    steps = [
        b"#W:001000000007\n",
        opening(),
        b"#R:0010\n\0",
        b"#W:001000000008\n\0",
        b"#EPS\n\0",
        b"#WSA:00010010\n\0",
        ask(p.REQUEST_KIND_READ, (0, 2), (0x10, 2)),
        ask(p.REQUEST_KIND_CLOSE, (1, 2)),
        b"#W:001000000008\n\0",
        b"#EPS\n",
        ask(p.REQUEST_KIND_READ, (2, 2), (0x10, 2)),
        b"#R:00\0",
        b"#R:0010\n",
    ]
    answers = play(rtl, Settings(), steps)
    assert answers[0] == b"#S_W\n"
    assert answers[2:6] == [b"#S_R:00000007\n", b"#?E_FBW\n", b"#?E_ICC\n", b"#?E_ICC\n"]
    assert frames_of(answers[6]) == [Frame(p.DEVICE_KIND_REPLY, field((0, 2), (0, 2), (7, 4)))]
    assert answers[8:10] == [b"#S_W\n", b"#S_EPS\n"]
    assert answers[10] == b"", "no border before it: the classic side's, which skips it"
    assert answers[11:] == [b"?f3\n", b"#S_R:00000008\n"]


def test_overruns_of_the_line_are_counted_and_not_reported_in_a_session(rtl: Any) -> None:
    read = ask(p.REQUEST_KIND_READ_CONTROL, (0, 2), (p.CONTROL_RECEIVE_OVERRUNS, 2), (1, 1))
    answers = play(
        rtl, Settings(), [opening(), ("rx_error", 4), ("wait", 50), ("rx_error", 4), ("wait", 50), read]
    )
    assert answers[1:5] == [b""] * 4
    assert [frame.payload[4:] for frame in frames_of(answers[5])] == [field((2, 4))]


def test_time_goes_on_and_its_upper_half_waits(rtl: Any) -> None:
    read = (p.CONTROL_TIME_LOW, 2), (2, 1)
    first, then = (ask(p.REQUEST_KIND_READ_CONTROL, (n, 2), *read) for n in range(2))
    answers = play(rtl, Settings(), [opening(), first, ("wait", 1000), then])
    times = [int.from_bytes(frames_of(answer)[0].payload[4:8], "big") for answer in (answers[1], answers[3])]
    assert 1000 < times[1] - times[0] < 3000
    assert {frames_of(answer)[0].payload[8:] for answer in (answers[1], answers[3])} == {bytes(4)}
