# SPDX-License-Identifier: BSD-3-Clause
"""Whatever arguments layers 3 and 4 get, a wrong one gives an error of this library, and nothing is sent."""

from __future__ import annotations

import asyncio
import inspect
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from effort import many
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from unitylink import Link
from unitylink.errors import AssignmentError, UnityLinkError, UnknownName, ValueRangeError
from unitylink.layer3_hardware import DoubleBufferProxy, FifoProxy, MemoryProxy, TosNetProxy
from unitylink.layer4_data import (
    ClearValue,
    Cycle,
    DeadMen,
    Node,
    PulseValue,
    ReadClearValue,
    ReadValue,
    ReadWriteValue,
    ValueGroup,
    WriteValue,
    load_spec_objects,
)
from unitylink.simulate import Board
from unitylink.spec import Spec, load

TYPED = Path(__file__).parents[1] / "generate" / "typed.ul"
JUNK: list[Any] = [
    *(None, "", "x", "3", b"3", 1.5, -1, 10**5000, -(2**70), math.nan, math.inf, -math.inf, True, 1j),
    *(np.int64(3), np.float32(2.5), np.bool_(True), np.array([1, 2]), np.array(3), np.array([math.nan])),
    *([], [1, "x"], (1,), {}, {"a": 1}, {1: 2}, object(), [None], lambda: None),
]
ANY = st.one_of(
    st.integers(),
    st.floats(),
    st.text(max_size=3),
    st.binary(max_size=3),
    st.lists(st.one_of(st.integers(), st.floats(), st.text(max_size=2)), max_size=4),
)
Call = Callable[[Any, Any], object]


def on(proxy: str, call: Call) -> Call:
    """Return a function that calls a proxy of the rig."""
    return lambda rig, x: call(getattr(rig, proxy), x)


@dataclass
class Rig:
    """Everything that can be called, on a twin."""

    spec: Spec
    link: Link
    board: Board

    def __post_init__(self) -> None:
        self.robot: Any = load_spec_objects(self.spec, self.link)
        self.read = self.robot.j[0].pos
        self.write = self.robot.j[0].target
        self.packed = self.robot.flags
        self.group = self.robot.all
        self.cycle = ValueGroup([self.write, self.robot.gain]).cycle()
        self.memory = MemoryProxy(self.link, 0x40)
        self.fifo = FifoProxy(self.link, 0x40)
        self.double = DoubleBufferProxy(self.link, 0x40, size=4)
        self.tosnet = TosNetProxy(self.link, 0x40)


@pytest.fixture(scope="module")
def rig() -> Iterator[Rig]:
    spec = load(TYPED)
    with Board(spec) as board, Link(f"{board.url}?timeout=2&attempts=1") as link:
        rig = Rig(spec, link, board)
        yield rig
        rig.robot.stop_publishing()


class NoLink(Link):
    """A link for calls that would disturb the other tests."""

    def __init__(self) -> None:
        """Open nothing."""

    def set_dead_man(self, silence_s: float, *, timeout_s: float | None = None) -> None:
        assert 0 <= silence_s < math.inf


def done(coroutine: Any) -> Any:
    return asyncio.run(coroutine)


def patience(x: Any) -> Any:
    """Shorten a wait in which a number means hours."""
    return 0.001 if isinstance(x, (int, float)) and not isinstance(x, bool) and 0.001 < x < 1e9 else x


def taken_back(make: Callable[[Any, Any], Callable[[], None]]) -> Call:
    return lambda rig, x: make(rig, x)()


