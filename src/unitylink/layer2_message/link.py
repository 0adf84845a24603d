# SPDX-License-Identifier: BSD-3-Clause
"""Link: a connection to one device."""

from __future__ import annotations

import asyncio
import warnings
from collections.abc import Callable, Sequence
from types import TracebackType
from typing import TYPE_CHECKING, Any

import numpy.typing as npt

from unitylink.errors import UnityLinkError

from .batch import Batch
from .callbacks import CallbackThread
from .configuration import Configuration, Statistics
from .device import Clock, DeadMan, Description, Health, checked_spec, told_notice
from .exchange_group import ExchangeGroup, Word
from .link_loop import LinkLoop
from .link_reset import LinkReset
from .link_time import LinkTime
from .mailbox import LoopMailbox
from .native_link import Pairs, Words, open_link
from .open_links import forget, remember
from .subscription import Subscription

if TYPE_CHECKING:
    from typing_extensions import Self

    from unitylink._native import NativeLink


class Link(LinkReset, LinkTime, LinkLoop):
    """A connection to one device. Every method may be called from any thread.

    `checked` asks for a checksum. None means the default of the link, which is the URL option `crc`. `repeat`
    says that sending the request twice does no harm. `timeout_s` counts for each attempt. Errors are the
    `LinkError` branch of `unitylink.errors`. A `ValueRangeError` comes before anything is sent.
    """

    url: str
    configuration: Configuration
    protocol: str
    """`framed`, `classic`, or `memory`, where there is no protocol."""
    notice: str
    """Why the link speaks the classic protocol although nobody asked for it. Empty otherwise. It is
    logged."""
    description: Description | None
    """What the gateware says about itself. None on a classic link."""
    unverified: str
    """Why it is unknown whether the gateware was built from this program's spec. Empty if it was."""
    _unclosed = False  # true while the link must still be closed, whatever happened to the port

    def __init__(self, url: str) -> None:
        """Open `url`, resynchronise with the device, and ask for its configuration."""
        self.url = url
        self.board: Any = None  # the virtual board behind a `sim:` or `rtl:` link, set by whoever makes it
        self._on_close: list[Callable[[], None]] = []
        self._remember_options(url)
        self._begin(url)
        self.unverified = "no spec was compared with the gateware's"
        self._unclosed = True
        remember(self)

    def _begin(self, url: str) -> None:
        self._native = self._opened(url)
        self._warned = ""
        self._warn()
        told = self._native.configuration
        self.configuration = Configuration(**told, usable_group_size=self._native.usable_group_size)
        self.protocol = self._native.protocol
        self.notice = told_notice(self._native, url)
        self.description = Description(**self._native.description) if self.protocol == "framed" else None
        self._callbacks = CallbackThread(self._native)
        self._mailboxes: dict[asyncio.AbstractEventLoop, LoopMailbox] = {}
        self._stepped_ns = self._native.now_ns  # when the last step ended

    def _opened(self, url: str) -> NativeLink:
        """Open what does the work. A link that the native core does not open has another."""
        return open_link(url)

    # ---- one word

    def read(
        self,
        address: int,
        *,
        checked: bool | None = None,
        repeat: bool = True,
        timeout_s: float | None = None,
    ) -> int:
        """Return the word at `address`.

        Raises LinkTimeout, BusError (nothing answers there), LinkClosed, ProtocolError.
        `repeat=False` is for addresses where reading has an effect, such as taking a word from a FIFO.
        """
        return self._native.read(address, checked, repeat, timeout_s)

    def write(
        self,
        address: int,
        value: int,
        *,
        checked: bool | None = None,
        repeat: bool = False,
        timeout_s: float | None = None,
    ) -> None:
        """Write `value` to `address`. It has been done when this returns.

        Raises OutcomeUnknown if the reply was lost and the write may not be repeated.
        """
        self._native.write(address, value, checked, repeat, timeout_s)

    # ---- many words

    def read_many(
        self,
        addresses: Sequence[int] | npt.NDArray[Any],
        *,
        atomic: bool = False,
        checked: bool | None = None,
        repeat: bool = True,
        timeout_s: float | None = None,
    ) -> Words:
        """Return the words at `addresses` (uint32, same order), in as few messages as the device allows.

        With `atomic` they come from one message, and the bus is held while they are read. Raises
        DeviceMismatch if there are too many of them.
        """
        return self._native.read_many(addresses, atomic, checked, repeat, timeout_s)

    def read_each(
        self,
        addresses: Sequence[int] | npt.NDArray[Any],
        *,
        checked: bool | None = None,
        repeat: bool = True,
        timeout_s: float | None = None,
    ) -> Words:
        """Return the words at `addresses`, one request each, as many at once as `fifo` and `window` allow."""
        return self._native.read_each(addresses, checked, repeat, timeout_s)

    def write_many(
        self,
        addresses: Sequence[int] | npt.NDArray[Any],
        values: Sequence[int] | npt.NDArray[Any],
        *,
        checked: bool | None = None,
        repeat: bool = False,
        timeout_s: float | None = None,
    ) -> None:
        """Write `values` to `addresses` in order. After a failure, no further word is sent."""
        self._native.write_many(addresses, values, checked, repeat, timeout_s)

    def exchange(
        self,
        reads: Sequence[int] | npt.NDArray[Any] = (),
        writes: Pairs = (),
        *,
        atomic: bool = False,
        timeout_s: float | None = None,
    ) -> Words:
        """Do `writes` (address, value), then `reads`. Return the words that were read.

        On a framed link it takes one message each way if the device's buffers allow that, and is executed
        exactly once. On a classic link it is write_many, then read_many. `atomic` holds the bus from the
        first word to the last, or raises DeviceMismatch. A reset meanwhile raises OutcomeUnknown.

            link.exchange([0x10, 0x11], writes=[(0x20, 5), (0x21, 6)])
        """
        return self._native.transfer(writes, reads, atomic, timeout_s)

    def exchange_group(self, writes: Sequence[Word] = (), reads: Sequence[Word] = ()) -> ExchangeGroup:
        """Name words that are often written and read together, as addresses or as (address, bytes).

        Then only data travels. A few bytes write all outputs and read all inputs, in one transaction of the
        bus. On a classic link it is write_many, then read_many. DeviceMismatch: no group is free or fits.

            with link.exchange_group(writes=[0x20, (0x21, 1)], reads=[0x10]) as group:
                (position,) = group.exchange([1000, 1])
        """
        return ExchangeGroup(self._native, writes, reads, self.configuration.data_bytes)

    def batch(self, *, atomic: bool = False) -> Batch:
        """Return a context manager that collects operations and does them in order at its end.

        `atomic` holds the bus from first to last, in one message, or raises DeviceMismatch. No operation of a
        message begins before all of it has been checked. An operation sees what those before it have written.
        All other words that an atomic batch reads are of one moment, if the gateware freezes its registers
        while the bus is held.

            with link.batch() as batch:
                batch.write(0x20, 5)
                batch.write_masked(0x21, mask=0x0F, value=3)
                position = batch.read(0x10)
            print(position.value)
        """
        return Batch(self._native, atomic=atomic)

    def post(self, address: int, value: int) -> None:
        """Write `value` to `address` without waiting for a reply. See post_many."""
        self._native.post((address,), (value,), None)

    def post_many(
        self,
        addresses: Sequence[int] | npt.NDArray[Any],
        values: Sequence[int] | npt.NDArray[Any],
    ) -> None:
        """Write `values` to `addresses` in order, without waiting for replies, at the full rate of the line.

        They are executed once and in order, before every request that follows. `sync` reports their result.
        The call waits only while the line is full. On a classic link it is write_many.
        """
        self._native.post(addresses, values, None)

    def sync(self, *, timeout_s: float | None = None) -> None:
        """Return when all posts have been executed.

        Raises BusError if some of them failed since the last call. Raises OutcomeUnknown if the device was
        reset before it had confirmed them.
        """
        self._native.sync(timeout_s)

    # ---- the same for asyncio

    async def read_async(
        self,
        address: int,
        *,
        checked: bool | None = None,
        repeat: bool = True,
        timeout_s: float | None = None,
    ) -> int:
        """Return the word at `address`. See read."""
        words: Words = await self._start((address,), None, False, checked, repeat, timeout_s)
        return int(words[0])

    async def read_many_async(
        self,
        addresses: Sequence[int] | npt.NDArray[Any],
        *,
        atomic: bool = False,
        checked: bool | None = None,
        repeat: bool = True,
        timeout_s: float | None = None,
    ) -> Words:
        """Return the words at `addresses`. See read_many."""
        words: Words = await self._start(addresses, None, atomic, checked, repeat, timeout_s)
        return words

    async def write_async(
        self,
        address: int,
        value: int,
        *,
        checked: bool | None = None,
        repeat: bool = False,
        timeout_s: float | None = None,
    ) -> None:
        """Write `value` to `address`. See write."""
        await self._start((address,), (value,), False, checked, repeat, timeout_s)

    async def write_many_async(
        self,
        addresses: Sequence[int] | npt.NDArray[Any],
        values: Sequence[int] | npt.NDArray[Any],
        *,
        checked: bool | None = None,
        repeat: bool = False,
        timeout_s: float | None = None,
    ) -> None:
        """Write `values` to `addresses` in order. See write_many."""
        await self._start(addresses, values, False, checked, repeat, timeout_s)

    def _start(self, *request: Any) -> asyncio.Future[Any]:
        return self._mailbox().start(*request)

    def _mailbox(self) -> LoopMailbox:
        if self.in_steps:
            raise UnityLinkError(
                f"{self.url}: with time=lockstep, time passes only while a call waits, and calls of asyncio "
                "never do; use the others"
            )
        loop = asyncio.get_running_loop()
        mailbox = self._mailboxes.get(loop)
        if mailbox is None:
            for old in [old for old in list(self._mailboxes) if old.is_closed()]:
                self._mailboxes.pop(old, None)
            mailbox = self._mailboxes[loop] = LoopMailbox(self._native, loop)
        return mailbox

    # ---- publishes

    def subscribe(
        self,
        addresses: Sequence[int] | npt.NDArray[Any],
        *,
        divisor: int = 0,
        on_event: bool = False,
        verify: bool = True,
        ring: int = 4096,
        group: int | None = None,
    ) -> Subscription:
        """Let the device publish the words at `addresses` together.

        It does so every `divisor` base periods. With `on_event`, it does so when the group's event input
        triggers it. `verify` first reads each address once, because 2012 gateware never stops publishing an
        address where nothing answers. Use False if a read has an effect. `ring` is how many publishes may
        wait to be fetched. If more come, the oldest ones are dropped. `group` asks for a certain one: each
        has its own event input. Raises DeviceMismatch if none is free or large enough, or the line too slow.
        """
        at = self._server or self._native
        identity = at.subscribe(addresses, divisor, on_event, verify, ring, group)
        words = tuple(int(address) for address in addresses)
        return Subscription(
            self._native, self._callbacks, identity, words, divisor, release=at.unsubscribe, keep=self
        )

    # ---- the device itself

    def read_control(self, address: int, count: int = 1) -> Words:
        """Return `count` control registers from `address` on (`CONTROL_…` of unitylink.protocol).

        Raises DeviceMismatch on a classic link, and ProtocolError if a register does not exist.
        """
        return self._native.read_control(address, count)

    def write_control(self, address: int, value: int) -> None:
        """Write a control register of the device. See read_control."""
        self._native.write_control(address, value)

    def health(self) -> Health | None:
        """Return the device's own counters: what reached it, what it dropped. None on a classic link."""
        if self.protocol != "framed":
            return None
        return Health.read(self.read_control, self.description.reply_max if self.description else 0)

    def set_dead_man(self, silence_s: float, *, timeout_s: float | None = None) -> None:
        """Let the device make its outputs safe after `silence_s` without a sign of life. 0: never.

        The URL option is `deadman`. The link gives signs of life by itself as long as this program runs.
        After a trip, writes raise DeadManTripped until `arm()`. DeviceMismatch: it has no dead-man.
        """
        self._native.set_dead_man(silence_s, timeout_s)

    def dead_man(self) -> DeadMan | None:
        """Ask the device for the state of its dead-man. Return None on a classic link, which has none."""
        if self.protocol != "framed":
            return None
        return DeadMan.read(self.read_control, self.configuration.base_hz)

    def arm(self, *, timeout_s: float | None = None) -> None:
        """Allow writes again after the dead-man has tripped, and start it again.

        Only this does it. A new link or a write does not. If it tripped in the session of this link, that
        session ends and a new one begins. Publishes go on. Raises DeviceMismatch on a classic link.
        """
        (self._server or self._native).arm(timeout_s)

    def trip(self, *, timeout_s: float | None = None) -> None:
        """Let the dead-man trip now. The device makes its outputs safe. Nothing is written before `arm()`.

        At a server this holds for all its clients. The link is silent for two ticks of the base rate
        meanwhile. `arm()` lets the dead-man run as before. Raises DeviceMismatch on a classic link, or if the
        device has no dead-man. Raises AccessRefused if the server lets this client write nothing.
        """
        (self._server or self._native).trip(timeout_s)

    @property
    def clock(self) -> Clock | None:
        """The device's clock in the host's time. None before the first subscription and on a classic link."""
        period_ns, drift_ppm, uncertainty_ns = self._native.clock()
        return Clock(period_ns, drift_ppm, uncertainty_ns) if period_ns > 0 else None

    def check_spec(self, spec: str, hashes: Sequence[int]) -> None:
        """Raise DeviceMismatch if the gateware was built from another spec than `spec` with `hashes`.

        Gateware that cannot tell passes (see `unverified`). With `spec_hash=any` a difference is only logged.
        """
        self.unverified = checked_spec(self._native, self.url, spec, hashes)

    # ---- the rest

    def statistics(self) -> Statistics:
        """Return the counters since the link was opened."""
        return Statistics(**self._native.statistics())

    @property
    def closed(self) -> bool:
        """Whether the link has ended, through close() or because the port is gone."""
        return self._native.closed

    def check_alive(self) -> None:
        """If the link has ended, raise LinkClosed with the reason."""
        self._native.check_alive()

    def close(self) -> None:
        """Stop the publishing that this link started, and close the port. Waiting callers get LinkClosed."""
        forget(self)
        first, self._unclosed = self._unclosed, False
        self._end()
        if first:
            self._warn()
        while self._on_close:
            self._on_close.pop()()

    def _end(self) -> None:
        self._native.close()
        self._callbacks.stop()
        for loop, mailbox in list(self._mailboxes.items()):
            if not loop.is_closed():
                loop.call_soon_threadsafe(mailbox.retire)
        self._mailboxes.clear()

    def _warn(self) -> None:
        """Warn once about a problem that does not stop the link."""
        if self._native.warning not in ("", self._warned):
            self._warned = self._native.warning
            warnings.warn(self._warned, RuntimeWarning, stacklevel=3)

    def call_on_close(self, action: Callable[[], None]) -> None:
        """Call `action` when the link is closed, for example to close its virtual board."""
        self._on_close.append(action)

    def disown(self) -> None:
        """Leave the link to the parent process after a fork."""
        forget(self)
        self._unclosed = False
        self._native.disown()
        self._callbacks.disown()
        self._mailboxes.clear()
        self._on_close.clear()

    def __del__(self) -> None:
        if self._unclosed:
            warnings.warn(f"unclosed {self!r}", ResourceWarning, stacklevel=1, source=self)
            self.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"<Link {self.url}{' (closed)' if self.closed else ''}>"
