# SPDX-License-Identifier: BSD-3-Clause
"""The engine of `mmap:` links: registers that are memory, with no protocol between."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import fields
from typing import Any

import numpy as np

from unitylink import _native
from unitylink.errors import DeviceMismatch, LinkClosed, LinkError, ValueRangeError
from unitylink.protocol import (
    GROUP_SIZE_MAX,
    GROUPS_MAX,
    LIST_OPERATION_ADD,
    LIST_OPERATION_READ,
    LIST_OPERATION_READ_FIFO,
    LIST_OPERATION_WRITE_MASKED,
    RATE_BYTES_MAX,
    READ_MANY_MAX,
)

from .configuration import Statistics
from .engine import Integers, Pairs, Times, Words
from .mapped_url import WORD_BYTES, parse_mapped_url
from .polled_publishes import PolledPublishes

_PASSES = 8  # reads of some words in a row before they count as always changing


class MappedEngine:
    """Words of mapped memory. `Engine` describes each method.

    `checked`, `repeat` and `timeout_s` mean nothing here: nothing is sent, and an access is over at once.
    Words that must be of one moment are read until two passes agree.
    """

    warning = ""
    protocol = "memory"
    notice = ""
    usable_group_size = GROUP_SIZE_MAX

    def __init__(self, url: str) -> None:
        place = parse_mapped_url(url)
        self.configuration: dict[str, Any] = {
            "address_bytes": place.address_bytes,
            "data_bytes": WORD_BYTES,
            "read_many": READ_MANY_MAX,
            "publish_mode": 1,
            "base_hz": place.base_hz,
            "groups": GROUPS_MAX,
            "group_size": GROUP_SIZE_MAX,
            "rate_bytes": RATE_BYTES_MAX,
            "discovered": False,
        }
        self._memory = _native.map_memory(place.path, place.offset, place.size)
        self._publishes = PolledPublishes(self._poll)
        self._requests = 0
        self._exchanges: dict[int, tuple[list[int], list[int], list[int]]] = {}
        self._exchanges_made = 0
        self._unsettled = 0

    def read(self, address: int, checked: bool | None, repeat: bool, timeout_s: float | None) -> int:
        self._requests += 1
        return self._memory.read(address)

    def write(
        self, address: int, value: int, checked: bool | None, repeat: bool, timeout_s: float | None
    ) -> None:
        self._requests += 1
        self._memory.write(address, value)

    def read_many(
        self,
        addresses: Integers,
        atomic: bool,
        checked: bool | None,
        repeat: bool,
        timeout_s: float | None,
    ) -> Words:
        self._requests += 1
        if not atomic:
            return self._memory.read_many(addresses)
        if not repeat:
            raise DeviceMismatch(
                "mapped memory gives words of one moment by reading them twice, and these may not be"
            )
        words, settled = self._memory.read_settled(addresses, _PASSES)
        if not settled:
            raise DeviceMismatch(
                f"{len(words)} words changed during each of {_PASSES} readings: mapped memory cannot give "
                "them as of one moment; read them apart, or let the device hold them"
            )
        return words

    def read_each(
        self, addresses: Integers, checked: bool | None, repeat: bool, timeout_s: float | None
    ) -> Words:
        return self.read_many(addresses, False, checked, repeat, timeout_s)

    def write_many(
        self,
        addresses: Integers,
        values: Integers,
        checked: bool | None,
        repeat: bool,
        timeout_s: float | None,
    ) -> None:
        if len(addresses) != len(values):
            raise ValueRangeError(f"{len(addresses)} addresses and {len(values)} values")
        for address, value in zip(addresses, values, strict=True):
            self.write(address, value, checked, repeat, timeout_s)

    def transfer(
        self,
        writes: Pairs,
        reads: Integers,
        atomic: bool,
        timeout_s: float | None,
    ) -> Words:
        try:
            pairs = [(address, value) for address, value in writes]
        except (TypeError, ValueError):
            raise ValueRangeError("writes must be a sequence of pairs (address, value)") from None
        for address, value in pairs:
            self.write(address, value, None, False, timeout_s)
        return self.read_many(reads, atomic, None, True, timeout_s)

    def do_list(  # noqa: PLR0917
        self,
        operations: Integers,
        addresses: Integers,
        values: Integers,
        masks: Integers,
        reads: int,
        atomic: bool,
        timeout_s: float | None,
    ) -> Words:
        if atomic and len(operations) > 1:
            raise DeviceMismatch("mapped memory does one operation after the other; do them without atomic")
        read: list[int] = []
        for operation, address, value, mask in zip(operations, addresses, values, masks, strict=True):
            if operation in (LIST_OPERATION_READ, LIST_OPERATION_READ_FIFO):
                read.append(self.read(address, None, True, timeout_s))
            elif operation == LIST_OPERATION_WRITE_MASKED:
                old = self.read(address, None, True, timeout_s)
                self.write(address, (old & ~mask) | (value & mask), None, False, timeout_s)
            elif operation == LIST_OPERATION_ADD:
                old = self.read(address, None, True, timeout_s)
                self.write(address, (old + value) & 0xFFFF_FFFF, None, False, timeout_s)
            else:
                self.write(address, value, None, False, timeout_s)
        return np.array(read, dtype=np.uint32)

    def post(self, addresses: Integers, values: Integers, timeout_s: float | None) -> None:
        self.write_many(addresses, values, None, False, timeout_s)

    def sync(self, timeout_s: float | None) -> None:
        """Do nothing, because a post is done at once."""

    def read_control(self, address: int, count: int) -> Words:
        raise DeviceMismatch("mapped memory has no registers of its own; they need the framed protocol")

    def write_control(self, address: int, value: int) -> None:
        raise DeviceMismatch("mapped memory has no registers of its own; they need the framed protocol")

    def define_exchange(
        self, outputs: Integers, output_bytes: Integers, inputs: Integers, input_bytes: Integers
    ) -> int:
        self._exchanges[self._exchanges_made] = (
            [int(address) for address in outputs],
            [int(address) for address in inputs],
            [(1 << 8 * int(size)) - 1 for size in input_bytes],
        )
        self._exchanges_made += 1
        return self._exchanges_made - 1

    def exchange(self, id: int, outputs: Integers, inputs: int, timeout_s: float | None) -> Words:
        if id not in self._exchanges:
            raise ValueRangeError(f"there is no exchange group {id}; it was closed")
        addresses, reads, masks = self._exchanges[id]
        self.write_many(addresses, outputs, None, False, timeout_s)
        words = self.read_many(reads, False, None, True, timeout_s)
        return np.bitwise_and(words, np.array(masks, dtype=np.uint32))

    def release_exchange(self, id: int) -> None:
        self._exchanges.pop(id, None)

    def set_dead_man(self, silence_s: float, timeout_s: float | None) -> None:
        raise DeviceMismatch("mapped memory has no dead-man: nothing notices that this program is gone")

    def arm(self, timeout_s: float | None) -> None:
        raise DeviceMismatch("mapped memory has no dead-man, so there is nothing to arm")

    def watch_program(self, patience_s: float) -> None:
        raise DeviceMismatch("mapped memory has no dead-man, and no line that could be given up")

    def alive(self) -> None: ...

    def start(  # noqa: PLR0917 (as the native engine has it)
        self,
        mailbox: _native.Mailbox,
        ticket: int,
        addresses: Integers,
        values: Integers | None,
        atomic: bool,
        checked: bool | None,
        repeat: bool,
        timeout_s: float | None,
    ) -> _Done:
        """Do the request at once. Only its result waits for the event loop."""
        try:
            done = _Done()
            if values is None:
                done.words = self.read_many(addresses, atomic, checked, repeat, timeout_s)
            else:
                self.write_many(addresses, values, checked, repeat, timeout_s)
        except (LinkError, ValueRangeError) as error:
            done.error = error
        mailbox.post(ticket)
        return done

    def subscribe(  # noqa: PLR0917
        self,
        addresses: Integers,
        divisor: int,
        on_event: bool,
        verify: bool,
        ring: int,
        group: int | None,
    ) -> int:
        if on_event:
            raise DeviceMismatch("mapped memory has no events: publish at a rate, which is polled")
        most = (1 << 8 * RATE_BYTES_MAX) - 1
        if not 1 <= divisor <= most:
            raise ValueRangeError(f"divisor {divisor} is not in 1..{most}")
        if not 1 <= len(addresses) <= GROUP_SIZE_MAX:
            raise DeviceMismatch(f"a group has 1 to {GROUP_SIZE_MAX} words, and {len(addresses)} are asked")
        if ring < 1:
            raise ValueRangeError(f"ring {ring} is not above 0")
        words = tuple(int(address) for address in addresses)
        if verify:
            self._memory.read_many(words)
        return self._publishes.add(words, divisor / self.configuration["base_hz"], ring, group)

    def unsubscribe(self, id: int) -> None:
        self._publishes.remove(id)

    def drain(self, id: int, words: int) -> tuple[Times, Words]:
        return self._publishes.drain(id, words)

    def take_single(self, id: int, words: int) -> tuple[float, tuple[int, ...]] | None:
        return self._publishes.take_single(id)

    def subscribed(self, id: int) -> bool:
        return self._publishes.subscribed(id)

    def wait(self, id: int, timeout_s: float) -> bool:
        return self._publishes.wait(id, timeout_s)

    def available(self, id: int) -> int:
        return self._publishes.available(id)

    def lost(self, id: int) -> int:
        return self._publishes.lost(id)

    @property
    def description(self) -> dict[str, int]:
        return {}

    def missing(self, id: int) -> int:
        return 0

    def now_s(self) -> float:
        return time.monotonic()

    def check_spec(self, spec: str, hashes: Sequence[int]) -> str:
        return "mapped memory cannot say which spec it was built from; check that the two belong together"

    def clock(self) -> tuple[float, float, float]:
        return 0.0, 0.0, 0.0

    def wait_publishes(self, seen: int, timeout_ns: int) -> int:
        return self._publishes.wait_for_news(seen, timeout_ns * 1e-9)

    def notify_publishes(self, descriptor: int) -> None:
        self._publishes.watch(descriptor)

    def forget_notification(self, descriptor: int) -> None:
        self._publishes.forget(descriptor)

    def statistics(self) -> dict[str, int]:
        counted = dict.fromkeys((field.name for field in fields(Statistics)), 0)
        counted["requests"] = counted["replies"] = self._requests
        counted["publishes"] = self._publishes.received
        counted["overruns"] = self._publishes.overruns
        counted["mismatched_publishes"] = self._unsettled
        return counted

    def wait_up(self, timeout_s: float) -> bool:
        if self.closed:
            raise LinkClosed("the link is closed")
        return True

    def events(self, since: int) -> tuple[list[tuple[Any, float, str]], int]:
        return [], 0

    @property
    def trouble(self) -> str:
        return ""

    @property
    def generation(self) -> int:
        return 0

    def check_alive(self) -> None:
        """Do nothing: memory does not go away by itself, or nobody learns of it."""

    @property
    def closed(self) -> bool:
        return self._memory.closed

    def close(self) -> None:
        self._publishes.close()
        self._memory.close()

    def disown(self) -> None:
        self._publishes.disown()
        self._memory.close()

    def _poll(self, addresses: tuple[int, ...]) -> list[int]:
        words, settled = self._memory.read_settled(addresses, _PASSES)
        self._unsettled += not settled
        return [int(word) for word in words]


class _Done:
    """A request that is over."""

    words: Words | None = None
    error: Exception | None = None

    def withdraw(self, link: object) -> None:
        """Do nothing: the request is done."""

    def result(self, link: object) -> Words | None:
        if self.error is not None:
            raise self.error
        return self.words
