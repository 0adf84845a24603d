# SPDX-License-Identifier: BSD-3-Clause
"""One typed word of the gateware, by name."""

from __future__ import annotations

import operator
from collections.abc import AsyncIterator, Callable
from typing import TYPE_CHECKING, SupportsIndex

from unitylink.errors import BindingError, LinkError, ValueRangeError

from .listeners import Listeners
from .publishing import Publisher

if TYPE_CHECKING:
    from unitylink.layer3_hardware import HardwareProxy

    from .group import ValueGroup


class Value:
    """A word at a final bus address, reached through a hardware proxy; signed ones are two's complement.

    `latest` is the value last read, published or written, None before.
    """

    access = ""

    def __init__(
        self,
        path: str,
        hardware: HardwareProxy,
        address: int,
        *,
        signed: bool = False,
        checked: bool = False,
        display: str = "",
        unit: str = "",
        publish: tuple[int, int] | None = None,
        publisher: Publisher | None = None,
    ) -> None:
        configuration = hardware.link.configuration
        if address >> 8 * configuration.address_bytes:
            raise BindingError(
                f"{path} lies at {address:#06x}, beyond the {configuration.address_bytes} address byte(s) of "
                f"{hardware.link.url}: this is not the board the spec is for"
            )
        bits = configuration.data_bits
        self.path = path
        self.hardware = hardware
        self.address = address
        self.signed = signed
        self.checked = True if checked else None  # None: as the link does
        self.display = display or path
        self.unit = unit
        self.publish = publish  # (mode, divisor) as in the spec
        self.publisher = publisher if publisher is not None else Publisher()
        self.sign = 1 << bits - 1 if signed else 0  # (word ^ sign) - sign is the value
        self.mask = (1 << bits) - 1
        self.minimum = -self.sign
        self.maximum = self.mask ^ self.sign
        self.latest: int | None = None
        self.listeners: Listeners[int] = Listeners(path)

    @property
    def relative_address(self) -> int:
        return self.address - self.hardware.base

    def __repr__(self) -> str:
        return f"<{self.access} {self.path} at {self.address:#06x}: {self.latest}>"


class ReadValue(Value):
    """A word the PC reads.

    >>> robot.j1.cpos.read()                      # doctest: +SKIP
    -1204
    >>> robot.j1.cpos.on_change(print)   # at each publish that brings a new value  # doctest: +SKIP
    """

    access = "READ"

    def __init__(
        self,
        path: str,
        hardware: HardwareProxy,
        address: int,
        *,
        signed: bool = False,
        checked: bool = False,
        display: str = "",
        unit: str = "",
        publish: tuple[int, int] | None = None,
        publisher: Publisher | None = None,
    ) -> None:
        super().__init__(
            path,
            hardware,
            address,
            signed=signed,
            checked=checked,
            display=display,
            unit=unit,
            publish=publish,
            publisher=publisher,
        )
        self.groups: tuple[ValueGroup, ...] = ()  # those that have listeners
        self._read = hardware.reader(self.relative_address, checked=self.checked)
        if publish is not None:
            self.publisher.add(self)

    def read(self, timeout_s: float | None = None) -> int:
        """Read the value; raise LinkError naming it where that fails."""
        try:
            word = self._read() if timeout_s is None else self._read(timeout_s=timeout_s)
        except LinkError as error:
            raise error.with_item(self.path)  # noqa: B904  the same error, now with its name
        self.latest = value = (word ^ self.sign) - self.sign
        return value

    async def read_async(self, timeout_s: float | None = None) -> int:
        """Read the value."""
        try:
            word = await self.hardware.read_async(
                self.relative_address, checked=self.checked, timeout_s=timeout_s
            )
        except LinkError as error:
            raise error.with_item(self.path)  # noqa: B904
        self.latest = value = (word ^ self.sign) - self.sign
        return value

    def on_publish(
        self, callback: Callable[[float, int], object], *, rate_hz: float | None = None
    ) -> Callable[[], None]:
        """Call `callback(time_s, value)` at each publish, and start publishing; return what takes it back.

        A value without PUBLISH in the spec needs `rate_hz`: the PC then polls it. `time_s` is monotonic host
        time. The callback runs in the link's callback thread; what it raises is logged and does not stop the
        others.
        """
        self.publisher.require(self, rate_hz)
        return self.listeners.on_publish(callback)

    def on_change(
        self, callback: Callable[[int], object], *, rate_hz: float | None = None
    ) -> Callable[[], None]:
        """Call `callback(value)` when a publish brings another value than before; else as `on_publish`."""
        self.publisher.require(self, rate_hz)
        return self.listeners.on_change(callback)

    def publishes(self, *, rate_hz: float | None = None) -> AsyncIterator[tuple[float, int]]:
        """Iterate over publishes: `async for time_s, value in robot.j1.cpos.publishes():`.

        Starts publishing as `on_publish` does; ends when publishing is stopped or the link is closed.
        """
        self.publisher.require(self, rate_hz)
        return self.listeners.stream(self.is_published)

    def is_published(self) -> bool:
        """Say whether publishes can come: publishing was started, and the link is open."""
        return self.publisher.active and not self.hardware.link.closed


class WriteValue(Value):
    """A word the PC writes.

    >>> robot.j1.pos_sp.write(-500)               # doctest: +SKIP
    >>> robot.j1.spd_sp.write(-1)                 # doctest: +SKIP
    Traceback (most recent call last):
    unitylink.errors.ValueRangeError: j1.spd_sp: -1 is not in 0 to 4294967295; nothing was sent
    """

    access = "WRITE"

    def __init__(
        self,
        path: str,
        hardware: HardwareProxy,
        address: int,
        *,
        signed: bool = False,
        checked: bool = False,
        display: str = "",
        unit: str = "",
    ) -> None:
        super().__init__(path, hardware, address, signed=signed, checked=checked, display=display, unit=unit)
        hardware.declare_outputs([self.relative_address])

    def word(self, value: SupportsIndex) -> int:
        """Return the raw word for `value`; raise ValueRangeError naming the item and its range."""
        try:
            number = operator.index(value)
        except TypeError:
            raise ValueRangeError(
                f"{self.path}: {value!r} is not an integer; round it first. Nothing was sent"
            ) from None
        if not self.minimum <= number <= self.maximum:
            raise ValueRangeError(
                f"{self.path}: {number} is not in {self.minimum} to {self.maximum}; nothing was sent"
            )
        return number & self.mask

    def write(self, value: SupportsIndex, timeout_s: float | None = None) -> None:
        """Write the value (on TosNet: with a commit); raise ValueRangeError before anything is sent."""
        word = self.word(value)
        try:
            self.hardware.write(self.relative_address, word, checked=self.checked, timeout_s=timeout_s)
        except LinkError as error:
            raise error.with_item(self.path)  # noqa: B904
        self.latest = operator.index(value)

    async def write_async(self, value: SupportsIndex, timeout_s: float | None = None) -> None:
        """Write the value."""
        word = self.word(value)
        try:
            await self.hardware.write_async(
                self.relative_address, word, checked=self.checked, timeout_s=timeout_s
            )
        except LinkError as error:
            raise error.with_item(self.path)  # noqa: B904
        self.latest = operator.index(value)
