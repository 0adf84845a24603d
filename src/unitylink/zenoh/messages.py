# SPDX-License-Identifier: BSD-3-Clause
"""The messages between a client and a bridge: little-endian words, with no I/O and no clock.

A request has a head and a list of operations, each an operation of the framed protocol, an address, a value
and a mask. The answer has a head and the words that were read. docs/zenoh.md has the tables.
"""

from __future__ import annotations

import struct
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any, NamedTuple

from unitylink import protocol as p
from unitylink.errors import ProtocolError

VERSION = 1
DO, SUBSCRIBE, UNSUBSCRIBE, ARM, LEAVE, WRITE_VALUE = range(1, 7)
_KINDS = frozenset(range(1, 7))
ATOMIC, ONCE, CHECKED, UNCHECKED, ON_EVENT, VERIFY = (1 << n for n in range(6))
_FLAGS = (1 << 6) - 1
OPERATIONS = frozenset(
    (
        p.LIST_OPERATION_READ,
        p.LIST_OPERATION_READ_FIFO,
        p.LIST_OPERATION_WRITE,
        p.LIST_OPERATION_WRITE_FIFO,
        p.LIST_OPERATION_WRITE_MASKED,
        p.LIST_OPERATION_ADD,
    )
)
READS = frozenset((p.LIST_OPERATION_READ, p.LIST_OPERATION_READ_FIFO))
OPERATIONS_MAX = 1024  # of one request
_KNOWN = 256  # lists of operations that are kept, of at most 13 kB each
TTL_MAX_NS = 10_000_000_000  # of a set-point

_HEAD = struct.Struct("<BBHQQQqIHH")
_OPERATION = struct.Struct("<BIII")
_WORD = struct.Struct("<I")
_ANSWER = struct.Struct("<BBHQI")
_POINT = struct.Struct("<BBHQQq")
SAMPLE = struct.Struct("<Iq")
CLOCK = struct.Struct("<Qq")
VISIT = struct.Struct("<Q")
HEAD_BYTES = _HEAD.size

Operation = tuple[int, int, int, int]


class Request(NamedTuple):
    """What a client asks of a bridge.

    `visit` is the number that the bridge gave the client. `id` is the request's own, and `settled` is below
    every id that may still come again. A request is not begun after `deadline_ns`, by the clock of the
    bridge. 0 means none. `argument` and `detail` belong to SUBSCRIBE: the divisor, and the group plus one.
    The `argument` of an ARM is how many us before its deadline it was asked for; 0 means unknown. `body` is
    the value of a WRITE_VALUE.
    """

    kind: int
    visit: int
    id: int
    settled: int = 0
    deadline_ns: int = 0
    flags: int = 0
    argument: int = 0
    detail: int = 0
    operations: tuple[Operation, ...] = ()
    body: bytes = b""

    @property
    def once(self) -> bool:
        """Whether it must be executed at most once, however often it comes."""
        return self.kind != DO or bool(self.flags & ONCE)

    @property
    def writes(self) -> bool:
        return any(operation[0] not in READS for operation in self.operations)

    @property
    def asked_ns(self) -> int | None:
        """When an ARM was asked for at the latest, by the clock of the bridge, if that is known."""
        known = self.kind == ARM and self.deadline_ns and self.argument
        return self.deadline_ns - 1000 * self.argument if known else None

    def encode(self) -> bytes:
        """Return the bytes of the request."""
        kind, visit, number, settled, deadline_ns, flags, argument, detail, operations, body = self
        head = _HEAD.pack(
            VERSION, kind, flags, visit, number, settled, deadline_ns, argument, detail, len(operations)
        )
        return head + b"".join(_OPERATION.pack(*one) for one in operations) + body


def decode_request(data: bytes) -> Request:
    """Return the request of these bytes. Raises ProtocolError, and nothing else, if they are none.

    >>> decode_request(Request(DO, 7, 1, operations=((1, 0x10, 0, 0),)).encode()).operations
    ((1, 16, 0, 0),)
    """
    if len(data) < HEAD_BYTES:
        raise ProtocolError(f"a request of {len(data)} bytes; its head alone has {HEAD_BYTES}")
    version, kind, flags, visit, number, settled, deadline_ns, argument, detail, count = _HEAD.unpack_from(
        data
    )
    _check_version(version, "a request")
    if kind not in _KINDS:
        raise ProtocolError(f"a request of the kind {kind}, which does not exist")
    if flags & ~_FLAGS:
        raise ProtocolError(f"a request with the flags {flags:#06x}, some of which do not exist")
    if count > OPERATIONS_MAX:
        raise ProtocolError(f"a request with {count} operations; it has at most {OPERATIONS_MAX}")
    end = HEAD_BYTES + count * _OPERATION.size
    if len(data) < end or (kind != WRITE_VALUE and len(data) > end):
        raise ProtocolError(f"a request of {len(data)} bytes with {count} operations, which take {end}")
    operations = _operations(data[HEAD_BYTES:end])
    return Request(kind, visit, number, settled, deadline_ns, flags, argument, detail, operations, data[end:])


