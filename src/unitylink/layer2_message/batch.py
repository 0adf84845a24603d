# SPDX-License-Identifier: BSD-3-Clause
"""Batch: reads and writes that are collected and done together."""

from __future__ import annotations

from types import TracebackType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from typing_extensions import Self

    from .link import Link


class Pending:
    """A word that a batch will have read at its end."""

    def __init__(self, address: int) -> None:
        """Made by Batch.read."""
        self.address = address
        self._value: int | None = None

    @property
    def value(self) -> int:
        """The word; RuntimeError before the batch has ended, or when it failed."""
        if self._value is None:
            raise RuntimeError(
                f"the batch has not read 0x{self.address:x} yet: it does so where its with block ends"
            )
        return self._value

    def _set(self, value: int) -> None:
        self._value = value


class Batch:
    """Collects reads and writes; at the end of its with block it does all writes, then all reads.

    One message each way where the link is framed and the device's buffers allow. Nothing is sent when the
    block raises.
    """

    def __init__(self, link: Link, *, atomic: bool = False) -> None:
        """Made by Link.batch."""
        self._link = link
        self._atomic = atomic
        self._writes: list[tuple[int, int]] = []
        self._reads: list[Pending] = []

    def read(self, address: int) -> Pending:
        """Read the word at `address`, after all writes of the batch."""
        pending = Pending(address)
        self._reads.append(pending)
        return pending

    def write(self, address: int, value: int) -> None:
        """Write `value` to `address`; writes are done in order."""
        self._writes.append((address, value))

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if kind is not None or not (self._writes or self._reads):
            return
        addresses = [pending.address for pending in self._reads]
        words = self._link.exchange(addresses, self._writes, atomic=self._atomic)
        for pending, word in zip(self._reads, words.tolist(), strict=True):
            pending._set(word)
