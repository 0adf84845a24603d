# SPDX-License-Identifier: BSD-3-Clause
"""Values that the PC reads."""

from __future__ import annotations

from collections.abc import AsyncIterator, Callable
from typing import TypeVar

from unitylink.errors import LinkError

from .value import Value

T = TypeVar("T")


class ReadValue(Value[T]):
    """A value that the PC reads, in engineering units.

    >>> robot.j1.cpos.read()                      # doctest: +SKIP
    -1.204
    >>> robot.j1.cpos.on_change(print)   # at each publish that brings a new value  # doctest: +SKIP
    """

    access = "READ"
    pollable = True

    def _prepare(self) -> None:
        super()._prepare()
        self._repeat = self.pollable and self.hardware.repeatable_reads
        self._sign = self.codec.integer_sign  # the fast way is for one word that needs at most a sign
        self._mask = self.codec.mask
        self._many = self.codec.words > 1
        self._reader = self.hardware.reader(self.relative_address, checked=self.checked, repeat=self._repeat)
        if self.publish is not None:
            self.publisher.add(self)

    def read(self, timeout_s: float | None = None) -> T:
        """Read the value. If that fails, raise a LinkError that names it.

        A value of several words is read in one bus transaction, so its words are of one moment.
        """
        try:
            if self._many:
                words = self.hardware.read_many(
                    self.relative_addresses,
                    atomic=True,
                    checked=self.checked,
                    repeat=self._repeat,
                    timeout_s=timeout_s,
                )
                return self.take(self.codec.join(words.tolist()))
            word = self._reader() if timeout_s is None else self._reader(timeout_s=timeout_s)
        except LinkError as error:
            raise error.with_item(self.path)  # noqa: B904  the same error, now with its name
        sign = self._sign
        if sign is None:
            return self.take(word)
        self.raw = word
        self.latest = value = ((word & self._mask) ^ sign) - sign  # type: ignore[assignment]  # T is int
        return value  # type: ignore[return-value]

    async def read_async(self, timeout_s: float | None = None) -> T:
        """Read the value, as `read`."""
        try:
            if not self._many:
                return self.take(
                    await self.hardware.read_async(
                        self.relative_address,
                        checked=self.checked,
                        repeat=self._repeat,
                        timeout_s=timeout_s,
                    )
                )
            words = await self.hardware.read_many_async(
                self.relative_addresses,
                atomic=True,
                checked=self.checked,
                repeat=self._repeat,
                timeout_s=timeout_s,
            )
        except LinkError as error:
            raise error.with_item(self.path)  # noqa: B904
        return self.take(self.codec.join(words.tolist()))

    def on_publish(
        self, callback: Callable[[float, T], object], *, rate_hz: float | None = None
    ) -> Callable[[], None]:
        """Start publishing, and call `callback(time_s, value)` at each publish.

        Return a function that stops it.

        A value without PUBLISH in the spec needs `rate_hz`. The PC then polls it. `time_s` is monotonic host
        time. The callback runs in the link's callback thread. An exception in it is logged and does not stop
        the others.
        """
        return self._with_publishes(self.listeners.on_publish(callback), rate_hz)

    def on_change(
        self, callback: Callable[[T], object], *, rate_hz: float | None = None
    ) -> Callable[[], None]:
        """Call `callback(value)` when a publish brings a new value. Otherwise it is like `on_publish`."""
        return self._with_publishes(self.listeners.on_change(callback), rate_hz)

    def publishes(self, *, rate_hz: float | None = None) -> AsyncIterator[tuple[float, T]]:
        """Iterate over publishes: `async for time_s, value in robot.j1.cpos.publishes():`.

        It starts publishing as `on_publish` does. It ends when publishing is stopped or the link is closed.
        For a value that is published on change, it begins with the newest value.
        """
        return self.listeners.stream(
            lambda: self.publisher.require(self, rate_hz),
            self.is_published,
            lambda: self.publisher.newest(self),
        )

    def _with_publishes(self, take_back: Callable[[], None], rate_hz: float | None) -> Callable[[], None]:
        """Start the publishes for a listener. The listener is registered before the first publish."""
        try:
            self.publisher.require(self, rate_hz)
        except BaseException:
            take_back()
            raise
        return take_back

    def is_published(self) -> bool:
        """Return whether publishes can come: publishing has been started, and the link is open."""
        return self.publisher.active and not self.hardware.link.closed


class ReadClearValue(ReadValue[T]):
    """A value that a read changes, such as a counter that is zero afterwards. It is read only by its name.

    No read is repeated, because a lost reply may have taken the value with it (LinkTimeout). Snapshots of a
    node and `watch` leave it out.
    """

    access = "READCLEAR"
    pollable = False
