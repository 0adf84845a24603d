# SPDX-License-Identifier: BSD-3-Clause
"""The gateware that a spec needs, virtual or in VHDL: its settings and the slaves on its bus."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from unitylink.errors import ValueRangeError
from unitylink.interface.components import ComponentConfiguration, components_of
from unitylink.interface.engine import SMALL, beyond_small, groups_for, lacks, small_will_do, too_often
from unitylink.interface.safe_words import safe_words
from unitylink.interface.wire_hash import wire_hash
from unitylink.protocol import (
    CLOCK_HZ_DEFAULT,
    GROUPS_MAX,
    READ_MANY_MAX,
    SMALL_ENGINE_GROUPS_MAX,
    TOSNET_ADDRESS_BITS,
    TOSNET_MEMORY_WORDS,
    TOSNET_RING_BAUD_HZ,
)
from unitylink.settings import SETTINGS, Setting, Settings
from unitylink.spec.expand.publishing import split
from unitylink.spec.isochrony.ring import ring_budget
from unitylink.spec.model import CYCLE, LINES, Instance, Link, Spec
from unitylink.spec.ring import ring_at

# What a design has beyond the needs of its spec: groups to which a program or a person subscribes at run
# time, and a read-many for words that they choose.
LEAST_GROUPS, SPARE_GROUPS = 4, 2
LEAST_READ_MANY = 16

STROBE_CLOCKS = 5  # between two base strobes, beside one for each group (subscription_manager)


@dataclass(frozen=True)
class TosnetNode:
    """A node of the network beside the PC's own. Bit r of `registers` says that register r is enabled."""

    id: int
    registers: int = 0xFF


@dataclass(frozen=True)
class TosnetConfiguration:
    """A TosNet bus slave at word address `base` and the network behind it.

    `master_id` is the PC's own node, `cycle_s` the network cycle. After `max_skipped_writes` cycles without a
    commit, the network halts. With 0 it never does. Each cycle drives the event input of `event_group`, one
    of `edge_events`.
    """

    base: int = 0
    master_id: int = 1
    master_registers: int = 0xFF
    cycle_s: float = 100e-6
    max_skipped_writes: int = 0
    nodes: tuple[TosnetNode, ...] = ()
    ring: str = ""  # "": no line; "pins": to nodes of their own; "inside": to nodes in the same simulation
    line_baud_hz: int = TOSNET_RING_BAUD_HZ
    rings: int = 1
    check_bytes: int = 1
    exact_hops: bool = False
    time: int | None = None  # the OUT word that carries the clock of the ring
    node_safe: tuple[tuple[int, int], ...] = ()  # (offset, word): what its nodes see while a ring is broken
    clock_hz: int = CLOCK_HZ_DEFAULT
    event_group: int | None = None

    @property
    def cycle_clocks(self) -> int:
        return max(1, round(self.cycle_s * self.clock_hz))


@dataclass(frozen=True)
class FifoConfiguration:
    """A FIFO slave: `base`+0 is data, +1 the words that wait for the PC, +2 the room for words from the PC.

    Its event line drives the event input of `event_group`, one of `edge_events`. A group with the one address
    `base` then publishes each word once, as soon as it can. The event rises again if nothing has been taken
    for `remind_clocks`.
    """

    base: int
    depth: int = 16
    event_group: int | None = None
    remind_clocks: int = 1 << 20


@dataclass(frozen=True)
class DoubleBufferConfiguration:
    """A double-buffered memory: `base`+0 to +size-1 are the words, +size is the commit."""

    base: int
    size: int = 16


