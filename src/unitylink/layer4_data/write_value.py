# SPDX-License-Identifier: BSD-3-Clause
"""Values that the PC writes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, SupportsIndex, TypeVar

from unitylink.errors import BindingError, LinkError, ValueRangeError
from unitylink.layer3_hardware import CommittedProxy

from .read_value import ReadValue
from .value import Value

T = TypeVar("T")


class WriteValue(Value[T]):
    """A value that the PC writes, in engineering units.

    >>> robot.j1.pos_sp.write(-0.5)               # doctest: +SKIP
    >>> robot.j1.pos_sp = -0.5                    # doctest: +SKIP
    Traceback (most recent call last):
    unitylink.errors.AssignmentError: j1.pos_sp cannot be replaced by -0.5; write it: j1.pos_sp.write(-0.5)
    >>> robot.j1.spd_sp.write(-1)                 # doctest: +SKIP
    Traceback (most recent call last):
    unitylink.errors.ValueRangeError: j1.spd_sp: -1 is not in 0 to 4294967295; nothing was sent
    """

    access = "WRITE"
    writable = True
    recorders: tuple[Callable[[WriteValue[Any], int], None], ...] = ()
    """The functions that are called after each write, with its raw number."""

    def _prepare(self) -> None:
        super()._prepare()
        self.hardware.declare_outputs(self.relative_addresses, self.path)

    def wrote(self, raw: int) -> None:
        """Make a raw number that was written the latest value, and tell the recorders."""
        self.take(raw)
        for heard in self.recorders:
            heard(self, raw)

    def encode(self, value: T | SupportsIndex) -> int:
        """Return the raw number for `value`.

        Raises ValueRangeError, which names the item, its range and its unit.
        """
        return self.codec.encode(value)

    def write(self, value: T | SupportsIndex, timeout_s: float | None = None) -> None:
        """Write the value. On TosNet, a commit follows. Raises ValueRangeError before anything is sent.

        A value of several words is sent in one burst, with the low word first. In plain memory, the gateware
        must take over the value when the high word comes. Behind a commit, all words take effect together.
        """
        raw = self.encode(value)
        try:
            if self.codec.words == 1:
                self.hardware.write(self.relative_address, raw, checked=self.checked, timeout_s=timeout_s)
            else:
                self.hardware.write_many(
                    self.relative_addresses, self.codec.split(raw), checked=self.checked, timeout_s=timeout_s
                )
        except LinkError as error:
            raise error.with_item(self.path)  # noqa: B904
        self.wrote(raw)

    async def write_async(self, value: T | SupportsIndex, timeout_s: float | None = None) -> None:
        """Write the value, as `write` does."""
        raw = self.encode(value)
        try:
            if self.codec.words == 1:
                await self.hardware.write_async(
                    self.relative_address, raw, checked=self.checked, timeout_s=timeout_s
                )
            else:
                await self.hardware.write_many_async(
                    self.relative_addresses, self.codec.split(raw), checked=self.checked, timeout_s=timeout_s
                )
        except LinkError as error:
            raise error.with_item(self.path)  # noqa: B904
        self.wrote(raw)


class ReadWriteValue(ReadValue[T], WriteValue[T]):
    """A value that the PC reads and writes: one word that both sides may change."""

    access = "READWRITE"


class _Strobe(Value[T]):
    """A value whose write has an effect.

    The write is never repeated. If its reply is lost, OutcomeUnknown is raised.
    """

    def _prepare(self) -> None:
        super()._prepare()
        if isinstance(self.hardware, CommittedProxy):
            raise BindingError(
                f"{self.path} is a {self.access}, but {self.hardware.kind} writes all words again "
                "at each commit; use a plain register for it"
            )

    def _strobe(self, raw: int, timeout_s: float | None) -> None:
        try:
            self.hardware.link.write_many(
                self.addresses, self.codec.split(raw), checked=self.checked, repeat=False, timeout_s=timeout_s
            )
        except LinkError as error:
            raise error.with_item(self.path)  # noqa: B904


class PulseValue(_Strobe[T]):
    """A strobe: the written value works for a moment and cannot be read back.

    >>> robot.reset.pulse()                        # doctest: +SKIP
    """

    access = "PULSE"

    def pulse(self, value: T | SupportsIndex = 1, *, timeout_s: float | None = None) -> None:
        """Write `value` once. Raise OutcomeUnknown if the reply was lost."""
        self._strobe(self.codec.encode(value), timeout_s)


class ClearValue(ReadValue[T], _Strobe[T]):
    """Flags that the gateware sets and the PC clears by writing ones.

    >>> if robot.faults.read():                    # doctest: +SKIP
    ...     robot.faults.clear()
    """

    access = "W1C"

    def clear(self, value: Any = None, *, timeout_s: float | None = None) -> None:
        """Clear the flags set in `value`, by default those last read.

        Flags that came after that read stay set.
        """
        if value is None and self.raw is None:
            raise ValueRangeError(
                f"{self.path}: no value was read yet, so the flags to clear are not known; "
                "read it first, or give the flags"
            )
        self._strobe(
            self.raw if value is None and self.raw is not None else self.codec.encode(value), timeout_s
        )
