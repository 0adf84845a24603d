# SPDX-License-Identifier: BSD-3-Clause
"""Cycle: the body of a control loop. It writes all outputs and reads all inputs."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from types import TracebackType
from typing import TYPE_CHECKING, Any

from unitylink.errors import DeviceMismatch, LinkError, ValueRangeError
from unitylink.layer3_hardware import CommittedProxy

from .at_once import at_once
from .portions import portions
from .snapshot import Snapshot
from .write_value import WriteValue

if TYPE_CHECKING:
    from typing_extensions import Self

    from unitylink.layer2_message import ExchangeGroup, Link

    from .group import ValueGroup
    from .read_value import ReadValue
    from .value import Value


class Cycle:
    """Write every WRITE of a group and read every READ, in as few bytes and messages as the link allows.

    Made by `ValueGroup.cycle` and `Node.cycle`. A value that a call does not name keeps its last value. At
    first that is its INITIAL. After a line has come back or a device has restarted, all values must be given
    again.

    On a framed link the words are named once, as an exchange group. Then each call is one message each way
    with bare data, and its result is of one moment (`atomic`). If that is impossible, `notice` says why, and
    the next best way is used.

    >>> with robot.cycle() as cycle:                                # doctest: +SKIP
    ...     state = cycle(target=0.0)
    ...     while not done(state):
    ...         state = cycle(target=control(state["angle"]))
    """

    def __init__(self, group: ValueGroup) -> None:
        self.group = group
        self.notice = ""
        """Why it is not one message each way, or its values not of one moment; empty where all is well."""
        for value in group.reads.values():
            if not (value.pollable and value.hardware.repeatable_reads):
                raise ValueRangeError(
                    f"{value.path}: a read of it has a side effect, so it cannot be in a cycle; read it alone"
                )
        self._raw: dict[WriteValue[Any], int | None] = {
            value: _initial(value) for value in group.writes.values()
        }
        links: dict[Link, None] = dict.fromkeys(value.hardware.link for value in group)
        self._generations = {link: link.generation for link in links}
        self._parts = [_Part(link, group, self._raw, self._say) for link in links]

    @property
    def atomic(self) -> bool:
        """Whether all values are of one moment. Then each call is one transaction of the bus, on one link."""
        return len(self._parts) == 1 and all(part.atomic for part in self._parts)

    def __call__(
        self,
        values: Mapping[str, Any] | Sequence[Any] | None = None,
        /,
        *,
        timeout_s: float | None = None,
        **named: Any,
    ) -> Snapshot:
        """Write and read once. Give values as to `ValueGroup.write`, or none at all.

        All values are checked before the first is sent. Raises ValueRangeError, also for a value that was
        never given. It also raises what a write raises: OutcomeUnknown, DeadManTripped, BusError.
        """
        self._forget_old()
        if values is not None or named:
            for value, number in self.group.chosen(values, named).items():
                self._raw[value] = value.encode(number)
        missing = [value.path for value, raw in self._raw.items() if raw is None]
        if missing:
            raise ValueRangeError(
                f"{self.group.path}: {', '.join(missing)}: no value yet: it has no INITIAL, and "
                "none was given since the line was lost or the device restarted; nothing was sent"
            )
        try:
            fetched = at_once(self._generations, [partial(part.run, timeout_s) for part in self._parts])
        except LinkError as error:
            raise error.with_item(self.group.path)  # noqa: B904  the same error, now with its name
        for value, raw in self._raw.items():
            if raw is not None:
                value.wrote(raw)
        words = {part.link: read for part, read in zip(self._parts, fetched, strict=True)}
        return self.group.taken(words)

    def _forget_old(self) -> None:
        """After a line has come back or a device has restarted, forget the values.

        They must be given again.
        """
        for link, before in self._generations.items():
            if link.generation != before:
                self._generations[link] = link.generation
                self._raw.update({value: None for value in self._raw if value.hardware.link is link})

    def close(self) -> None:
        """Give the exchange groups back to their devices."""
        for part in self._parts:
            part.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _say(self, why: str) -> None:
        self.notice = f"{self.notice}; {why}" if self.notice else why


class _Part:
    """The part of the cycle on one link."""

    def __init__(
        self,
        link: Link,
        group: ValueGroup,
        raw: Mapping[WriteValue[Any], int | None],
        say: Callable[[str], None],
    ) -> None:
        self.link = link
        self._raw = raw
        data_bytes = link.configuration.data_bytes
        self._reads: list[ReadValue[Any]] = [v for v in group.reads.values() if v.hardware.link is link]
        writes = [value for value in group.writes.values() if value.hardware.link is link]
        self._committed: dict[CommittedProxy, list[WriteValue[Any]]] = {}
        for value in writes:
            if isinstance(value.hardware, CommittedProxy):
                self._committed.setdefault(value.hardware, []).append(value)
        self._plain = [value for value in writes if not isinstance(value.hardware, CommittedProxy)]
        outputs = [word for value in self._plain for word in _words(value, data_bytes)]
        inputs = [word for value in self._reads for word in _words(value, data_bytes)]
        self._outputs, self._inputs = [a for a, _ in outputs], [a for a, _ in inputs]
        self.atomic = link.protocol == "framed" and not self._committed
        self._exchange: ExchangeGroup | None = None
        if self._committed:
            say("outputs that need a commit are sent before the inputs are read")
        elif not self.atomic:
            say(f"{link.url} speaks no framed protocol: values are written and read one after the other")
        if link.protocol == "framed" and (outputs or inputs):
            try:
                self._exchange = link.exchange_group(outputs, inputs)
            except DeviceMismatch as error:
                say(str(error))

    def run(self, timeout_s: float | None) -> tuple[float, list[int]]:
        started = self.link.now_s()
        for hardware, values in self._committed.items():
            hardware.write_many(
                [address for value in values for address in value.relative_addresses],
                [word for value in values for word in self._split(value)],
                timeout_s=timeout_s,
            )
        words = [word for value in self._plain for word in self._split(value)]
        if self._exchange is not None:
            read = self._exchange.exchange(words, timeout_s=timeout_s).tolist()
        elif self.atomic:  # too large for a group of the device, so each message names its words
            pairs = list(zip(self._outputs, words, strict=True))
            read = self.link.exchange(self._inputs, pairs, atomic=True, timeout_s=timeout_s).tolist()
        else:
            read = []
            if words:
                self.link.write_many(self._outputs, words, timeout_s=timeout_s)
            for addresses, atomic in portions(self._reads, False) if self._reads else ():
                read += self.link.read_many(addresses, atomic=atomic, timeout_s=timeout_s).tolist()
        return (started + self.link.now_s()) / 2, read

    def close(self) -> None:
        if self._exchange is not None:
            self._exchange.close()

    def _split(self, value: WriteValue[Any]) -> tuple[int, ...]:
        raw = self._raw[value]
        assert raw is not None
        return value.codec.split(raw)


def _initial(value: WriteValue[Any]) -> int | None:
    return None if value.quantity.initial is None else value.codec.encode(value.quantity.initial)


def _words(value: Value[Any], data_bytes: int) -> list[tuple[int, int]]:
    """Return the address and the bytes of each word. The bits of the type decide how many bytes."""
    left = (value.codec.width + 7) // 8
    words = []
    for address in value.addresses:
        words.append((address, min(left, data_bytes)))
        left -= data_bytes
    return words