CALLS: dict[str, Call] = {
    "ReadValue.read": lambda r, x: r.read.read(timeout_s=patience(x)),
    "ReadValue.read_async": lambda r, x: done(r.read.read_async(timeout_s=patience(x))),
    "ReadValue.on_publish": taken_back(lambda r, x: r.robot.level.on_publish(print, rate_hz=x)),
    "ReadValue.on_publish callback": taken_back(lambda r, x: r.read.on_publish(x)),
    "ReadValue.on_change": taken_back(lambda r, x: r.robot.level.on_change(x, rate_hz=10)),
    "ReadValue.publishes": lambda r, x: r.robot.level.publishes(rate_hz=x),
    "WriteValue.write": lambda r, x: r.write.write(x),
    "WriteValue.write timeout": lambda r, x: r.write.write(0, timeout_s=patience(x)),
    "WriteValue.write_async": lambda r, x: done(r.write.write_async(x)),
    "WriteValue.encode": lambda r, x: r.write.encode(x),
    "ReadWriteValue.write": lambda r, x: r.robot.gain.write(x),
    "ReadWriteValue.write enumeration": lambda r, x: r.robot.j[0].mode.write(x),
    "WriteValue.write fixed": lambda r, x: r.robot.j[0].torque.write(x),
    "PulseValue.pulse": lambda r, x: r.robot.reset.pulse(x),
    "ClearValue.clear": lambda r, x: r.packed.clear(x),
    "ReadClearValue.read": lambda r, x: r.robot.lost.read(timeout_s=patience(x)),
    "ValueGroup": lambda r, x: ValueGroup(x),
    "ValueGroup.write": lambda r, x: r.group.write(x),
    "ValueGroup.write one": lambda r, x: r.group.write([0, x, 0]),
    "ValueGroup.write named": lambda r, x: r.group.write({"j[0].target": x}),
    "ValueGroup.write_async": lambda r, x: done(r.group.write_async(x)),
    "ValueGroup.snapshot": lambda r, x: ValueGroup([r.read]).snapshot(timeout_s=patience(x)),
    "ValueGroup.snapshot_async": lambda r, x: done(
        ValueGroup([r.read]).snapshot_async(timeout_s=patience(x))
    ),
    "ValueGroup.on_publish": taken_back(
        lambda r, x: ValueGroup([r.robot.level]).on_publish(print, rate_hz=x)
    ),
    "ValueGroup.on_change": taken_back(lambda r, x: ValueGroup([r.read]).on_change(x)),
    "ValueGroup.publishes": lambda r, x: ValueGroup([r.robot.level]).publishes(rate_hz=x),
    "ValueGroup.__getitem__": lambda r, x: r.group[x],
    "ValueGroup.__setitem__": lambda r, x: r.group.__setitem__("j[0].target", x),
    "ValueGroup.chosen": lambda r, x: r.group.chosen(x, {}),
    "Cycle.__call__": lambda r, x: r.cycle(x),
    "Node.__getitem__": lambda r, x: r.robot[x],
    "Node.__setitem__": lambda r, x: r.robot.__setitem__("word", x),
    "Node.__setattr__": lambda r, x: setattr(r.robot, "word", x),
    "Node.snapshot": lambda r, x: r.robot.snapshot(consistent=False, timeout_s=patience(x)),
    "Node.apply_initial": lambda r, x: r.robot.apply_initial(timeout_s=patience(x)),
    "Node.apply_safe": lambda r, x: r.robot.apply_safe(timeout_s=patience(x)),
    "Node.on_publish": taken_back(lambda r, x: r.robot.j[0].on_publish(x)),
    "Node.on_change": taken_back(lambda r, x: r.robot.j[0].on_change(x)),
    "DeadMen.start": lambda r, x: DeadMen((NoLink(),)).start(x),
    "load_spec_objects root": lambda r, x: load_spec_objects(r.spec, r.link, root=x),
    "load_spec_objects links": lambda r, x: load_spec_objects(r.spec, r.link, links=x),
    "MemoryProxy": lambda r, x: MemoryProxy(r.link, x),
    "DoubleBufferProxy": lambda r, x: DoubleBufferProxy(r.link, 0, size=x),
    "DoubleBufferProxy.commits": lambda r, x: r.double.commits(),
    "FifoProxy.pop": lambda r, x: r.fifo.pop(timeout_s=patience(x)),
    "FifoProxy.pop_many": lambda r, x: r.fifo.pop_many(x),
    "FifoProxy.push": lambda r, x: r.fifo.push(x),
    "FifoProxy.push_many": lambda r, x: r.fifo.push_many(x),
    "FifoProxy.status": lambda r, x: r.fifo.status(),
    "TosNetProxy.node": lambda r, x: r.tosnet.node(x),
    "TosNetProxy.node register": lambda r, x: r.tosnet.node(1).register(x),
    "TosNetProxy.node words": lambda r, x: r.tosnet.node(1).register(1).outputs[x],
    "TosNetProxy.node words set": lambda r, x: r.tosnet.node(1).register(1).inputs.__setitem__(0, x),
    "TosNetProxy.async_send": lambda r, x: r.tosnet.async_send(x, b"a", timeout_s=0.001),
    "TosNetProxy.async_send data": lambda r, x: r.tosnet.async_send(1, x, timeout_s=0.001),
    "TosNetProxy.async_send timeout": lambda r, x: r.tosnet.async_send(1, b"a", timeout_s=patience(x)),
    "TosNetProxy.async_receive": lambda r, x: r.tosnet.async_receive(),
    "TosNetProxy.status": lambda r, x: r.tosnet.status(),
    "TosNetProxy.counters": lambda r, x: r.tosnet.counters(),
    "TosNetProxy.nodes": lambda r, x: r.tosnet.nodes(),
    "TosNetProxy.check_nodes": lambda r, x: r.tosnet.check_nodes(x),
    "TosNetProxy.watch": lambda r, x: r.tosnet.watch(x).look(),
    "TosNetProxy.on_event": taken_back(lambda r, x: r.tosnet.on_event(x)),
    "TosNetProxy.on_event nodes": taken_back(lambda r, x: r.tosnet.on_event(print, nodes=x)),
    "TosNetProxy.on_event period": taken_back(lambda r, x: r.tosnet.on_event(print, period_s=x)),
    "DoubleBufferProxy.commit": lambda r, x: r.double.commit(timeout_s=patience(x)),
}
for proxy, kind in (
    ("memory", "MemoryProxy"),
    ("fifo", "FifoProxy"),
    ("double", "DoubleBufferProxy"),
    ("tosnet", "TosNetProxy"),
):
    CALLS |= {
        f"{kind}.{name}": on(proxy, call)
        for name, call in {
            "read": lambda p, x: p.read(x),
            "read timeout": lambda p, x: p.read(0, timeout_s=patience(x)),
            "read checked": lambda p, x: p.read(0, checked=x),
            "reader": lambda p, x: p.reader(x),
            "read_many": lambda p, x: p.read_many(x),
            "read_async": lambda p, x: done(p.read_async(x)),
            "read_many_async": lambda p, x: done(p.read_many_async(x)),
            "write": lambda p, x: p.write(x, 1),
            "write value": lambda p, x: p.write(1, x),
            "write_many": lambda p, x: p.write_many(x, x),
            "write_many values": lambda p, x: p.write_many([1], [x]),
            "write_async": lambda p, x: done(p.write_async(1, x)),
            "write_many_async": lambda p, x: done(p.write_many_async([1], x)),
            "subscribe": lambda p, x: p.subscribe(x, divisor=10).close(),
            "subscribe divisor": lambda p, x: p.subscribe([0], divisor=x).close(),
            "declare_outputs": lambda p, x: p.declare_outputs(x),
            "bus_address": lambda p, x: p.bus_address(x),
            "bus_addresses": lambda p, x: p.bus_addresses(x),
        }.items()
    }
