# SPDX-License-Identifier: BSD-3-Clause
"""ExchangeGroup: words that are named once, and then written and read as bare data."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from types import TracebackType
from typing import TYPE_CHECKING, Any, Union

import numpy.typing as npt

from .native_link import Words

if TYPE_CHECKING:
    from typing_extensions import Self

    from unitylink._native import NativeLink

Word = Union[int, tuple[int, int]]
"""An address, or an address and how many bytes of its word travel, the low ones."""


class ExchangeGroup:
    """Outputs and inputs that are written and read in one message each way, with the bus held.

    Made by `Link.exchange_group`. After a reset of the device, the link defines it again by itself.

    >>> with link.exchange_group(writes=[0x20, (0x21, 1)], reads=[0x10]) as group:    # doctest: +SKIP
    ...     position, = group.exchange([1000, 1])
    """

    def __init__(
        self, engine: NativeLink, writes: Iterable[Word], reads: Iterable[Word], data_bytes: int
    ) -> None:
        self.writes = tuple(_word(word, data_bytes) for word in writes)
        self.reads = tuple(_word(word, data_bytes) for word in reads)
        self.atomic = engine.protocol == "framed"
        """Whether nothing can come between: False on a classic link, where it is writes and then reads."""
        self._engine = engine
        self._id = engine.define_exchange(
            [address for address, _ in self.writes],
            [size for _, size in self.writes],
            [address for address, _ in self.reads],
            [size for _, size in self.reads],
        )

    def exchange(
        self, words: Sequence[int] | npt.NDArray[Any] = (), *, timeout_s: float | None = None
    ) -> Words:
        """Write `words`, one for each of `writes`. Then return the words of `reads`.

        Raises ValueRangeError for a wrong number of words, or for a word that is too large for its bytes.
        Raises OutcomeUnknown if the device was reset meanwhile, or DeadManTripped.
        """
        return self._engine.exchange(self._id, words, len(self.reads), timeout_s)

    def close(self) -> None:
        """Release the device's group. Calling it twice does no harm."""
        self._engine.release_exchange(self._id)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


def _word(word: Word, data_bytes: int) -> tuple[int, int]:
    return word if isinstance(word, tuple) else (word, data_bytes)
