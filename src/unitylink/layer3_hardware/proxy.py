# SPDX-License-Identifier: BSD-3-Clause
"""What all hardware proxies share: words at relative addresses, and which requests may be repeated."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

from unitylink.errors import ValueRangeError, shown

from .arguments import at, whole, wholes

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from unitylink.layer2_message import Link, Subscription


class HardwareProxy:
    """The words of one gateware module, addressed from its base.

    Values are raw unsigned words of the link's data width. `repeatable_reads` and `repeatable_writes` of a
    subclass say which requests the link may repeat after a lost reply.

    >>> led = MemoryProxy(link, base=0x40)   # doctest: +SKIP
    >>> led.write(2, 0xFF)                   # the bus sees address 0x42  # doctest: +SKIP
    """

    kind = "hardware"
    repeatable_reads = True
    repeatable_writes = False

    def __init__(self, link: Link, base: int = 0, *, words: int | None = None) -> None:
        self.link = link
        self.base = whole(f"{self.kind}: base", base)
        if self.base < 0:
            raise ValueRangeError(f"{self.kind}: base {shown(base)} is negative")
        self.words = words  # how many words the module has, if that is known

    @property
    def collects_here(self) -> bool:
        """Return whether the writes of this thread are sent only later, at the end of a batch."""
        return False

    def bus_address(self, address: int) -> int:
        """Return the bus address of a relative one. Raises ValueRangeError if the module has no such word."""
        address = whole(f"{self.kind} at {self.base:#06x}: address", address)
        if address < 0 or (self.words is not None and address >= self.words):
            held = "" if self.words is None else f"; it has words 0 to {self.words - 1:#x}"
            raise ValueRangeError(f"{self.kind} at {self.base:#06x}: no word {at(address)}{held}")
        return self.base + address

    def bus_addresses(self, addresses: Iterable[int]) -> list[int]:
        where = f"{self.kind} at {self.base:#06x}: addresses"
        return [self.bus_address(address) for address in wholes(where, addresses)]

    def reader(self, address: int, *, checked: bool | None = None, repeat: bool = True) -> Callable[..., int]:
        """Return a function that reads one word.

        The function looks nothing up, so it is fast for callers that read often.
        """
        return partial(
            self.link.read,
            self.bus_address(address),
            checked=checked,
            repeat=repeat and self.repeatable_reads,
        )

    def read(self, address: int, *, checked: bool | None = None, timeout_s: float | None = None) -> int:
        """Read one word."""
        return self.link.read(
            self.bus_address(address), checked=checked, repeat=self.repeatable_reads, timeout_s=timeout_s
        )

    def read_many(
        self,
        addresses: Iterable[int],
        *,
        atomic: bool = False,
        checked: bool | None = None,
        repeat: bool = True,
        timeout_s: float | None = None,
    ) -> NDArray[np.uint32]:
        """Read many words. With `atomic` they come from one bus transaction, so they are of one moment.

        `repeat=False` is for words that a read changes.
        """
        return self.link.read_many(
            self.bus_addresses(addresses),
            atomic=atomic,
            checked=checked,
            repeat=repeat and self.repeatable_reads,
            timeout_s=timeout_s,
        )

    def write(
        self, address: int, value: int, *, checked: bool | None = None, timeout_s: float | None = None
    ) -> None:
        """Write one word."""
        self.link.write(
            self.bus_address(address),
            whole(f"{self.kind} at {self.base:#06x}: value", value),
            checked=checked,
            repeat=self.repeatable_writes,
            timeout_s=timeout_s,
        )

    def write_many(
        self,
        addresses: Iterable[int],
        values: Iterable[int],
        *,
        checked: bool | None = None,
        timeout_s: float | None = None,
    ) -> None:
        """Write many words, in order, without waiting for each reply."""
        self.link.write_many(
            *self._pairs(addresses, values),
            checked=checked,
            repeat=self.repeatable_writes,
            timeout_s=timeout_s,
        )

    def write_burst(
        self, addresses: list[int], words: list[int], *, checked: bool | None, timeout_s: float | None
    ) -> None:
        """Write words that have been checked, as `write_many` does."""
        self.link.write_many(
            [self.base + address for address in addresses],
            words,
            checked=checked,
            repeat=self.repeatable_writes,
            timeout_s=timeout_s,
        )

    async def read_async(
        self,
        address: int,
        *,
        checked: bool | None = None,
        repeat: bool = True,
        timeout_s: float | None = None,
    ) -> int:
        """Read one word."""
        return await self.link.read_async(
            self.bus_address(address),
            checked=checked,
            repeat=repeat and self.repeatable_reads,
            timeout_s=timeout_s,
        )

    async def read_many_async(
        self,
        addresses: Iterable[int],
        *,
        atomic: bool = False,
        checked: bool | None = None,
        repeat: bool = True,
        timeout_s: float | None = None,
    ) -> NDArray[np.uint32]:
        """Read many words. With `atomic` they come from one bus transaction."""
        return await self.link.read_many_async(
            self.bus_addresses(addresses),
            atomic=atomic,
            checked=checked,
            repeat=repeat and self.repeatable_reads,
            timeout_s=timeout_s,
        )

    async def write_async(
        self, address: int, value: int, *, checked: bool | None = None, timeout_s: float | None = None
    ) -> None:
        """Write one word."""
        await self.link.write_async(
            self.bus_address(address),
            whole(f"{self.kind} at {self.base:#06x}: value", value),
            checked=checked,
            repeat=self.repeatable_writes,
            timeout_s=timeout_s,
        )

    async def write_many_async(
        self,
        addresses: Iterable[int],
        values: Iterable[int],
        *,
        checked: bool | None = None,
        timeout_s: float | None = None,
    ) -> None:
        """Write many words, in order."""
        await self.link.write_many_async(
            *self._pairs(addresses, values),
            checked=checked,
            repeat=self.repeatable_writes,
            timeout_s=timeout_s,
        )

    def subscribe(self, addresses: Iterable[int], **options: Any) -> Subscription:
        """Let the gateware publish words as one group: with `divisor=` of the base rate, or `on_event=True`.

        The link first reads each address once, if that has no side effect.
        """
        options.setdefault("verify", self.repeatable_reads)
        for name in ("divisor", "ring"):
            if name in options:
                options[name] = whole(f"{self.kind} at {self.base:#06x}: {name}", options[name])
        return self.link.subscribe(self.bus_addresses(addresses), **options)

    def declare_outputs(self, addresses: Iterable[int], name: str = "") -> None:
        """Name the words that the PC sets. Only proxies with a commit need this."""
        self.bus_addresses(addresses)

    def _pairs(self, addresses: Iterable[int], values: Iterable[int]) -> tuple[list[int], list[int]]:
        bus = self.bus_addresses(addresses)
        words = wholes(f"{self.kind} at {self.base:#06x}: values", values)
        if len(bus) != len(words):
            raise ValueRangeError(f"{self.kind}: {len(bus)} addresses and {len(words)} values")
        return bus, words

    def _check_words(self, values: Sequence[int]) -> None:
        """Refuse words that do not fit the bus, before any is sent."""
        bits = self.link.configuration.data_bits
        if values and min(values) >= 0 and max(values) >> bits == 0:
            return
        for value in values:
            if not 0 <= value < 1 << bits:
                raise ValueRangeError(f"{self.kind}: {shown(value)} does not fit a raw word of {bits} bits")

    def __repr__(self) -> str:
        return f"<{type(self).__name__} at {self.base:#06x} of {getattr(self.link, 'url', '?')}>"
