# SPDX-License-Identifier: BSD-3-Clause
"""What a native link does, but over a bridge: layer 2 sees no difference."""

from __future__ import annotations

import itertools
import os
import struct
import threading
import time
from collections import deque
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING, Any

import numpy as np

from unitylink import protocol as p
from unitylink.errors import (
    DeviceMismatch,
    LinkClosed,
    LinkDown,
    LinkTimeout,
    OutcomeUnknown,
    ProtocolError,
    UnityLinkError,
    ValueRangeError,
)

from .far_bridge import FarBridge
from .far_groups import FarGroup, FarGroups
from .messages import (
    ARM,
    ATOMIC,
    CHECKED,
    ON_EVENT,
    ONCE,
    OPERATIONS_MAX,
    SUBSCRIBE,
    UNCHECKED,
    UNSUBSCRIBE,
    VERIFY,
    Operation,
    operations_of,
)

if TYPE_CHECKING:
    import zenoh

    from unitylink._native import Mailbox
    from unitylink.layer2_message.native_link import Pairs, Times, Words

    from .far_options import FarOptions

_READ, _WRITE = p.LIST_OPERATION_READ, p.LIST_OPERATION_WRITE
_CALLS = 8  # calls of asyncio at the same time
_STATISTICS = (
    *("requests", "replies", "device_errors", "retries", "timeouts", "fences", "checksum_errors"),
    *("malformed_messages", "datalink_errors", "stale_replies", "garbage_bytes", "publishes"),
    *("unclaimed_publishes", "mismatched_publishes", "overruns", "bytes_sent", "bytes_received", "posts"),
    *("missing_publishes", "sessions", "restarts", "reconnections"),
)


class FarPending:
    """A call of asyncio that is under way."""

    def __init__(self) -> None:
        self.words: Words | None = None
        self.error: Exception | None = None

    def withdraw(self, _: object) -> None:
        """Nobody waits for it any more. It ends by itself."""

    def result(self, _: object) -> Words | None:
        """Return the words, or raise the error."""
        if self.error is not None:
            raise self.error
        return self.words


