# SPDX-License-Identifier: BSD-3-Clause
"""What a Link needs below it: the native engine with its protocol, or mapped memory, which needs none."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt

from unitylink import _native

Words = npt.NDArray[np.uint32]
Times = npt.NDArray[np.float64]
Integers = Sequence[int] | npt.NDArray[Any]
Pairs = Iterable[tuple[int, int]] | npt.NDArray[Any]


class Request(Protocol):
    """An asynchronous request under way. Its ticket is posted to the mailbox when it is done."""

    def withdraw(self, link: Any, /) -> None: ...
    def result(self, link: Any, /) -> Any: ...


class Engine(Protocol):
    """Requests and publishes of one device, as words at addresses. Thread-safe, with the errors of `Link`.

    `start` begins a request and posts `ticket` to `mailbox` when it is done. A subscription has a number, and
    its remainder modulo 256 is the group. `take_single` returns the waiting publish if it is the only one,
    else None. After `unsubscribe` has returned, no more publishes come.

    `wait_publishes` counts the publishes that have come and the subscriptions that have ended. It returns
    when that count is no longer `seen`, at the latest after `timeout_ns`. `notify_publishes` writes 1 to an
    eventfd for every publish and every end. `events` returns the events of the line (kind, time_s, text)
    since a number, and the number of the next. An event also ends `wait_publishes`.

    `generation` changes when the device may no longer hold what was written to it. `check_alive` raises the
    reason if the device went away by itself.
    """

    def read(self, address: int, checked: bool | None, repeat: bool, timeout_s: float | None, /) -> int: ...
    def write(
        self, address: int, value: int, checked: bool | None, repeat: bool, timeout_s: float | None, /
    ) -> None: ...
    def read_many(
        self,
        addresses: Integers,
        atomic: bool,
        checked: bool | None,
        repeat: bool,
        timeout_s: float | None,
        /,
    ) -> Words: ...
    def read_each(
        self, addresses: Integers, checked: bool | None, repeat: bool, timeout_s: float | None, /
    ) -> Words: ...
    def write_many(
        self,
        addresses: Integers,
        values: Integers,
        checked: bool | None,
        repeat: bool,
        timeout_s: float | None,
        /,
    ) -> None: ...
    def transfer(
        self,
        writes: Pairs,
        reads: Integers,
        atomic: bool,
        timeout_s: float | None,
        /,
    ) -> Words: ...
    def do_list(  # noqa: PLR0917
        self,
        operations: Integers,
        addresses: Integers,
        values: Integers,
        masks: Integers,
        reads: int,
        atomic: bool,
        timeout_s: float | None,
        /,
    ) -> Words: ...
    def post(self, addresses: Integers, values: Integers, timeout_s: float | None, /) -> None: ...
    def sync(self, timeout_s: float | None, /) -> None: ...
    def read_control(self, address: int, count: int, /) -> Words: ...
    def write_control(self, address: int, value: int, /) -> None: ...
    def define_exchange(
        self, outputs: Integers, output_bytes: Integers, inputs: Integers, input_bytes: Integers, /
    ) -> int: ...
    def exchange(self, id: int, outputs: Integers, inputs: int, timeout_s: float | None, /) -> Words: ...
    def release_exchange(self, id: int, /) -> None: ...
    def set_dead_man(self, silence_s: float, timeout_s: float | None, /) -> None: ...
    def arm(self, timeout_s: float | None, /) -> None: ...
    def watch_program(self, patience_s: float, /) -> None: ...
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
        /,
    ) -> Request: ...
    def subscribe(  # noqa: PLR0917
        self,
        addresses: Integers,
        divisor: int,
        on_event: bool,
        verify: bool,
        ring: int,
        group: int | None,
        /,
    ) -> int: ...
    def unsubscribe(self, id: int, /) -> None: ...
    def drain(self, id: int, words: int, /) -> tuple[Times, Words]: ...
    def take_single(self, id: int, words: int, /) -> tuple[float, tuple[int, ...]] | None: ...
    def subscribed(self, id: int, /) -> bool: ...
    def wait(self, id: int, timeout_s: float, /) -> bool: ...
    def available(self, id: int, /) -> int: ...
    def lost(self, id: int, /) -> int: ...
    def missing(self, id: int, /) -> int: ...
    def clock(self) -> tuple[float, float, float]: ...
    def check_spec(self, spec: str, hashes: Sequence[int], /) -> str: ...
    def now_s(self) -> float: ...
    def wait_publishes(self, seen: int, timeout_ns: int, /) -> int: ...
    def notify_publishes(self, descriptor: int, /) -> None: ...
    def forget_notification(self, descriptor: int, /) -> None: ...
    def wait_up(self, timeout_s: float, /) -> bool: ...
    def events(self, since: int, /) -> tuple[list[tuple[Any, float, str]], int]: ...
    @property
    def trouble(self) -> str: ...
    @property
    def generation(self) -> int: ...
    def statistics(self) -> dict[str, int]: ...
    def check_alive(self) -> None: ...
    def disown(self) -> None: ...
    @property
    def protocol(self) -> str: ...
    @property
    def notice(self) -> str: ...
    @property
    def description(self) -> dict[str, int]: ...
    @property
    def configuration(self) -> dict[str, Any]: ...
    @property
    def usable_group_size(self) -> int: ...
    @property
    def warning(self) -> str: ...
    @property
    def closed(self) -> bool: ...
    def close(self) -> None: ...


def open_engine(url: str) -> Engine:
    """Return the engine that the scheme of `url` needs. Raises what Link raises."""
    if url.startswith("mmap:"):
        from .mapped_engine import MappedEngine

        return MappedEngine(url)
    return _native.open_link(url)


def check_url(url: str) -> None:
    """Raise UrlError if no link with a protocol takes the form or options of this URL. Opens nothing."""
    _native.check_link_url(url)
