# SPDX-License-Identifier: BSD-3-Clause
"""The budget: byte counts are those on the wire, latencies are those of a simulated line."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from effort import many
from hypothesis import given, settings
from hypothesis import strategies as st

from unitylink.boards.flow import budgets_of
from unitylink.interface.engine import GROUPS, SMALL
from unitylink.layer0_driver import Driver
from unitylink.simulate import Board, BoardConfiguration
from unitylink.spec import compile_text, load
from unitylink.spec.isochrony import isochrony
from unitylink.spec.isochrony.budget import DeviceBudget, budget, publish_bytes
from unitylink.spec.isochrony.latency import BITS_PER_BYTE
from unitylink.spec.model import Device

EXAMPLES = Path(__file__).resolve().parents[3] / "examples"


def device(*groups: tuple[int, int]) -> Device:
    """Return a device with (words, divisor) groups of plain memory."""
    text = "public board() {\n"
    address = 0
    for words, divisor in groups:
        for _ in range(words):
            text += f"   @v{address} = 0x{address:X}: READ(PUBLISH(1,{divisor}));\n"
            address += 1
    spec = compile_text(text + "}", "board.ul").spec
    assert spec is not None
    return spec.devices[0]


@settings(max_examples=many(15))
@given(words=st.integers(1, 40), data_bytes=st.integers(1, 4), checked=st.booleans())
def test_bytes_are_those_on_the_wire(words: int, data_bytes: int, checked: bool) -> None:
    configuration = BoardConfiguration(data_bits=8 * data_bytes, group_size=64, groups=2)
    with Board(configuration=configuration) as board, Driver(board.url) as driver:
        enable = "EPC" if checked else "EPS"
        addresses = "".join(f"{address:02X}" for address in range(words))
        driver.send(f"#WSA:01{words:02X}{addresses}\n#WSR:010001\n#{enable}\n".encode())
        received, head = b"", b"&" if checked else b"%"
        while received.count(b"\n") < 5:
            received += driver.receive(timeout_s=5.0)
    publishes = [line for line in received.split(b"\n")[:-1] if line.startswith(head)]
    assert len(publishes) >= 2
    assert {len(line) + 1 for line in publishes} == {publish_bytes(words, 8 * data_bytes, checked)}


def test_the_walker_by_hand() -> None:
    (walker,) = load(EXAMPLES / "walker18" / "walker18.ul").devices
    (framed,) = budget(walker).groups
    assert (framed.words, framed.message_bytes, framed.rate_hz) == (18, 13 + 18 * 4, 100.0)
    one = budget(walker, baud_hz=921_600, protocol="classic")
    (group,) = one.groups
    assert (group.words, group.message_bytes, group.rate_hz) == (18, 10 + 18 * 8, 100.0)
    assert one.tick_bytes == 154 and one.bytes_per_s == 15_400
    assert one.load == pytest.approx(15_400 * 10 / 921_600)
    slow = next(baud for baud in one.bauds if baud.baud_hz == 115_200)
    assert slow.load > 1 and slow.highest_hz == pytest.approx(1000 / 14)  # a publish takes 13.4 ms
    assert one.fits_2012
    assert not budget(device((32, 10))).fits_2012
    assert budget(device((1, 1))).groups[0].latency_s is None, "no baud rate is known"


def replayed(one: DeviceBudget, order: list[int], blocked_s: float) -> list[float]:
    """Serve groups when they are due, behind a message of `blocked_s`.

    If several are due, `order` says which goes first. Return the worst delay of each.
    """
    byte_s = BITS_PER_BYTE / (one.baud_hz or 1)
    due = [(1 / g.rate_hz * n, number) for number, g in enumerate(one.groups) if g.rate_hz for n in range(40)]
    worst = [0.0] * len(one.groups)
    now = blocked_s
    waiting = sorted(due)
    while waiting:
        ready = [item for item in waiting if item[0] <= now + 1e-12]
        if not ready:
            now = waiting[0][0]
            continue
        item = min(ready, key=lambda entry: (order.index(entry[1]), entry[0]))
        waiting.remove(item)
        now += one.groups[item[1]].message_bytes * byte_s
        worst[item[1]] = max(worst[item[1]], now - item[0])
    return worst


@settings(max_examples=many(60))
@given(
    groups=st.lists(
        st.tuples(st.integers(1, 12), st.integers(1, 20)), min_size=1, max_size=4, unique_by=lambda g: g[1]
    ),
    baud_hz=st.sampled_from([230_400, 921_600, 3_000_000]),
    data=st.data(),
)
def test_no_order_of_service_is_later_than_the_bound(
    groups: list[tuple[int, int]], baud_hz: int, data: st.DataObject
) -> None:
    protocol = data.draw(st.sampled_from(["framed", "classic"]))
    one = budget(device(*groups), baud_hz=baud_hz, read_many=8, protocol=protocol)
    order = data.draw(st.permutations(range(len(one.groups))))
    # the head of #S_RM: or LIST, and eight words
    reply = 6 + 2 * 8 * 4 if protocol == "classic" else 6 + 8 * 4 + 6
    blocked_s = reply * BITS_PER_BYTE / baud_hz
    for group, late_s in zip(one.groups, replayed(one, order, blocked_s), strict=True):
        if group.latency_s is not None:
            assert late_s <= group.latency_s + 1e-9


@given(
    st.lists(
        st.tuples(st.integers(1, 40), st.integers(1, 50)), min_size=1, max_size=4, unique_by=lambda g: g[1]
    )
)
def test_the_highest_rate_fits_and_the_next_does_not(groups: list[tuple[int, int]]) -> None:
    one = budget(device(*groups))
    for baud in one.bauds:
        assert baud.load == pytest.approx(one.bytes_per_s * 10 / baud.baud_hz)
        assert baud.highest_hz is not None
        divisor = round(one.base_hz / baud.highest_hz)
        assert one.tick_bytes * 10 * baud.highest_hz <= baud.baud_hz * (1 + 1e-9)
        assert divisor == 1 or one.tick_bytes * 10 * one.base_hz / (divisor - 1) > baud.baud_hz


def test_a_line_that_is_too_slow_has_no_bound() -> None:
    one = budget(device((40, 1)), baud_hz=115_200)
    assert one.load is not None and one.load > 1 and one.groups[0].latency_s is None
    assert not math.isnan(one.bytes_per_s)


def test_sampling_is_bounded_by_the_isochrony_of_the_gateware() -> None:
    """A single group waits as long as isochrony() says, and then needs its time on the line."""
    link = "link l (ADDRESS=8, BAUD=1000000);\n"
    spec = compile_text(link + "public board() { @x = 0x0: READ(PUBLISH(10 Hz)); }", "board.ul").spec
    assert spec is not None
    (group,) = budget(spec.devices[0], read_many=8, protocol="classic").groups
    gateware = BoardConfiguration(baud_hz=1_000_000, rate_bytes=4)
    bound = isochrony(gateware, read_many=8, protocol="classic").bound_clocks
    assert group.sampled_s == pytest.approx(bound / gateware.clock_hz)
    assert group.latency_s is not None
    assert group.latency_s == pytest.approx(group.sampled_s + (18 + 16) * 10e-6 + 8 / gateware.clock_hz)
    (long,) = budget(spec.devices[0], read_many=100, protocol="classic").groups
    (longest,) = budget(spec.devices[0], protocol="classic").groups
    assert long.latency_s is not None and longest.latency_s is not None
    assert longest.latency_s - long.latency_s == pytest.approx((255 - 100) * 8 * 10e-6, rel=1e-3)


@pytest.mark.parametrize("clock_hz", [12_000_000, 50_000_000])
def test_the_bound_follows_the_protocol_and_the_clock(clock_hz: int) -> None:
    link = "link l (ADDRESS=8, BAUD=1000000);\n"
    spec = compile_text(link + "public board() { @x = 0x0: READ(PUBLISH(10 Hz)); }", "board.ul").spec
    assert spec is not None
    one = budget(spec.devices[0], read_many=8, clock_hz=clock_hz)
    gateware = BoardConfiguration(baud_hz=1_000_000, clock_hz=clock_hz)
    bound = isochrony(gateware, read_many=8)
    assert (one.protocol, one.clock_hz) == ("framed", clock_hz)
    assert one.groups[0].sampled_s == pytest.approx(bound.bound_clocks / clock_hz)
    assert bound.longest.name == "LIST" and bound.late_s > 2 * (6 + 8 * 4 + 6) * 10e-6 - 100 / clock_hz


@pytest.mark.parametrize("engine", ["fast", "small"])
def test_the_bound_follows_the_engine_of_the_design(engine: str) -> None:
    text = "public board() { @x = 0x0: READ(PUBLISH(10 Hz)); }"
    spec = compile_text("link l (ADDRESS=8, BAUD=1000000);\n" + text, "board.ul").spec
    said = compile_text(f"link l (ADDRESS=8, BAUD=1000000, ENGINE={engine});\n" + text, "board.ul").spec
    assert spec is not None and said is not None
    one = budget(spec.devices[0], engine=engine)
    assert one.groups == budget(said.devices[0]).groups
    small = {**SMALL, **GROUPS, "group_size": 11} if engine == "small" else {"protocol": "framed"}
    design = BoardConfiguration(**{"baud_hz": 1_000_000, "engine": engine, **small})
    assert budgets_of(spec, design, 50_000_000, 1_000_000) == [one]
    assert (one.groups == budget(spec.devices[0]).groups) == (engine == "fast")


def test_a_group_that_is_longer_than_a_frame_comes_as_several() -> None:
    (group,) = budget(device((70, 10))).groups
    assert group.message_bytes == (13 + 60 * 4) + (13 + 10 * 4)
    assert budget(device((70, 10)), protocol="classic").groups[0].message_bytes == 10 + 70 * 8


def test_events_wait_for_each_other_and_requests_have_their_turns() -> None:
    text = "link l (BAUD=1000000);\npublic board() {\n"
    text += "".join(f"@v{n} = 0x{n}: READ(PUBLISH(on e{n}));\n" for n in range(8))
    spec = compile_text(text + "}", "board.ul").spec
    assert spec is not None
    groups = budget(spec.devices[0], read_many=100, protocol="classic").groups
    assert len(groups) == 8 and len({group.latency_s for group in groups}) == 1
    assert groups[0].latency_s is not None
    replies = 3 * (6 + 800) * 10e-6  # one has begun, and two get their turns among eight publishes
    assert groups[0].latency_s > replies + 8 * 18 * 10e-6


@pytest.mark.parametrize("baud_hz", [1, 10, 300, 9_600])
def test_a_line_that_is_far_too_slow_is_reported_and_breaks_nothing(baud_hz: int) -> None:
    text = f"link l (BAUD={baud_hz});\npublic b() {{\n@a = 0x0: READ(PUBLISH(on e));\n"
    text += "@b = 0x1: READ(PUBLISH(1 Hz));\n@c = 0x2: READ(PUBLISH(100 Hz));\n}"
    result = compile_text(text, "b.ul")
    assert [d.code for d in result.diagnostics] == ["UL104"]