# These take nothing that could be wrong, or only what other rows try.
NOTHING_TO_TRY = {
    *("Node.cycle", "Node.publishes", "Node.publishing", "Node.start_publishing", "Node.stop_publishing"),
    *("Node.record", "ReadValue.is_published", "ReadValue.take", "ReadValue.listeners", "ValueGroup.cycle"),
    *("ValueGroup.take", "ValueGroup.taken", "Cycle.close", "DeadMen.arm", "DoubleBufferProxy.batch"),
    *("TosNetProxy.batch", "TosNetProxy.commit", "WriteValue.take", "WriteValue.wrote"),
    # a group calls it, with what it has checked
    *(f"{kind}Proxy.write_burst" for kind in ("Memory", "Fifo", "DoubleBuffer", "TosNet")),
}


def test_the_whole_surface_is_tried() -> None:
    surface = set()
    for cls in (ReadValue, WriteValue, PulseValue, ClearValue, ValueGroup, Node, Cycle, DeadMen):
        surface |= {
            f"{cls.__name__}.{name}"
            for base in cls.__mro__
            for name, member in vars(base).items()
            if inspect.isfunction(member)
            and not name.startswith("_")
            and not (cls in (PulseValue, ClearValue) and hasattr(ReadValue, name))
        }
    for cls in (MemoryProxy, FifoProxy, DoubleBufferProxy, TosNetProxy):
        surface |= {
            f"{cls.__name__}.{n}"
            for n, member in inspect.getmembers(cls, inspect.isfunction)
            if not n.startswith("_")
        }
    tried = {name.partition(" ")[0] for name in CALLS}
    assert surface <= tried | NOTHING_TO_TRY


def tried(rig: Rig, name: str, junk: Any) -> None:
    """Make a call with a wrong argument. It works, or an error of this library says what is wrong."""
    try:
        CALLS[name](rig, junk)
    except UnityLinkError as error:
        assert 0 < len(str(error)) < 1000, name
    except Exception as error:
        raise AssertionError(f"{name} with {junk!r:.200}") from error


