# SPDX-License-Identifier: BSD-3-Clause
"""Engineering values, and every kind of access: which words are sent for each, and which never are."""

from __future__ import annotations

import asyncio
import math
import struct
from collections.abc import Iterator
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from unitylink import Link
from unitylink.errors import BindingError, DeviceMismatch, UnexpectedValue, ValueRangeError
from unitylink.layer3_hardware import DoubleBufferProxy, MemoryProxy
from unitylink.layer4_data import (
    ClearValue,
    Node,
    Publisher,
    PulseValue,
    ReadClearValue,
    ReadValue,
    ReadWriteValue,
    Recording,
    Tree,
    ValueGroup,
    WriteValue,
    load_spec_objects,
)
from unitylink.simulate import Board, BoardConfiguration
from unitylink.spec import compile_text
from unitylink.spec.model import Publish
from unitylink.spec.types import EnumType, EnumValue, Field, ValueType
from unitylink.values import Quantity

ANGLE = Quantity(ValueType("int", 16), scale=0.001, unit="rad", minimum=-math.pi, maximum=math.pi)
DOUBLE = Quantity(ValueType("float", 64))
MODE = ValueType("enum", 2, enum=EnumType("mode", 2, (EnumValue("idle", 0), EnumValue("run", 1))))
FLAGS = ValueType(
    "bits", 2, fields=(Field("hot", ValueType("bool", 1), 0, 0), Field("low", ValueType("bool", 1), 1, 1))
)


def robot(fake: ModuleType, **options: Any) -> tuple[Any, Node]:
    """Return a node with one value of each kind, from address 0x10 on."""
    link = fake.FakeLink(configuration=fake.Configuration(**options))
    where = dict(
        zip(["angle", "target", "mode", "count", "flags", "reset", "time"], range(0x10, 0x17), strict=True)
    )
    node = Node(Tree(link, addresses=where), "robot")
    node._read("angle", quantity=ANGLE, publish=(1, 10))
    node._write("target", quantity=Quantity(ANGLE.type, scale=0.001, unit="rad", initial=0.5, safe=0.0))
    node._read_write("mode", quantity=Quantity(MODE, initial=1))
    node._read_clear("count")
    node._clear("flags", quantity=Quantity(FLAGS))
    node._pulse("reset", quantity=Quantity(ValueType("bool", 1)))
    node._read("time", quantity=DOUBLE, words=2)
    return link, node


def test_reads_and_writes_in_engineering_units(fake: ModuleType) -> None:
    link, node = robot(fake)
    angle, target = node["angle"], node["target"]
    assert isinstance(angle, ReadValue) and isinstance(target, WriteValue)
    link.bus.words[0x10] = 0xFFFF_FC18
    assert angle.read() == -1.0 == angle.latest and angle.raw == 0xFFFF_FC18 and "-1 rad" in repr(angle)
    assert asyncio.run(angle.read_async()) == -1.0
    target.write(1.2345678)
    assert (link.bus.words[0x11], target.latest, target.raw) == (1235, 1.235, 1235)
    assert (target.unit, round(target.maximum, 3), angle.minimum) == ("rad", 32.767, -math.pi)
    with pytest.raises(
        ValueRangeError, match=r"^target: 40 rad is not in -32.768 to 32.767 rad; nothing was sent"
    ):
        ValueGroup([target]).write([40])
    assert [entry for entry in link.log if entry[0] == "W"] == [("W", 0x11, 1235)]


def test_a_value_of_several_words_is_never_torn(fake: ModuleType) -> None:
    link, node = robot(fake, read_many=4)
    time_s = node["time"]
    assert isinstance(time_s, ReadValue)
    low, high = struct.unpack("<II", struct.pack("<d", 12.5))
    link.bus.words |= {0x16: low, 0x17: high}
    assert time_s.read() == 12.5 and link.log[-1] == ("RM", 0x16, 0x17)
    assert asyncio.run(time_s.read_async()) == 12.5
    with pytest.raises(
        DeviceMismatch, match=r"robot: 4 values of 5 words do not fit one atomic read of 4 words"
    ):
        node.snapshot()
    snapshot = node.snapshot(consistent=False)
    assert snapshot["time"] == 12.5 and link.log[-2:] == [("RM", 0x10, 0x12, 0x14), ("RM", 0x16, 0x17)]
    both = ReadWriteValue("both", MemoryProxy(link), 0x20, quantity=DOUBLE)
    both.write(-0.25)
    assert [entry[1] for entry in link.log[-2:]] == [0x20, 0x21] and both.read() == -0.25