@lru_cache(_KNOWN)
def _operations(data: bytes) -> tuple[Operation, ...]:
    """Return the operations in these bytes. A client that reads again and again sends the same ones."""
    operations = tuple(_OPERATION.iter_unpack(data))
    for operation, *_ in operations:
        if operation not in OPERATIONS:
            raise ProtocolError(f"a request with the operation {operation}, which does not exist")
    return operations


class Answer(NamedTuple):
    """What a bridge answers to a request. `generation` is that of the link to the board."""

    id: int
    generation: int
    words: tuple[int, ...] = ()

    def encode(self) -> bytes:
        """Return the bytes of the answer."""
        number, generation, words = self
        head = _ANSWER.pack(VERSION, 0, 0, number, generation & 0xFFFFFFFF)
        return head + (_WORD.pack(*words) if len(words) == 1 else struct.pack(f"<{len(words)}I", *words))


def decode_answer(data: bytes) -> Answer:
    """Return the answer of these bytes. Raises ProtocolError, and nothing else, if they are none.

    >>> decode_answer(Answer(3, 1, (5, 6)).encode())
    Answer(id=3, generation=1, words=(5, 6))
    """
    if len(data) < _ANSWER.size or (len(data) - _ANSWER.size) % 4:
        raise ProtocolError(f"an answer of {len(data)} bytes, which is no head with whole words")
    version, _, _, number, generation = _ANSWER.unpack_from(data)
    _check_version(version, "an answer")
    return Answer(number, generation, unpack_words(data[_ANSWER.size :]))


@dataclass(frozen=True)
class SetPoint:
    """Values to be written if they are still the newest, and if it is not too late.

    `key` is where they came. `sequence` rises with each set-point of a visit. `values` is what `body` says,
    if somebody has read it.
    """

    key: str
    visit: int
    sequence: int
    deadline_ns: int
    body: bytes
    values: Mapping[str, Any] = field(default_factory=dict, compare=False)

    def encode(self) -> bytes:
        """Return the bytes of the set-point."""
        return _POINT.pack(VERSION, 0, 0, self.visit, self.sequence, self.deadline_ns) + self.body


def decode_set_point(key: str, data: bytes) -> SetPoint:
    """Return the set-point of these bytes. Raises ProtocolError, and nothing else, if they are none."""
    if len(data) < _POINT.size:
        raise ProtocolError(f"a set-point of {len(data)} bytes; its head alone has {_POINT.size}")
    version, zero, zeros, visit, sequence, deadline_ns = _POINT.unpack_from(data)
    _check_version(version, "a set-point")
    if zero or zeros:
        raise ProtocolError("a set-point whose reserved bytes are not 0")
    return SetPoint(key, visit, sequence, deadline_ns, data[_POINT.size :])


def decode_sample(data: bytes, words: int) -> tuple[int, int, tuple[int, ...]]:
    """Return (sequence, time in ns, words) of a publication. Raises ProtocolError, and nothing else."""
    if len(data) != SAMPLE.size + 4 * words:
        raise ProtocolError(
            f"a publication of {len(data)} bytes; {words} words take {SAMPLE.size + 4 * words}"
        )
    sequence, time_ns = SAMPLE.unpack_from(data)
    return sequence, time_ns, unpack_words(data[SAMPLE.size :])


def unpack_words(data: bytes) -> tuple[int, ...]:
    """Return the 32-bit words in these bytes."""
    return _WORD.unpack(data) if len(data) == _WORD.size else struct.unpack(f"<{len(data) // 4}I", data)


def operations_of(kind: int, addresses: Sequence[int], values: Sequence[int] = ()) -> tuple[Operation, ...]:
    """Return the same operation at many addresses."""
    if values:
        return tuple((kind, to, value, 0) for to, value in zip(addresses, values, strict=True))
    return tuple((kind, address, 0, 0) for address in addresses)


def _check_version(version: int, what: str) -> None:
    if version != VERSION:
        raise ProtocolError(
            f"{what} of version {version}; this side speaks {VERSION}, so update the older one"
        )
