# SPDX-License-Identifier: BSD-3-Clause
"""Outputs that take effect together by a commit, in gateware that swaps two buffers without copying."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from unitylink.errors import AccessRefused, OutcomeUnknown, ValueRangeError

from .arguments import positive, wholes
from .proxy import HardwareProxy

if TYPE_CHECKING:
    from typing_extensions import Self

    from unitylink.layer2_message import Link

_NAMES_MOST = 8  # in an error


class CommittedProxy(HardwareProxy):
    """Write outputs in bursts, each ended by one commit.

    The gateware swaps its buffers at a commit and does not copy them. So a word that is not written before a
    commit goes back to its value of two commits ago. Therefore the proxy keeps a shadow of every output that
    is declared or written, and writes all of them before each commit. A word that the proxy does not know yet
    is first read from the device. So a running robot does not jump. After a line has come back
    (`reconnect=1`) or a device has restarted, the proxy knows none of its words.

    The words of a burst may be sent twice, but a commit never is. If the reply of a commit is lost,
    OutcomeUnknown is raised.

    >>> with proxy.batch():            # doctest: +SKIP
    ...     proxy.write(0x8C, 100)     # nothing is sent yet
    ...     proxy.write(0x8D, 200)     # both take effect together at the end of the block
    """

    kind = "committed memory"
    repeatable_writes = True
    commit_address = 0  # relative; the subclass or instance sets it
    pending_bits = (0, 1)
    """A mask of the word that a commit reads, and the bits that say that it waits. These say: never."""
    # how long the commit after a burst may take; the gateware takes it within one cycle
    commit_timeout_s = 0.5

    def __init__(
        self, link: Link, base: int = 0, *, words: int | None = None, control: Link | None = None
    ) -> None:
        super().__init__(link, base, words=words)
        self.control = control if control is not None else link  # commits and status words go there
        self._lock = threading.RLock()
        # relative address -> last committed word, or None if unknown
        self._outputs: dict[int, int | None] = {}
        self._names: dict[int, str] = {}  # of outputs, for errors
        self._staged: dict[int, int] | None = None
        self._staged_checked: bool | None = None
        self._batch_thread: int | None = None
        self._settled = False  # true if no commit of ours can be pending
        self._generation = self._generation_now()
        self._in_frames = self.control is self.link and link.protocol == "framed"

    @property
    def outputs(self) -> dict[int, int | None]:
        """The shadow: relative address -> word as last committed.

        It is None if the word has not been read yet.
        """
        with self._lock:
            return dict(self._outputs)

    def declare_outputs(self, addresses: Iterable[int], name: str = "") -> None:
        """Let each commit write these words, too. At first they have their values in the device.

        `name` is what errors call them.
        """
        with self._lock:
            for address in wholes(f"{self.kind}: addresses", addresses):
                self._check_output(address)
                self._outputs.setdefault(address, None)
                self._names[address] = name or f"{self.base + address:#06x}"

    @contextmanager
    def batch(self) -> Iterator[Self]:
        """Collect this thread's writes and commit them once at the end. If the block raises, send nothing.

        Other threads wait. A batch inside a batch joins it. If the inner one raises, only its writes are
        dropped.
        """
        with self._lock:
            if self._staged is not None:
                before = dict(self._staged)
                try:
                    yield self
                except BaseException:
                    self._staged = before
                    raise
                return
            self._staged, self._staged_checked = {}, None
            self._batch_thread = threading.get_ident()
            try:
                yield self
                staged, checked = self._staged, self._staged_checked
            finally:
                self._staged = self._batch_thread = None
            if staged:
                self._burst(staged, checked, None)

    def write(
        self, address: int, value: int, *, checked: bool | None = None, timeout_s: float | None = None
    ) -> None:
        """Write one word and commit, or add it to the open batch."""
        self.write_many((address,), (value,), checked=checked, timeout_s=timeout_s)

    def write_many(
        self,
        addresses: Iterable[int],
        values: Iterable[int],
        *,
        checked: bool | None = None,
        timeout_s: float | None = None,
    ) -> None:
        """Write words that take effect together, in one burst with one commit, or add them to the batch."""
        where, words = wholes(f"{self.kind}: addresses", addresses), wholes(f"{self.kind}: values", values)
        if len(where) != len(words):
            raise ValueRangeError(f"{self.kind}: {len(where)} addresses and {len(words)} values")
        for address in where:
            if address not in self._outputs:  # those have been checked
                self._check_output(address)
        self._check_words(words)
        self.write_burst(where, words, checked=checked, timeout_s=timeout_s)

    def write_burst(
        self, addresses: list[int], words: list[int], *, checked: bool | None, timeout_s: float | None
    ) -> None:
        """Write words that have been checked, as `write_many` does."""
        with self._lock:
            if self._staged is not None:
                self._staged.update(zip(addresses, words, strict=True))
                self._staged_checked = checked if checked is not None else self._staged_checked
            elif addresses:
                self._burst(dict(zip(addresses, words, strict=True)), checked, timeout_s)

    async def write_async(
        self, address: int, value: int, *, checked: bool | None = None, timeout_s: float | None = None
    ) -> None:
        """Write one word and commit."""
        await self.write_many_async((address,), (value,), checked=checked, timeout_s=timeout_s)

    async def write_many_async(
        self,
        addresses: Iterable[int],
        values: Iterable[int],
        *,
        checked: bool | None = None,
        timeout_s: float | None = None,
    ) -> None:
        """Write words that take effect together.

        Another burst must not come between its messages, sync or async. So it runs under the lock, in a
        worker thread, and the event loop stays free. Cancelling the await does not take it back.
        """
        if self.collects_here:  # the worker would wait for the end of the batch
            self.write_many(addresses, values, checked=checked)
            return
        await asyncio.to_thread(self.write_many, addresses, values, checked=checked, timeout_s=timeout_s)

    @property
    def collects_here(self) -> bool:
        return self._batch_thread == threading.get_ident()

    def commit(self, *, timeout_s: float | None = None) -> None:
        """Write every known output again and commit. Use it after an OutcomeUnknown."""
        with self._lock:
            self._burst({}, None, timeout_s)

    def _check_output(self, address: int) -> None:
        self.bus_address(address)

    def _burst(self, changes: dict[int, int], checked: bool | None, timeout_s: float | None) -> None:
        patience_s = self.commit_timeout_s if timeout_s is None else positive("timeout_s", timeout_s)
        self._forget_old()
        if not self._settled:
            self._settle(patience_s, committed=False)
        if not changes.keys() <= self._outputs.keys():
            for address in changes:  # if this burst fails half-way, the next one must write these words too
                self._outputs.setdefault(address, None)
        try:
            words = self._all_words(changes, timeout_s)
        except AccessRefused as error:
            raise self._refused(error)  # noqa: B904  the same error, now with its remedy
        self._settled = False  # whatever happens from here on, check before the next burst
        commit = self.base + self.commit_address
        base = self.base
        addresses = [base + address for address in words] if base else list(words)
        values = list(words.values())
        status = None
        try:
            if self._in_frames:  # in one message, and each message is executed once
                status = self.link.commit(addresses, values, commit, self.pending_bits, timeout_s=timeout_s)
            else:
                self.link.write_many(addresses, values, checked=checked, repeat=True, timeout_s=timeout_s)
                self.control.write(commit, 1, checked=checked, repeat=False, timeout_s=timeout_s)
        except AccessRefused as error:
            raise self._refused(error)  # noqa: B904
        except OutcomeUnknown as error:
            # the commit may have happened, and a later return to the old values would be a jump
            self._outputs.update(changes)
            raise OutcomeUnknown(
                f"{self.kind}: the commit of {len(words)} words at {commit:#06x} was sent and its reply "
                "lost; it may or may not have taken effect and was not repeated. "
                "commit() writes the same words and commits again",
                address=commit,
                attempts=error.attempts,
                elapsed_s=error.elapsed_s,
            ) from error
        self._outputs.update(changes)
        self._settle(patience_s, committed=True, status=status)
        self._settled = True

    def _refused(self, error: AccessRefused) -> AccessRefused:
        """Say what a token needs that may write some outputs of this memory only."""
        names = list(dict.fromkeys(self._names.get(one, f"{self.base + one:#06x}") for one in self._outputs))
        if len(names) > 1:
            more = f" and {len(names) - _NAMES_MOST} more" if len(names) > _NAMES_MOST else ""
            error.message += (
                ". A commit writes all outputs of this memory, so the token needs the scope `write` of "
                f"each: {', '.join(names[:_NAMES_MOST])}{more}"
            )
        return error

    def _generation_now(self) -> tuple[int, int]:
        first = self.link.generation
        return first, first if self.control is self.link else self.control.generation

    def _forget_old(self) -> None:
        """After a line has come back or a device has restarted, forget the shadow.

        So no old set-point is repeated.
        """
        if (generation := self._generation_now()) != self._generation:
            self._outputs = dict.fromkeys(self._outputs)
            self._settled, self._generation = False, generation

    def _all_words(self, changes: dict[int, int], timeout_s: float | None) -> dict[int, int]:
        """Return all words that a commit writes. Read those that are unknown, and do not change."""
        outputs = self._outputs
        if None not in outputs.values():
            return outputs | changes  # type: ignore[return-value]  # none of them is None
        known = {address: word for address, word in outputs.items() if word is not None}
        unknown = [a for a, word in outputs.items() if word is None and a not in changes]
        if unknown:
            words = self.link.read_many(
                [self.base + address for address in unknown], repeat=True, timeout_s=timeout_s
            )
            outputs.update(zip(unknown, (int(word) for word in words), strict=True))
            known = {address: word for address, word in outputs.items() if word is not None}
        return known | changes

    def _settle(self, patience_s: float, *, committed: bool, status: int | None = None) -> None:
        """Wait until no commit is pending. After our own commit (`committed`), raise if it was dropped.

        `status` is the status word, if it was read with the commit.
        """
