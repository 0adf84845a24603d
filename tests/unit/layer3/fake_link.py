# SPDX-License-Identifier: BSD-3-Clause
"""A link without a wire: the methods of `Link` on a model of the bus, with the faults that a test plans."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from unitylink import protocol
from unitylink.errors import BusError, DeviceMismatch, OutcomeUnknown


@dataclass(frozen=True)
class Configuration:
    address_bytes: int = 2
    data_bytes: int = 4
    read_many: int = 32
    publish_mode: int = 2
    base_hz: int = 1000
    groups: int = 4
    group_size: int = 9
    rate_bytes: int = 2

    @property
    def data_bits(self) -> int:
        return 8 * self.data_bytes

    @property
    def usable_group_size(self) -> int:
        return self.group_size - 1


class Memory:
    def __init__(self) -> None:
        self.words: dict[int, int] = {}

    def read(self, address: int) -> int:
        return self.words.get(address, 0)

    def write(self, address: int, word: int) -> None:
        self.words[address] = word


class TosNetModel:
    """The memory map with both hazards: the swap does not copy, and a write during a pending commit aborts
    it.

    A network cycle passes every `accesses_per_cycle` bus accesses. With 0, it passes only when `strobe` is
    called.
    """

    def __init__(self, accesses_per_cycle: int = 2) -> None:
        # words that the PC writes; those of [0] are on the network
        self.outputs = [dict[int, int](), dict[int, int]()]
        self.inputs: dict[int, int] = {}  # words that the nodes write
        self.online, self.halted = True, False
        self.pending, self.aborted = False, False
        self.accesses_per_cycle = accesses_per_cycle
        self.accesses = 0
        self.history: list[dict[int, int]] = []  # outputs after each commit that took effect
        self.sent: list[tuple[int, int]] = []
        self.received: list[tuple[int, bytes]] = []
        self.control = 0

    def strobe(self) -> None:
        if self.pending:
            self.outputs.reverse()
            self.pending = False
            self.history.append(dict(self.outputs[0]))

    def _access(self) -> None:
        self.accesses += 1
        if self.accesses_per_cycle and self.accesses % self.accesses_per_cycle == 0:
            self.strobe()

    def read(self, address: int) -> int:
        self._access()
        if address < protocol.TOSNET_MEMORY_WORDS:
            return self.inputs.get(address, self.outputs[0].get(address, 0))
        if address == protocol.TOSNET_STATUS:
            flags = self.online << 31 | 1 << 30 | self.halted << 28 | self.aborted << 5 | self.pending
            return flags | 1 << 20
        if address in (0x401, 0x402, 0x403):
            return address - 0x400
        if 0x500 <= address < 0x510:
            return {0x500: 0x010101, 0x501: 0x070712}.get(address, 0)
        if address == protocol.TOSNET_ASYNC_TX_STATUS:
            return (len(self.sent) >= 8) << 6
        if address == protocol.TOSNET_ASYNC_RX_STATUS:
            if not self.received:
                return 1 << 7
            node, data = self.received[0]
            return 1 << 6 | len(data) - 1 << 4 | node
        if address == protocol.TOSNET_ASYNC_RX_DATA:
            return int.from_bytes(self.received.pop(0)[1].ljust(4, b"\0"), "big")
        raise BusError("the bus refused", address=address)

    def write(self, address: int, word: int) -> None:
        if address < protocol.TOSNET_MEMORY_WORDS:
            if self.pending:
                self.pending, self.aborted = False, True
            self.outputs[1][address] = word
        elif address == protocol.TOSNET_STATUS:
            self.pending, self.aborted = True, False
        elif address == protocol.TOSNET_ASYNC_TX_CONTROL:
            self.control = word
        elif address == protocol.TOSNET_ASYNC_TX_DATA:
            self.sent.append((self.control, word))
        else:
            raise BusError("the bus refused", address=address)
        self._access()


class DoubleBufferModel:
    """Two banks that swap at once, without copying.

    A write to `size` commits, a read of it gives the count.
    """

    def __init__(self, size: int) -> None:
        self.size, self.commits = size, 0
        self.banks = [[0] * size, [0] * size]

    def read(self, address: int) -> int:
        return self.commits if address == self.size else self.banks[0][address]

    def write(self, address: int, word: int) -> None:
        if address == self.size:
            self.banks.reverse()
            self.commits += 1
        else:
            self.banks[1][address] = word


class FifoModel:
    def __init__(self, depth: int) -> None:
        self.depth, self.to_pc, self.from_pc = depth, list[int](), list[int]()

    def read(self, address: int) -> int:
        if address == 0:
            if not self.to_pc:
                raise BusError("the bus refused", address=address)
            return self.to_pc.pop(0)
        return len(self.to_pc) if address == 1 else self.depth - len(self.from_pc)

    def write(self, address: int, word: int) -> None:
        if address or len(self.from_pc) >= self.depth:
            raise BusError("the bus refused", address=address)
        self.from_pc.append(word)


class FakeSubscription:
    def __init__(self, link: FakeLink, addresses: tuple[int, ...], divisor: int) -> None:
        self.link, self.addresses, self.divisor = link, addresses, divisor
        self.lost = 0
        self.callback: Callable[[float, tuple[int, ...]], None] = lambda time_s, words: None

    def on_publish(
        self,
        callback: Callable[[float, tuple[int, ...]], None],
        *,
        gather_s: float = 0.0,
        arrays: Callable[[Any, Any], bool] | None = None,
        first: tuple[float, tuple[int, ...]] | None = None,
    ) -> None:
        self.callback, self.arrays = callback, arrays
        if first is not None:
            callback(*first)

    def close(self) -> None:
        self.link.subscriptions.remove(self)


@dataclass(eq=False)
class FakeLink:
    bus: Any = field(default_factory=Memory)
    configuration: Configuration = field(default_factory=Configuration)
    url: str = "fake:"
    base: int = 0
    closed: bool = False
    protocol: str = "classic"
    description: None = None  # None, because it speaks the classic protocol
    notice: str = ""
    unverified: str = "it is a fake"

    in_steps = False

    def pause_between_looks(self) -> None:
        pass

    generation = 0  # constant, because the device never restarts and the line is never lost

    def __post_init__(self) -> None:
        self.log: list[tuple[Any, ...]] = []
        self.subscriptions: list[FakeSubscription] = []
        self.repeats: list[tuple[str, int, bool]] = []
        self.lose_write_reply: set[int] = set()  # writes that are executed, but whose reply is lost
        self.fail: dict[int, Exception] = {}

    def check_spec(self, spec: str, hashes: Sequence[int]) -> None:
        """Accept every spec, because classic gateware has no hash to compare."""

    def now_s(self) -> float:
        return time.monotonic()

    def read(
        self,
        address: int,
        *,
        checked: bool | None = None,
        repeat: bool = True,
        timeout_s: float | None = None,
    ) -> int:
        self.log.append(("R", address))
        self.repeats.append(("R", address, repeat))
        if address in self.fail:
            raise self.fail[address]
        return int(self.bus.read(address - self.base))

    def read_many(
        self,
        addresses: Any,
        *,
        atomic: bool = False,
        checked: bool | None = None,
        repeat: bool = True,
        timeout_s: float | None = None,
    ) -> Any:
        where = list(addresses)
        assert not atomic or len(where) <= self.configuration.read_many
        self.log.append(("RM", *where) if atomic else ("R*", *where))
        for address in where:
            self.repeats.append(("R", address, repeat))
            if address in self.fail:
                raise self.fail[address]
        return np.array([self.bus.read(a - self.base) for a in where], np.uint32)

    def sample(self, addresses: Any, **options: Any) -> tuple[float, list[int]]:
        begun_s = self.now_s()
        words = self.read_many(addresses, **options).tolist()
        return (begun_s + self.now_s()) / 2, words

    def write(
        self,
        address: int,
        value: int,
        *,
        checked: bool | None = None,
        repeat: bool = False,
        timeout_s: float | None = None,
    ) -> None:
        self.log.append(("W", address, value))
        self.repeats.append(("W", address, repeat))
        assert 0 <= value < 1 << self.configuration.data_bits
        if address in self.fail:
            raise self.fail[address]
        self.bus.write(address - self.base, value)
        if address in self.lose_write_reply:
            raise OutcomeUnknown(f"write of {address:#06x}: the reply was lost", address=address, attempts=1)

    def write_many(self, addresses: Any, values: Any, **options: Any) -> None:
        for address, value in zip(addresses, values, strict=True):
            self.write(address, value, **options)

    async def read_async(self, address: int, **options: Any) -> int:
        return self.read(address, **options)

    async def read_many_async(self, addresses: Any, **options: Any) -> Any:
        return self.read_many(addresses, **options)

    async def write_async(self, address: int, value: int, **options: Any) -> None:
        self.write(address, value, **options)

    async def write_many_async(self, addresses: Any, values: Any, **options: Any) -> None:
        self.write_many(addresses, values, **options)

    def call_on_reset(self, action: Any) -> None:
        """Nothing resets it."""

    def subscribe(self, addresses: Any, *, divisor: int = 0, **options: Any) -> FakeSubscription:
        if len(self.subscriptions) >= self.configuration.groups:
            raise DeviceMismatch("no publish group is free")
        subscription = FakeSubscription(self, tuple(addresses), divisor)
        self.subscriptions.append(subscription)
        return subscription

    def publish(self, time_s: float | None = None) -> None:
        """Let every group publish the present words of its addresses."""
        for subscription in list(self.subscriptions):
            words = tuple(self.bus.read(a - self.base) for a in subscription.addresses)
            subscription.callback(time.monotonic() if time_s is None else time_s, words)