@dataclass(frozen=True)
class BoardConfiguration(Settings):
    """Every setting of a device (docs/settings.md), the tables that follow from its spec, and the slaves on
    its bus.

    Widths are in bits, addresses in words. `safe_words` is what the dead-man writes: (address, word) in
    order. At the addresses in `flag_words`, a write clears bits (W1C). At those in `strobe_words`, a PULSE
    shares its word with a READ, which keeps its value. Raises ValueRangeError for settings that no device can
    have.

    >>> BoardConfiguration(baud_hz=3_000_000, fifo=16).byte_clocks
    166
    """

    safe_words: tuple[tuple[int, int], ...] = ()
    flag_words: tuple[int, ...] = ()
    strobe_words: tuple[int, ...] = ()
    # (first, last) addresses that are answered with a bus error
    bus_error_ranges: tuple[tuple[int, int], ...] = ()
    silent_ranges: tuple[tuple[int, int], ...] = ()  # (first, last) addresses that are not answered at all
    tosnet: TosnetConfiguration | None = None
    fifos: tuple[FifoConfiguration, ...] = ()
    double_buffers: tuple[DoubleBufferConfiguration, ...] = ()
    components: tuple[ComponentConfiguration, ...] = ()

    def __post_init__(self) -> None:
        for setting in SETTINGS.values():
            if wrong := _wrong(setting, getattr(self, setting.name)):
                raise ValueRangeError(f"board configuration: {wrong}")
        if self.protocol == "both" and (self.datalink != "full" or self.published_2012):
            # if data may be any byte, a 00 is not a border; gateware of 2012 has no frames
            object.__setattr__(self, "protocol", "classic")
        if self.physical == "rs485":  # the tokens of a pair are not classic text
            if self.protocol == "classic":
                raise ValueRangeError(
                    "board configuration: an RS-485 pair carries frames only; choose protocol 'framed'"
                )
            object.__setattr__(self, "protocol", "framed")
        if self.engine == "small" and (wrong := beyond_small(self)):
            raise ValueRangeError(f"board configuration: {wrong}")
        if self.baud_hz and self.physical not in LINES:
            raise ValueRangeError(
                f"board configuration: {self.physical} has no baud rate; leave out baud_hz={self.baud_hz}"
            )
        if self.baud_hz > self.clock_hz:
            raise ValueRangeError(
                f"board configuration: baud_hz is {self.baud_hz}; choose 0 to {self.clock_hz} (clock_hz)"
            )
        if self.window & (self.window - 1):
            raise ValueRangeError(
                f"board configuration: window is {self.window}; choose a power of two, "
                f"as {1 << self.window.bit_length() - 1}"
            )
        if self.fifo != 0 and self.fifo < 4:
            raise ValueRangeError(
                f"board configuration: fifo is {self.fifo}; choose at least 4 bytes, or 0 for large"
            )
        if self.tosnet is not None and self.tosnet.clock_hz != self.clock_hz:
            object.__setattr__(self, "tosnet", replace(self.tosnet, clock_hz=self.clock_hz))

    @property
    def byte_clocks(self) -> int:
        """Clock cycles of one byte on the line: start, eight data and stop bit.

        It is 0 without a serial line.
        """
        return self.clock_hz * 10 // self.baud_hz if self.baud_hz else 0

    @classmethod
    def for_spec(cls, spec: Spec, **overrides: Any) -> BoardConfiguration:
        """Return the board that `spec` needs. `overrides` are fields of this class.

        With a TOSNET binding it has the 11-bit map at BASE and one node for every node that the spec uses.
        Otherwise it has plain memory, with addresses as wide as the highest one needs. The link properties of
        the spec apply. It has two publish groups more than the spec needs and at least 4, as large as needed
        and at least 32 words each. A classic read-many can read everything in the largest device that may be
        read again, and at least 16 words. An exchange group holds the cycle of the largest device, as far as
        a frame can define it, and at least 30 words. It has the small engine, with all of its
        sizes, if that is enough (interface/engine.py). Raises ValueRangeError.
        """
        unknown = sorted(set(overrides) - set(cls.__dataclass_fields__))
        if unknown:
            raise ValueRangeError(f"board configuration: no field {', '.join(unknown)}")
        elements = [element for _, element in spec.walk()]
        tosnet = _tosnet_of(spec) if any(element.link.kind == "tosnet" for element in elements) else None
        ends = [
            element.link.base + element.link.words - 1
            for element in elements
            if element.link.kind != "tosnet"
        ]
        highest = max([0, *ends, *(element.addresses[-1] for element in elements)])
        address_bits = next(bits for bits in (8, 16, 24, 32) if highest < 1 << bits)
        if tosnet is not None:
            slave_bits = (tosnet.base + (1 << TOSNET_ADDRESS_BITS) - 1).bit_length()
            wide = max(slave_bits, highest.bit_length())
            address_bits = wide if wide <= TOSNET_ADDRESS_BITS else -(-wide // 8) * 8
        plain = [element for element in elements if element.link.kind == "memory"]
        read, strobes, flags = (
            {address for e in plain if e.access in accesses for address in e.addresses}
            for accesses in (("READ", "READCLEAR"), ("PULSE",), ("W1C",))
        )
        chosen: dict[str, Any] = {
            "address_bits": address_bits,
            "flag_words": tuple(sorted(flags)),
            "strobe_words": tuple(sorted(strobes & read)),
            "tosnet": tosnet,
            "fifos": _fifos_of(spec, overrides.get("clock_hz", CLOCK_HZ_DEFAULT)),
            "double_buffers": tuple(
                DoubleBufferConfiguration(base, size)
                for base, size in sorted(
                    {(e.link.base, e.link.size) for e in elements if e.link.kind == "double_buffer"}
                )
            ),
        }
        chosen["components"] = components_of(spec, overrides.get("clock_hz", CLOCK_HZ_DEFAULT))
        chosen = {**chosen, **_link_of(spec), **_publishing_of(spec), **overrides}
        if wrong := _wrong(SETTINGS["engine"], chosen.get("engine") or "fast"):
            raise ValueRangeError(f"board configuration: {wrong}")
        board = cls(**{**chosen, "engine": "fast"})
        if "engine" not in chosen and small_will_do(spec, board, overrides):
            chosen["engine"] = "small"
        if chosen.get("engine") == "small":
            for lack in lacks(spec, overrides):
                remedy = f"{lack.remedy}, or choose engine 'fast'"
                raise ValueRangeError(f"board configuration: {lack.what}: {remedy}")
            small = {**SMALL, **groups_for(spec, board, overrides), "groups": 1}
            board = cls(**{**chosen, **small, **overrides, "engine": "small"})
        found: dict[str, Any] = {
            "groups": _groups_of(spec, board),
            "read_many": _read_many_of(spec),
            "exchange_size": _exchange_size_of(spec, board),
            "spec_hash": wire_hash(spec),
            "safe_words": safe_words(spec, board.data_bits),
        }
        board = replace(board, **{name: value for name, value in found.items() if name not in overrides})
        near = too_often(spec, board) if board.engine == "small" else board.strobes_too_near()
        if wrong := board.beyond_frames() or near:
            raise ValueRangeError(f"board configuration: {wrong}")
        return board

    @property
    def address_bytes(self) -> int:
        return -(-self.address_bits // 8)

    @property
    def data_bytes(self) -> int:
        return -(-self.data_bits // 8)

    @property
    def publish_words(self) -> int:
        """Words that one publish can carry in either protocol."""
        if self.protocol == "classic":
            return self.group_size
        defined = (self.request_max - 9) // self.address_bytes  # less the head of DEFINE_GROUP
        carried = (self.reply_max - 7) // self.data_bytes  # less the head of a publish
        return min(self.group_size, defined, carried)

    @property
    def exchange_words_most(self) -> int:
        """Words of the largest exchange group that one frame can define."""
        return (self.request_max - 5) // (self.address_bytes + 1)

    def beyond_frames(self) -> str:
        """Return what the framed side of the gateware cannot hold, with the remedy, or ""."""
        if self.protocol == "classic":
            return ""
        if self.exchanges and self.exchange_size > self.exchange_words_most:
            return (
                f"exchange_size is {self.exchange_size}; at {self.address_bits} address bits one frame can "
                f"define {self.exchange_words_most} words: choose at most that many, and make several groups"
            )
        return ""

    def strobes_too_near(self) -> str:
        """If base strobes come faster than the groups are looked at, return this with the remedy, else ""."""
        least = self.groups + STROBE_CLOCKS if self.publish_mode else 1
        apart = self.clock_hz // self.base_hz
        if apart >= least:
            return ""
        return (
            f"a base strobe comes every {apart} clocks, and {self.groups} groups need {least}: "
            f"choose a BASE_RATE of at most {self.clock_hz // least} Hz, or a faster clock"
        )


def _wrong(setting: Setting, value: Any) -> str:
    """Return what is wrong with the value of a setting and which values are allowed, or ""."""
    name = setting.name
    if setting.type == "switch" and not isinstance(value, bool):
        return f"{name} is {value!r}; choose True or False"
    if setting.type == "count" and not (isinstance(value, int) and setting.least <= value <= setting.most):
        return f"{name} is {value!r}; choose {setting.least} to {setting.most}"
    if setting.type == "choice" and value not in setting.choices:
        return f"{name} is {value!r}; choose {', '.join(setting.choices)}"
    if setting.type == "groups" and not all(0 <= group < GROUPS_MAX for group in value):
        return f"{name} has {max(value)}; choose numbers from 0 to {GROUPS_MAX - 1}"
    return ""


def _link_of(spec: Spec) -> dict[str, Any]:
    """Return the gateware settings of the spec's link."""
    check_one_board(spec)
    told = {_told(device.link) for device in spec.devices}
    return {key: value for key, value in told.pop() if value is not None} if told else {}


def check_one_board(spec: Spec) -> None:
    """Raise ValueRangeError if the spec has several boards. Choose one with `Spec.only`."""
    names = [board.name for board in spec.boards]
    if len(names) > 1:
        raise ValueRangeError(
            f"{spec.source} has a board behind each of its links: {', '.join(names)}; "
            f"choose one: --root {names[0]}, or ?root={names[0]} in a URL"
        )


def _told(link: Link) -> tuple[tuple[str, Any], ...]:
    keys = ("data_bits", "address_bits", "base_hz", "physical", "send_immediate", "node", "engine")
    return tuple((key, getattr(link, key)) for key in keys)


def told_engine(spec: Spec) -> str | None:
    """Return the engine that the spec's links name, or None if they name none or several."""
    told = {device.link.engine for device in spec.devices}
    return told.pop() if len(told) == 1 else None


def told_physical(spec: Spec) -> str | None:
    """Return the physical layer of the spec's links. Return None if they name none or several."""
    told = {device.link.physical for device in spec.devices}
    return told.pop() if len(told) == 1 else None


def _publishing_of(spec: Spec) -> dict[str, Any]:
    """Return a subscription manager that holds every publish group of the spec."""
    groups = [group for device in spec.devices for group in device.groups]
    plain = BoardConfiguration()
    divisor = max((group.divisor for group in groups), default=0)
    edges = {group.number for group in groups if group.trigger in ("event", "change")}
    return {
        "group_size": max([plain.group_size, *(len(group.addresses) for group in groups)]),
        "rate_bytes": max(plain.rate_bytes, -(-divisor.bit_length() // 8)),
        "edge_events": tuple(sorted(edges)),
    }


def _fifos_of(spec: Spec, clock_hz: int) -> tuple[FifoConfiguration, ...]:
    """Return the FIFOs of a spec.

    The event of a FIFO triggers the group that is published on its `arrival`.
    """
    arrivals = {
        (device.root, group.event): group.number
        for device in spec.devices
        for group in device.groups
        if group.trigger == "event"
    }
    fifos: dict[int, FifoConfiguration] = {}

    def below(instance: Instance, root: str) -> None:
        link = instance.link
        if link.kind == "fifo":
            group = arrivals.get((root, link.event_at(instance.path)))
            known = fifos.get(link.base)
            if known is None or known.event_group is None:
                fifos[link.base] = FifoConfiguration(link.base, link.size, group, max(4, clock_hz // 50))
        for inner in instance.instances:
            below(inner, root)

    for root in spec.roots:
        below(root, root.name)
    return tuple(fifos[base] for base in sorted(fifos))


def _groups_of(spec: Spec, board: BoardConfiguration) -> int:
    """Return how many publish groups the spec needs.

    A group that is too large for one publish needs several.
    """
    most = board.publish_words
    needed = [
        sum(len(split(group.elements, lambda element: element.words, most)) for group in device.groups)
        for device in spec.devices
    ]
    most_needed = max(needed, default=0)
    limit = SMALL_ENGINE_GROUPS_MAX if board.engine == "small" else GROUPS_MAX
    return max(most_needed, min(max(LEAST_GROUPS, most_needed + SPARE_GROUPS), limit))


def _read_many_of(spec: Spec) -> int:
    """Return the words of a classic read-many.

    One read-many takes all words of the largest device that may be polled, up to the protocol's limit.
    """
    words = [sum(e.words for e in root.walk() if e.pollable) for root in spec.roots]
    return min(max([LEAST_READ_MANY, *words]), READ_MANY_MAX)


def _exchange_size_of(spec: Spec, board: BoardConfiguration) -> int:
    """Return the words of an exchange group.

    It holds the largest cycle of the spec, as far as a frame can define it.
    """
    cycle = max((_cycle_words(root) for root in spec.roots), default=0)
    return min(max(board.exchange_size, cycle), board.exchange_words_most)


def _cycle_words(root: Instance) -> int:
    """Return the words of a control cycle of `root`: everything that it writes, and everything that may be
    read again.
    """
    return sum(element.words * (element.pollable + element.writable) for element in root.walk())


def _tosnet_of(spec: Spec) -> TosnetConfiguration:
    """Return the network that a spec needs: its nodes, and which of them is the PC's."""
    bound = [element for _, element in spec.walk() if element.link.kind == "tosnet"]
    bases = sorted({element.link.base for element in bound})
    if len(bases) > 1:
        raise ValueRangeError(
            f"the spec binds TosNet at {', '.join(hex(base) for base in bases)}; a virtual board has one "
            "network: simulate each public constructor on its own"
        )
    ring = ring_at(spec, bases[0])
    own = range(ring.base, ring.base + TOSNET_MEMORY_WORDS)
    safe = safe_words(spec, spec.devices[0].link.data_bits) if ring.options.nodes == "ring" else ()
    return TosnetConfiguration(
        base=ring.base,
        master_id=ring.own.id,
        master_registers=ring.own.registers,
        cycle_s=ring_budget(ring).cycle_s,
        nodes=tuple(TosnetNode(node.id, node.registers) for node in ring.nodes if node.id),
        ring="pins" if ring.options.nodes == "ring" else "",
        line_baud_hz=ring.baud_hz,
        rings=ring.options.rings,
        check_bytes=ring.options.check_bytes,
        exact_hops=ring.options.exact_hops,
        time=ring.options.time,
        node_safe=tuple((address - ring.base, word) for address, word in safe if address in own),
        event_group=next((g.number for d in spec.devices for g in d.groups if g.event == CYCLE), None),
    )