def test_a_board_of_another_width_is_refused(fake: ModuleType) -> None:
    with pytest.raises(
        BindingError, match=r"time takes 2 word\(s\) in the spec and 4 on fake:, whose words have 16"
    ):
        robot(fake, data_bytes=2)


def test_what_reading_changes_is_only_read_by_name(fake: ModuleType) -> None:
    link, node = robot(fake)
    assert set(node.snapshot()) == {"angle", "mode", "flags", "time"}
    assert all(address != 0x13 for _, address, _ in link.repeats)
    count = node["count"]
    assert isinstance(count, ReadClearValue)
    link.bus.words[0x13] = 7
    assert count.read() == 7 and ValueGroup([count]).snapshot()["count"] == 7
    assert [repeat for _, address, repeat in link.repeats if address == 0x13] == [False, False]


def test_strobes_and_flags(fake: ModuleType) -> None:
    link, node = robot(fake)
    reset, flags = node["reset"], node["flags"]
    assert isinstance(reset, PulseValue) and isinstance(flags, ClearValue)
    reset.pulse()
    assert link.log[-1] == ("W", 0x15, 1) and link.repeats[-1] == ("W", 0x15, False)
    with pytest.raises(ValueRangeError, match="flags: no value was read yet"):
        flags.clear()
    link.bus.words[0x14] = 0b10
    assert (flags.read().hot, flags.read().low) == (False, True)
    flags.clear()
    assert link.log[-1] == ("W", 0x14, 0b10) and link.repeats[-1] == ("W", 0x14, False)
    flags.clear({"hot": True, "low": False})
    assert link.log[-1] == ("W", 0x14, 0b01)
    buffered = DoubleBufferProxy(fake.FakeLink(fake.DoubleBufferModel(4)), size=4)
    with pytest.raises(BindingError, match="reset is a PULSE, but double buffer writes all words again"):
        PulseValue("reset", buffered, 1)


def test_initial_and_safe_values_are_written_on_request(fake: ModuleType) -> None:
    link, node = robot(fake)
    assert not link.log
    node.apply_initial()
    assert link.log == [("W", 0x11, 500), ("W", 0x12, 1)]
    node.apply_safe()
    assert link.log[2:] == [("W", 0x11, 0)]


def test_enumerations(fake: ModuleType) -> None:
    link, node = robot(fake)
    mode = node["mode"]
    assert isinstance(mode, ReadWriteValue)
    mode.write("run")  # type: ignore[arg-type]
    assert mode.read().name == "run"
    link.bus.words[0x12] = 3
    with pytest.raises(UnexpectedValue, match=r"^mode: the device holds 3, which is no mode"):
        mode.read()
    with pytest.raises(UnexpectedValue, match=r"^mode: "):
        node.snapshot()


def test_publishes_bring_engineering_values(fake: ModuleType) -> None:
    link = fake.FakeLink()
    memory, publisher = MemoryProxy(link), Publisher()
    angle = ReadValue[float]("angle", memory, 1, quantity=ANGLE, publish=(1, 10), publisher=publisher)
    time_s = ReadValue[float]("time", memory, 2, quantity=DOUBLE, publish=(1, 10), publisher=publisher)
    mode = ReadValue[Any]("mode", memory, 4, quantity=Quantity(MODE), publish=(1, 10), publisher=publisher)
    seen: list[float] = []
    with publisher.running(), Recording(publisher) as recording:
        assert link.subscriptions[0].addresses == (1, 2, 3, 4)
        angle.on_publish(lambda _, value: seen.append(value))
        low, high = struct.unpack("<II", struct.pack("<d", 0.1))
        for word in (250, 0xFF06):
            link.bus.words |= {1: word, 2: low, 3: high, 4: 1}
            link.publish()
        link.bus.words[4] = 2  # no mode has this number
        link.publish()
        assert publisher.reports()[0].lost == 1
    assert seen == [0.25, -0.25] and time_s.latest == 0.1 and mode.latest.name == "run"
    assert recording.series("angle")[1].tolist() == [0.25, -0.25]
    assert recording.series("time")[1].tolist() == [0.1, 0.1]
    assert recording.series("mode")[1].dtype == np.int64