class FarLine:
    """The methods of `_native.NativeLink` for a robot on a Zenoh network."""

    protocol = "zenoh"
    notice = warning = ""
    in_steps = False

    def __init__(self, options: FarOptions) -> None:
        self._options = options
        self.groups = FarGroups()
        self._events: list[tuple[str, float, str]] = []
        self._exchanges: dict[int, tuple[list[int], list[int], list[int]]] = {}
        self._exchange_numbers = itertools.count(1)
        self._notified: set[int] = set()
        self._publishes = self._mismatched = self._back = 0
        self._subscribers: dict[int, zenoh.Subscriber[None]] = {}
        self._over = ""  # why the link has ended by itself
        self._changing = threading.Lock()  # held while groups are subscribed
        self._calls: ThreadPoolExecutor | None = None
        self.bridge = FarBridge(options, self._changed)
        self.description: dict[str, int] = {}

    # ---- words

    def read(self, address: int, checked: bool | None, repeat: bool, timeout_s: float | None) -> int:
        flags = _flags_of(checked, not repeat, False)
        return self.bridge.ask(operations=((_READ, address, 0, 0),), flags=flags, timeout_s=timeout_s)[0]

    def write(
        self, address: int, value: int, checked: bool | None, repeat: bool, timeout_s: float | None
    ) -> None:
        flags = _flags_of(checked, True, False)
        self.bridge.ask(operations=((_WRITE, address, value, 0),), flags=flags, timeout_s=timeout_s)

    def read_many(
        self, addresses: Any, atomic: bool, checked: bool | None, repeat: bool, timeout_s: float | None
    ) -> Words:
        operations = operations_of(_READ, _integers(addresses))
        return self._words(operations, _flags_of(checked, not repeat, atomic), timeout_s)

    def sample(
        self, addresses: Any, atomic: bool, checked: bool | None, repeat: bool, timeout_s: float | None
    ) -> tuple[float, list[int]]:
        begun_s = self.now_s()
        words = self.read_many(addresses, atomic, checked, repeat, timeout_s).tolist()
        return (begun_s + self.now_s()) / 2, words

    def read_each(self, addresses: Any, checked: bool | None, repeat: bool, timeout_s: float | None) -> Words:
        return self.read_many(addresses, False, checked, repeat, timeout_s)

    def write_many(
        self, addresses: Any, values: Any, checked: bool | None, repeat: bool, timeout_s: float | None
    ) -> None:
        to, words = _integers(addresses), _integers(values)
        if len(to) != len(words):
            raise ValueRangeError(f"{len(to)} addresses and {len(words)} values; nothing was sent")
        operations = tuple((_WRITE, address, value, 0) for address, value in zip(to, words, strict=True))
        self._words(operations, _flags_of(checked, True, False), timeout_s)

    def transfer(self, writes: Pairs, reads: Any, atomic: bool, timeout_s: float | None) -> Words:
        pairs = [(int(address), int(value)) for address, value in writes]
        operations = tuple((_WRITE, address, value, 0) for address, value in pairs)
        operations += operations_of(_READ, _integers(reads))
        return self._words(operations, _flags_of(None, bool(pairs), atomic), timeout_s)

    def do_list(  # noqa: PLR0917
        self,
        operations: Any,
        addresses: Any,
        values: Any,
        masks: Any,
        reads: int,
        atomic: bool,
        timeout_s: float | None,
    ) -> Words:
        steps = tuple(zip(*map(_integers, (operations, addresses, values, masks)), strict=True))
        return self._words(steps, ONCE | (ATOMIC if atomic else 0), timeout_s)

    def post(self, addresses: Any, values: Any, timeout_s: float | None) -> None:
        self.write_many(addresses, values, None, False, timeout_s)

    def sync(self, timeout_s: float | None) -> None:
        self.bridge.check()

    def define_exchange(self, outputs: Any, output_bytes: Any, inputs: Any, input_bytes: Any) -> int:
        number = next(self._exchange_numbers)
        self._exchanges[number] = _integers(outputs), _integers(output_bytes), _integers(inputs)
        return number

    def exchange(self, id: int, outputs: Any, inputs: int, timeout_s: float | None) -> Words:
        to, sizes, reads = self._exchanges[id]
        words = _integers(outputs)
        if len(words) != len(to) or any(word >> 8 * size for word, size in zip(words, sizes, strict=True)):
            raise ValueRangeError(f"{len(words)} words for {len(to)} outputs, or one that is too large")
        return self.transfer(list(zip(to, words, strict=True)), reads, False, timeout_s)

    def release_exchange(self, id: int) -> None:
        self._exchanges.pop(id, None)

    def _words(self, operations: Sequence[Operation], flags: int, timeout_s: float | None) -> Words:
        if flags & ATOMIC and len(operations) > OPERATIONS_MAX:
            raise DeviceMismatch(f"{len(operations)} operations at once; a request has {OPERATIONS_MAX}")
        words: list[int] = []
        for start in range(0, len(operations), OPERATIONS_MAX):
            part = operations[start : start + OPERATIONS_MAX]
            words += self.bridge.ask(operations=part, flags=flags, timeout_s=timeout_s)
        return np.array(words, dtype=np.uint32)

    # ---- the device

    def read_control(self, address: int, count: int) -> Words:
        raise DeviceMismatch(f"{self._options.url}: a bridge has no control registers")

    def write_control(self, address: int, value: int) -> None:
        self.read_control(address, 1)

    def set_dead_man(self, silence_s: float, timeout_s: float | None) -> None:
        if silence_s:
            raise DeviceMismatch(
                f"{self._options.url}: a client of a bridge has no dead-man; if it is gone, its parts "
                "are made safe within a second"
            )

    def arm(self, timeout_s: float | None) -> None:
        self.bridge.ask(ARM, timeout_s=timeout_s)

    def trip(self, timeout_s: float | None) -> None:
        each_s = timeout_s or self._options.timeout_s
        within_s = each_s * self._options.attempts  # a stop does no harm if it comes twice
        if self.bridge.questions.insist("stop", each_s=each_s, within_s=within_s, urgent=True) is None:
            raise LinkClosed(f"{self._options.url}: no answer to the stop")

    def watch_program(self, patience_s: float) -> None:
        if patience_s:
            raise DeviceMismatch(
                f"{self._options.url}: a client of a bridge is not watched; run it at the board"
            )

    def alive(self) -> None:
        """Give a sign of life, which nobody asks for."""

    def check_spec(self, spec: str, hashes: Sequence[int]) -> str:
        told = self.bridge.hash
        if any(f"{one:016x}" == told for one in hashes):
            return ""
        text = f"the robot has another spec than {spec}: {told}"
        if self._options.spec_hash == "any":
            return f"{text}; spec_hash=any"
        raise DeviceMismatch(f"{text}; take the robot's own, with `unitylink.connect(...).spec`")

    # ---- asyncio

    def start(self, mailbox: Mailbox, ticket: int, addresses: Any, values: Any, *more: Any) -> FarPending:
        atomic, checked, repeat, timeout_s = more
        pending = FarPending()

        def call() -> None:
            try:
                if values is None:
                    pending.words = self.read_many(addresses, atomic, checked, repeat, timeout_s)
                else:
                    self.write_many(addresses, values, checked, repeat, timeout_s)
            except Exception as error:
                pending.error = error
            mailbox.post(ticket)

        if self._calls is None:
            self._calls = ThreadPoolExecutor(_CALLS, "zenoh call")
        self._calls.submit(call)
        return pending

    # ---- publishes

    def subscribe(  # noqa: PLR0917
        self, addresses: Any, divisor: int, on_event: bool, verify: bool, ring: int, group: int | None
    ) -> int:
        words = tuple(_integers(addresses))
        flags = (ON_EVENT if on_event else 0) | (VERIFY if verify else 0)
        rows: deque[tuple[float, tuple[int, ...]]] = deque(maxlen=ring)
        one = FarGroup(words, divisor, flags, 0 if group is None else group + 1, rows)
        with self._changing:
            number = self.groups.add(one)
            try:
                self._join(number, one)
            except BaseException:
                one.open = False
                raise
        return number

    def _join(self, number: int, group: FarGroup) -> None:
        reads = operations_of(_READ, group.addresses)
        (group.number,) = self.bridge.ask(
            SUBSCRIBE, reads, flags=group.flags, argument=group.divisor, detail=group.detail
        )
        group.expected = None
        key = self._options.keys.words(self.bridge.bridge, group.number)
        old = self._subscribers.pop(number, None)
        if old is not None:
            old.undeclare()

        def take(sample: zenoh.Sample) -> None:
            try:
                with self.groups.news:
                    group.take(sample.payload.to_bytes(), self.bridge.clock.here(0))
            except ProtocolError:
                self._mismatched += 1
                return
            self._publishes += 1
            self._tell()

        self._subscribers[number] = self.bridge.session.declare_subscriber(key, take)

    def unsubscribe(self, id: int) -> None:
        group = self.groups.get(id)
        with self._changing:
            if not group.open:
                return
            group.open = False
            subscriber = self._subscribers.pop(id, None)
            if subscriber is not None and not self.bridge.closed:
                subscriber.undeclare()
        self._tell()
        if not self.bridge.trouble and not any(one.number == group.number for one in self.groups.open()):
            self.bridge.ask(UNSUBSCRIBE, argument=group.number)

    def drain(self, id: int, words: int) -> tuple[Times, Words]:
        return self.groups.drain(id, words)

    def take_single(self, id: int, words: int) -> tuple[float, tuple[int, ...]] | None:
        return self.groups.take_single(id)

    def subscribed(self, id: int) -> bool:
        return self.groups.get(id).open

    def wait(self, id: int, timeout_s: float) -> bool:
        return self.groups.wait(id, timeout_s)

    def available(self, id: int) -> int:
        return len(self.groups.get(id).rows)

    def lost(self, id: int) -> int:
        return self.groups.get(id).lost

    def missing(self, id: int) -> int:
        return self.groups.get(id).missing

    def wait_publishes(self, seen: int, timeout_ns: int) -> int:
        return self.groups.wait_news(seen, timeout_ns)

    def notify_publishes(self, descriptor: int) -> None:
        self._notified.add(descriptor)

    def forget_notification(self, descriptor: int) -> None:
        self._notified.discard(descriptor)

    def _tell(self) -> None:
        self.groups.tell()
        for descriptor in tuple(self._notified):
            os.write(descriptor, struct.pack("=Q", 1))

    # ---- the line

    def _changed(self, kind: str, text: str) -> None:
        """The bridge tells of it, in a thread of its own."""
        if kind == "ended":
            self._over = text
            self.groups.end(text)
        else:
            self._events.append((kind, self.now_s(), text))
        if kind == "back":
            self._back += 1
            with self._changing:
                for number in list(self._subscribers):
                    try:
                        self._join(number, self.groups.get(number))
                    except (LinkTimeout, OutcomeUnknown, LinkDown):
                        self.bridge.greet_again()
                        break
                    except UnityLinkError as error:
                        self._subscribers.pop(number).undeclare()
                        self._events.append(("lost", self.now_s(), self.groups.refuse(number, error)))
        self._tell()

    def events(self, since: int) -> tuple[list[tuple[str, float, str]], int]:
        return self._events[since:], len(self._events)

    def wait_up(self, timeout_s: float) -> bool:
        until_s = time.monotonic() + timeout_s
        while not self.closed:
            if not self.trouble:
                return True
            if time.monotonic() >= until_s:
                return False
            time.sleep(0.005)
        raise LinkClosed(f"{self._options.url}: {self.trouble}")

    @property
    def trouble(self) -> str:
        return "" if self.bridge.closed else self.bridge.trouble

    @property
    def generation(self) -> int:
        return self.bridge.generation

    def statistics(self) -> dict[str, int]:
        told = dict.fromkeys(_STATISTICS, 0) | self.bridge.counts
        missing = sum(one.missing for one in self.groups.open())
        told |= {"publishes": self._publishes, "mismatched_publishes": self._mismatched}
        return told | {"missing_publishes": missing, "sessions": 1 + self._back, "reconnections": self._back}

    def check_alive(self) -> None:
        if self.groups.ended and self._over:
            raise LinkClosed(f"{self._options.url}: {self._over}")

    @property
    def now_ns(self) -> int:
        return time.monotonic_ns()

    def now_s(self) -> float:
        return time.monotonic()

    def pass_until(self, until_ns: int) -> None:
        time.sleep(max(0, until_ns - time.monotonic_ns()) / 1e9)

    def clock(self) -> tuple[float, float, float]:
        return 0.0, 0.0, 0.0

    @property
    def configuration(self) -> dict[str, Any]:
        told = dict(self.bridge.configuration)
        told.pop("usable_group_size", None)
        return told | {"discovered": True}

    @property
    def usable_group_size(self) -> int:
        return int(self.bridge.configuration.get("usable_group_size", 0))

    @property
    def closed(self) -> bool:
        return self.bridge.closed

    def disown(self) -> None:
        """The parent process has the session. A child of it has none."""
        self.bridge.closed = True

    def close(self) -> None:
        self.bridge.close()
        self.groups.end("the link is closed")
        self._tell()
        if self._calls is not None:
            self._calls.shutdown(wait=False)


def _integers(numbers: Any) -> list[int]:
    return numbers.tolist() if isinstance(numbers, np.ndarray) else [int(number) for number in numbers]


def _flags_of(checked: bool | None, once: bool, atomic: bool) -> int:
    """Return the flags of a request."""
    told = 0 if checked is None else CHECKED if checked else UNCHECKED
    return told | (ONCE if once else 0) | (ATOMIC if atomic else 0)