@settings(max_examples=many(50), suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(ANY)
def test_only_errors_of_this_library_come_out(rig: Rig, junk: Any) -> None:
    for name in CALLS:
        tried(rig, name, junk)


def test_none_of_these_is_worse(rig: Rig) -> None:
    for name in CALLS:
        for junk in JUNK:
            tried(rig, name, junk)


@pytest.mark.parametrize(
    ("path", "wrong"),
    [
        ("j[0].target", [4.0, math.nan, math.inf, "1", None, 10**5000]),
        ("gain", [math.nan, math.inf, -math.inf, 1e39, "1"]),
        ("j[0].mode", [2, "walk", None, 1.5]),
        ("word", []),
    ],
)
def test_nothing_was_sent(rig: Rig, path: str, wrong: list[Any]) -> None:
    rig.robot.stop_publishing()
    value = rig.robot[path]
    before = rig.link.statistics().requests
    for number in wrong:
        with pytest.raises(ValueRangeError, match="othing was sent"):
            value.write(number)
    assert rig.link.statistics().requests == before


def test_a_raw_number_of_packed_bits_is_checked_first(rig: Rig) -> None:
    """0b100 is not a valid mode. Once it was sent, and refused only after that."""
    rig.robot.stop_publishing()
    before = rig.link.statistics().requests
    with pytest.raises(ValueRangeError, match=r"flags\.mode: 4: .* nothing was sent"):
        rig.packed.clear(0b100)
    assert rig.link.statistics().requests == before


def test_one_number_for_many_says_what_is_wanted(rig: Rig) -> None:
    with pytest.raises(ValueRangeError, match=r"all: 1 is not a sequence or mapping .* \(j\[0\]\.target, "):
        rig.group.write(1)


@pytest.mark.parametrize(
    ("assign", "says"),
    [
        (
            lambda r: setattr(r.j[0], "target", 3),
            r"j\[0\]\.target cannot be replaced by 3; write it: j\[0\]\.target\.write\(3\)",
        ),
        (lambda r: setattr(r.j[0], "pos", 3), r"it is a READ: j\[0\]\.pos\.read\(\)"),
        (lambda r: setattr(r, "reset", True), r"write it: reset\.pulse\(True\)"),
        (lambda r: setattr(r, "flags", 1), r"write it: flags\.clear\(1\)"),
        (lambda r: setattr(r, "all", [1]), r"all cannot be replaced by \[1\]; write its values: all\.write"),
        (lambda r: setattr(r, "j", 3), r"it is an array: write its parts, such as j\[0\]"),
        (lambda r: r.j.__setitem__(0, 3), r"j\[0\] cannot be replaced by 3; write a value of it"),
        (lambda r: r.__setitem__("gain", 3), r"write it: gain\.write\(3\)"),
        (lambda r: r.all.__setitem__("j[0].target", 3), r"\.write\(3\)"),
        (lambda r: setattr(r.all, "target", 3), r"all\.target is not set to 3; write values of the group"),
        (lambda r: setattr(r.j[0], "taget", 3), r"j\[0\] has no taget; did you mean j\[0\]\.target\?"),
        (lambda r: setattr(r, "name", "x"), "name cannot be replaced by 'x'"),
    ],
)
def test_no_object_is_replaced(rig: Rig, assign: Callable[[Any], None], says: str) -> None:
    with pytest.raises(AssignmentError, match=says) as refused:
        assign(rig.robot)
    assert isinstance(refused.value, AttributeError)
    assert isinstance(rig.robot.j[0].target, WriteValue)


def test_a_users_own_class_may_have_its_own_attributes() -> None:
    class Arm(Node):
        pass

    spec = load(TYPED)
    with Board(spec) as board, Link(f"{board.url}?timeout=2") as link:
        arm: Any = Arm(load_spec_objects(spec, link)._tree, "arm")
        arm.speed = 3
        assert arm.speed == 3


def test_unknown_names_are_key_errors_of_this_library(rig: Rig) -> None:
    for wrong in ("j[0].taget", "", 3):
        with pytest.raises(UnknownName) as missing:
            rig.robot[wrong]
        assert isinstance(missing.value, KeyError) and not str(missing.value).startswith("'")
    assert "nothing" not in rig.robot.j[0].snapshot() and rig.robot.j[0].snapshot().get("nothing") is None
    assert isinstance(rig.robot.gain, ReadWriteValue) and isinstance(rig.robot.lost, ReadClearValue)