def test_values_of_several_words_stay_in_one_group(fake: ModuleType) -> None:
    link = fake.FakeLink(configuration=fake.Configuration(group_size=4))
    publisher = Publisher()
    for n in range(4):
        ReadValue(f"v{n}", MemoryProxy(link), 2 * n, quantity=DOUBLE, publish=(1, 10), publisher=publisher)
    publisher.start()
    assert [item.addresses for item in link.subscriptions] == [(0, 1), (2, 3), (4, 5), (6, 7)]
    publisher.stop()


def test_an_event_publishes_through_its_own_line() -> None:
    """On the twin, a rate may be in any group. An event must be in the group with its line."""
    board = Board(configuration=BoardConfiguration(groups=4, edge_events=(2,)))
    with board, Link(f"{board.url}?timeout=10") as link:
        memory, publisher = MemoryProxy(link), Publisher()
        on_event = Publish(1, 0, trigger="event", event="limit")
        hit = ReadValue[int]("hit", memory, 5, publish=on_event, line=2, publisher=publisher)
        ReadValue("pos", memory, 6, publish=(1, 100), publisher=publisher)
        board.registers[5] = 77
        with publisher.running():
            subscriptions = [report.rate_hz for report in publisher.reports()]
            assert subscriptions == [0.0, 10.0]
            import threading

            came = threading.Event()
            hit.on_publish(lambda *_: came.set())
            board.event(2)
            assert came.wait(5) and hit.latest == 77
        too_far = ReadValue("far", memory, 7, publish=on_event, line=9, publisher=Publisher())
        with pytest.raises(DeviceMismatch, match="group 9 is asked for, and this gateware has 4"):
            too_far.publisher.start()


PACKED = """
enum mode: u2 { idle = 0; run = 1; }
bits state: u64 { mode: mode @ 1..0; level: u4 @ 7..4 (MIN=2, MAX=5); gain: f32 @ 63..32; }
public lamp() {
   @plain = 0x10: state WRITE(); @both = 0x12: state READWRITE(); @go = 0x14: state PULSE();
   @seen = 0x16: state W1C();
}
"""
NOT_PACKED = {
    "no member": 0x23,
    "beyond its limits": 0xF0,
    "not a number": 0x7FC0_0000_0000_0020,
    "infinite": 0x7F80_0000_0000_0020,
    "too long": 1 << 64,
    "negative": -1,
    "a field that is no number": {"mode": 0, "level": 3, "gain": math.nan},
    "a field that is infinite": {"mode": 0, "level": 3, "gain": -math.inf},
    "a field that is too large for 32 bits": {"mode": 0, "level": 3, "gain": 1e308},
}


@pytest.fixture(scope="module")
def packed() -> Iterator[tuple[Link, Node]]:
    spec = compile_text(PACKED).spec
    with Board(spec) as board, Link(f"{board.url}?timeout=5") as link:
        yield link, load_spec_objects(spec, link)


@pytest.mark.parametrize("name", NOT_PACKED)
def test_invalid_packed_values_are_refused_before_anything_is_sent(
    name: str, packed: tuple[Link, Node]
) -> None:
    link, lamp = packed
    value = NOT_PACKED[name]
    group = ValueGroup([lamp["plain"], lamp["both"]])
    whole = {"mode": "run", "level": 3, "gain": 1.0}
    with group.cycle() as cycle:
        before = link.statistics().requests
        for write in (
            lambda: lamp["plain"].write(value),
            lambda: lamp["both"].write(value),
            lambda: asyncio.run(lamp["plain"].write_async(value)),
            lambda: lamp["go"].pulse(value),
            lambda: lamp["seen"].clear(value),
            lambda: group.write({"both": whole, "plain": value}),
            lambda: asyncio.run(group.write_async({"both": whole, "plain": value})),
            lambda: cycle({"both": whole, "plain": value}),
        ):
            with pytest.raises(ValueRangeError):
                write()
        assert link.statistics().requests == before


def test_valid_packed_values_are_written_unchanged(packed: tuple[Link, Node]) -> None:
    link, lamp = packed
    lamp["plain"].write(0x3F80_0000_0000_0021)
    assert link.read_many([0x10, 0x11]).tolist() == [0x21, 0x3F80_0000]
