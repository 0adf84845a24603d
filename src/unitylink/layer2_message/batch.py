# SPDX-License-Identifier: BSD-3-Clause
"""Batch: operations that are collected and done together."""

from __future__ import annotations

from collections.abc import Iterable
from types import TracebackType
from typing import TYPE_CHECKING

from unitylink import protocol as p

if TYPE_CHECKING:
    from typing_extensions import Self

    from unitylink._native import NativeLink


class Pending:
    """A word that a batch reads at its end."""

    def __init__(self, address: int) -> None:
        """Made by Batch.read."""
        self.address = address
        self._value: int | None = None

    @property
    def value(self) -> int:
        """The word. Raises RuntimeError before the batch has ended, or if it failed."""
        if self._value is None:
            raise RuntimeError(
                f"the batch has not read 0x{self.address:x} yet: it reads at the end of its with block"
            )
        return self._value

    def _set(self, value: int) -> None:
        self._value = value


class Batch:
    """Collects operations, and does them in their order at the end of its `with` block.

    On a framed link it takes one message each way if the device's buffers allow that, or else several. Each
    operation is executed once. If the device was reset, OutcomeUnknown is raised. Nothing is sent if the
    block raises. On a classic link, they are reads and writes one after another. Requests of other threads
    may come between them.
    """

    def __init__(self, engine: NativeLink, *, atomic: bool = False) -> None:
        """Made by Link.batch."""
        self._engine = engine
        self._atomic = atomic
        self._steps: list[tuple[int, int, int, int]] = []  # (operation, address, value, mask)
        self._reads: list[Pending] = []

    def read(self, address: int) -> Pending:
        """Read the word at `address`."""
        return self._read(p.LIST_OPERATION_READ, address)

    def read_many(self, addresses: Iterable[int]) -> list[Pending]:
        """Read words. The message names only the first of addresses in a row."""
        return [self.read(address) for address in addresses]

    def read_fifo(self, address: int, count: int) -> list[Pending]:
        """Read `address` several times, as for a FIFO. No word is lost or taken twice."""
        return [self._read(p.LIST_OPERATION_READ_FIFO, address) for _ in range(count)]

    def write(self, address: int, value: int) -> None:
        """Write `value` to `address`."""
        self._steps.append((p.LIST_OPERATION_WRITE, address, value, 0))

    def write_many(self, addresses: Iterable[int], values: Iterable[int]) -> None:
        """Write `values` to `addresses`. The message names only the first of addresses in a row."""
        for address, value in zip(addresses, values, strict=True):
            self.write(address, value)

    def write_fifo(self, address: int, values: Iterable[int]) -> None:
        """Write all `values` to one address, as into a FIFO."""
        self._steps += [(p.LIST_OPERATION_WRITE_FIFO, address, value, 0) for value in values]

    def write_masked(self, address: int, mask: int, value: int) -> None:
        """Write only the bits of `value` that are set in `mask`. The device keeps its other bits."""
        self._steps.append((p.LIST_OPERATION_WRITE_MASKED, address, value, mask))

    def add(self, address: int, value: int) -> None:
        """Add `value` to the word at `address`, which wraps around."""
        self._steps.append((p.LIST_OPERATION_ADD, address, value, 0))

    def _read(self, operation: int, address: int) -> Pending:
        pending = Pending(address)
        self._reads.append(pending)
        self._steps.append((operation, address, 0, 0))
        return pending

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if kind is not None or not self._steps:
            return
        operations, addresses, values, masks = zip(*self._steps, strict=True)
        words = self._engine.do_list(
            operations, addresses, values, masks, len(self._reads), self._atomic, None
        )
        for pending, word in zip(self._reads, words.tolist(), strict=True):
            pending._set(word)
