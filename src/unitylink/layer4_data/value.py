# SPDX-License-Identifier: BSD-3-Clause
"""One typed value of the gateware, by name: what reads and writes have in common."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from unitylink.errors import BindingError, DeviceMismatch
from unitylink.spec.model import Publish
from unitylink.spec.types import INT32
from unitylink.values import Codec, Quantity

from .html import values_html
from .listeners import Listeners
from .published import PublishedGroup
from .publishing import Publisher

if TYPE_CHECKING:
    from unitylink.layer3_hardware import HardwareProxy

T = TypeVar("T")


class Value(Generic[T]):
    """A value at an absolute bus address, reached through a hardware proxy.

    `quantity` says what the value means to its user. Without one, it is an integer as wide as the bus, in
    two's complement if `signed`. A value wider than the bus takes `words` consecutive words, the low one
    first. `latest` is the value that was last read, published or written. `raw` is its number on the wire.
    Both are None before that.

    Raises BindingError if the board does not belong to the spec. Raises DeviceMismatch for a PULSE or a value
    with SAFE, if the link has fallen back to the classic protocol by itself.
    """

    access = ""
    pollable = False  # whether it may be read without being named
    writable = False  # whether it keeps what is written

    def __init__(
        self,
        path: str,
        hardware: HardwareProxy,
        address: int,
        *,
        quantity: Quantity | None = None,
        signed: bool = False,
        words: int | None = None,
        checked: bool = False,
        display: str = "",
        publish: Publish | tuple[int, int] | None = None,
        line: int | None = None,
        publisher: Publisher | None = None,
        classes: Mapping[str, type[Any]] | None = None,
    ) -> None:
        configuration = hardware.link.configuration
        if quantity is None:
            quantity = Quantity(INT32) if signed else Quantity()
        self.codec = Codec(path, quantity, configuration.data_bits, classes, commanded=True)
        if words is not None and words != self.codec.words:
            raise BindingError(
                f"{path} takes {words} word(s) in the spec and {self.codec.words} on {hardware.link.url}, "
                f"whose words have {configuration.data_bits} bits: this is not the board the spec is for"
            )
        if (address + self.codec.words - 1) >> 8 * configuration.address_bytes:
            raise BindingError(
                f"{path} lies at {address:#06x}, beyond the {configuration.address_bytes} address byte(s) of "
                f"{hardware.link.url}: this is not the board the spec is for"
            )
        if hardware.link.notice and (reason := quantity.asks_for_frames(self.access)):
            raise DeviceMismatch(
                f"{path} {reason}, which needs the framed protocol, but {hardware.link.url} has fallen "
                f"back to the classic one: {hardware.link.notice}. Use gateware with the framed protocol, "
                "or add protocol=classic to the URL if you want that"
            )
        self.path = path
        self.hardware = hardware
        self.address = address
        self.addresses = tuple(range(address, address + self.codec.words))
        self.relative_addresses = [address - hardware.base for address in self.addresses]
        self.quantity = quantity
        self.checked = True if checked else None  # None stands for the link's default
        self.display = display or path
        given = Publish(*publish) if isinstance(publish, tuple) else publish
        # The rate follows from the base rate of the device, which may differ from the spec's.
        self.publish = replace(given, rate_hz=None) if given is not None else None
        self.line = line  # the gateware's group whose event line triggers the publish
        self.publisher = publisher if publisher is not None else Publisher()
        self.latest: T | None = None
        self.raw: int | None = None
        self.listeners: Listeners[T] = Listeners(path)
        self.groups: tuple[PublishedGroup, ...] = ()  # those groups that have listeners
        self._prepare()

    def _prepare(self) -> None:
        """Prepare what this kind of access needs. A class that combines two kinds does both."""

    @property
    def unit(self) -> str:
        return self.quantity.unit

    @property
    def signed(self) -> bool:
        return self.quantity.type.signed

    @property
    def minimum(self) -> Any:
        """The smallest value that can be written, in `unit`. It is the spec's limit, or else the type's."""
        return self.codec.minimum

    @property
    def maximum(self) -> Any:
        """The largest value that can be written, in `unit`."""
        return self.codec.maximum

    @property
    def relative_address(self) -> int:
        return self.address - self.hardware.base

    def take(self, raw: int) -> T:
        """Make a raw number that was read or published the latest value. Return the latest value."""
        value: T = self.codec.decode(raw)
        self.raw, self.latest = raw, value
        return value

    def _repr_html_(self) -> str:
        """Return what a notebook shows."""
        return values_html(self.display, [self])

    def __repr__(self) -> str:
        shown = None if self.latest is None else self.quantity.text(self.latest)
        return f"<{self.access} {self.path} at {self.address:#06x}: {shown}>"
