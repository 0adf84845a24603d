# SPDX-License-Identifier: BSD-3-Clause
"""The payload of each request. Its length must be exactly right (docs/protocol.md, 3 to 5)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from unitylink import protocol as p

READS = (p.LIST_OPERATION_READ, p.LIST_OPERATION_READ_UP, p.LIST_OPERATION_READ_FIFO)
WRITES = (
    p.LIST_OPERATION_WRITE,
    p.LIST_OPERATION_WRITE_UP,
    p.LIST_OPERATION_WRITE_FIFO,
    p.LIST_OPERATION_WRITE_MASKED,
    p.LIST_OPERATION_ADD,
)


class Invalid(ValueError):
    """A payload has the wrong form."""


class Fields:
    """Takes a payload apart, most significant byte first.

    Raises `Invalid` if it is too short, or if bytes are left.
    """

    def __init__(self, payload: bytes) -> None:
        self._left = payload

    def take(self, size: int) -> int:
        if len(self._left) < size:
            raise Invalid("too short")
        taken, self._left = self._left[:size], self._left[size:]
        return int.from_bytes(taken, "big")

    def rest(self) -> bytes:
        rest, self._left = self._left, b""
        return rest

    def __bool__(self) -> bool:
        return bool(self._left)

    def end(self) -> None:
        if self._left:
            raise Invalid("too long")


@dataclass(frozen=True)
class Word:
    """One word of a list: its address, and the value to write if it is not a read."""

    operation: int
    address: int
    value: int = 0
    mask: int = 0

    @property
    def writes(self) -> bool:
        return self.operation in WRITES


def words_of_list(fields: Fields, a: int, d: int) -> Iterator[Word]:
    """Yield the words of all operations that are left in `fields`, in order.

    Addresses have `a` bytes, words `d`.
    """
    while fields:
        operation, count = fields.take(1), fields.take(1)
        if count == 0 or operation not in READS + WRITES:
            raise Invalid("operation")
        together = operation & 0x0F in (p.LIST_OPERATION_READ_UP, p.LIST_OPERATION_READ_FIFO)
        address = fields.take(a) if together else 0
        for index in range(count):
            if not together:
                address = fields.take(a)
            elif operation & 0x0F == p.LIST_OPERATION_READ_UP and index:
                address += 1
            mask = fields.take(d) if operation == p.LIST_OPERATION_WRITE_MASKED else 0
            value = fields.take(d) if operation in WRITES else 0
            yield Word(operation, address, value, mask)


@dataclass(frozen=True)
class Request:
    """One request of a session, taken apart."""

    operation: int  # the kind without its flag bits
    id: int
    chained: bool = False
    barrier: int | None = None
    address: int = 0  # address of a word or control register, or number of a group
    value: int = 0  # the value to write, the count of READ_CONTROL, or the divisor of DEFINE_GROUP
    flags: int = 0
    words: tuple[Word, ...] = ()
    outputs: bytes = b""
    addresses: tuple[int, ...] = ()  # of DEFINE_GROUP
    members: tuple[tuple[int, int], ...] = field(default=())  # for DEFINE_EXCHANGE: (address, bytes)
    output_count: int = 0


def parse(kind: int, payload: bytes, a: int, d: int) -> Request:
    """Take a request apart. Raises `Invalid` unless it has exactly the form of its kind."""
    fields = Fields(payload)
    operation = kind & ~(p.FRAME_CHAINED_BIT | p.FRAME_BARRIER_BIT)
    request_id = fields.take(2)
    barrier = fields.take(2) if kind & p.FRAME_BARRIER_BIT else None
    more: dict[str, object] = {}
    if operation == p.REQUEST_KIND_READ:
        more = {"address": fields.take(a)}
    elif operation == p.REQUEST_KIND_WRITE:
        more = {"address": fields.take(a), "value": fields.take(d)}
    elif operation == p.REQUEST_KIND_LIST:
        flags = fields.take(1)
        words = tuple(words_of_list(fields, a, d))
        if not words or flags & ~p.FRAME_ATOMIC_FLAG:
            raise Invalid("list")
        more = {"flags": flags, "words": words}
    elif operation == p.REQUEST_KIND_EXCHANGE:
        more = {"address": fields.take(1), "outputs": fields.rest()}
    elif operation == p.REQUEST_KIND_READ_CONTROL:
        more = {"address": fields.take(2), "value": fields.take(1)}
        if more["value"] == 0:
            raise Invalid("count")
    elif operation == p.REQUEST_KIND_WRITE_CONTROL:
        more = {"address": fields.take(2), "value": fields.take(4)}
    elif operation == p.REQUEST_KIND_DEFINE_GROUP:
        more = {"address": fields.take(1), "value": fields.take(4), "flags": fields.take(1)}
        more["addresses"] = tuple(fields.take(a) for _ in range(fields.take(1)))
        if int(str(more["flags"])) & ~p.FRAME_EVENT_FLAG:
            raise Invalid("flags")
    elif operation == p.REQUEST_KIND_DEFINE_EXCHANGE:
        group, outputs, inputs = fields.take(1), fields.take(1), fields.take(1)
        members = tuple((fields.take(a), fields.take(1)) for _ in range(outputs + inputs))
        if any(not 1 <= size <= d for _, size in members):
            raise Invalid("bytes")
        more = {"address": group, "output_count": outputs, "members": members}
    elif operation not in (p.REQUEST_KIND_SYNC, p.REQUEST_KIND_CLOSE):
        raise Invalid("kind")
    fields.end()
    return Request(operation, request_id, bool(kind & p.FRAME_CHAINED_BIT), barrier, **more)  # type: ignore[arg-type]


def parse_post(kind: int, payload: bytes, a: int, d: int) -> tuple[int, tuple[Word, ...]]:
    """Return the number of a post, and the words that it writes."""
    fields = Fields(payload)
    number = fields.take(2)
    if kind == p.REQUEST_KIND_POST:
        words: tuple[Word, ...] = (Word(p.LIST_OPERATION_WRITE, fields.take(a), fields.take(d)),)
    else:
        words = tuple(words_of_list(fields, a, d))
        if not words or not all(word.writes for word in words):
            raise Invalid("post")
    fields.end()
    return number, words
