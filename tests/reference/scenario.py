# SPDX-License-Identifier: BSD-3-Clause
"""Random scenarios from a seed: what a host, or a bad wire, may send.

All implementations answer with the same bytes.
"""

from __future__ import annotations

import random
from collections.abc import Iterator

from reference.framing import Frame, field
from reference.requests import READS, WRITES
from reference.settings import Settings
from unitylink import protocol as p

CONTROLS = (
    p.CONTROL_MAGIC,
    p.CONTROL_WIDTHS,
    p.CONTROL_WINDOW,
    p.CONTROL_SPEC_HASH_LOW,
    p.CONTROL_FRAMES,
    p.CONTROL_POSTS,
    p.CONTROL_ARM,
    p.CONTROL_PUBLISH + 1,
    0x0010,
)


def _unclassic(piece: bytes) -> bytes:
    """Return what the classic side gets of a bad wire, without its heads. Its answers are not tested here."""
    return piece.translate(None, b"#$%&") if piece[:1] < b"\x80" else piece


def under_a_used_id(settings: Settings, epoch: int) -> Iterator[bytes]:
    """Yield requests of all kinds under a used id, and then the counters.

    The id was that of a LIST whose reply was too long to keep.
    """
    a, d = settings.a, settings.d

    def ask(kind: int, *fields: tuple[int, int], id: int = 0) -> bytes:
        return Frame(kind, field((id, 2), *fields)).encode(epoch)

    def reads(count: int) -> tuple[tuple[int, int], ...]:
        return ((0, 1), (p.LIST_OPERATION_READ_UP, 1), (count, 1), (0x10, a))

    yield ask(p.REQUEST_KIND_LIST, *reads(settings.cache // d + 1))
    yield ask(p.REQUEST_KIND_READ, (0x10, a))
    yield ask(p.REQUEST_KIND_WRITE, (0x10, a), (1, d))
    yield ask(p.REQUEST_KIND_SYNC)
    yield ask(p.REQUEST_KIND_CLOSE)
    yield ask(p.REQUEST_KIND_WRITE_CONTROL, (p.CONTROL_PUBLISH, 2), (1, 4))
    yield ask(p.REQUEST_KIND_DEFINE_GROUP, (0, 1), (1, 4), (0, 1), (1, 1), (0x10, a))
    yield ask(p.REQUEST_KIND_DEFINE_EXCHANGE, (0, 1), (0, 1), (1, 1), (0x10, a), (1, 1))
    yield ask(p.REQUEST_KIND_EXCHANGE, (0, 1))
    yield ask(p.REQUEST_KIND_READ_CONTROL, (0x10, 2), (1, 1))
    yield ask(p.REQUEST_KIND_LIST, *reads(255))  # longer than any reply
    yield ask(p.REQUEST_KIND_LIST, *reads(2))
    yield ask(
        p.REQUEST_KIND_READ_CONTROL,
        (p.CONTROL_FRAMES, 2),
        (p.CONTROL_DUPLICATES - p.CONTROL_FRAMES + 1, 1),
        id=1,
    )
    yield ask(p.REQUEST_KIND_READ, (0x10, a), id=2)


class Scenario:
    """Steps of bytes for a device with `settings`. The same seed gives the same steps.

    Only `clock` fields of answers depend on time. Requests for them are left out, but not the answer to OPEN.
    With `timed`, groups publish and the dead-man runs by the device's clock.
    """

    def __init__(
        self, seed: int, settings: Settings, steps: int = 60, addresses: int = 64, *, timed: bool = False
    ) -> None:
        self._timed = timed
        self.settings = settings
        self._draw = random.Random(seed)
        self._steps = steps
        self._addresses = addresses
        self._nonce = 0
        self._epoch: int | None = None
        self._id = 0
        self._post = 0
        self._sent: list[bytes] = []
        self._written: list[int] = []  # the last addresses
        self._outputs: dict[int, int] = {}  # how many bytes an EXCHANGE of each group has

    def __iter__(self) -> Iterator[bytes]:
        yield b"\0" + self._begin()
        for _ in range(self._steps):
            yield b"\0".join(_unclassic(piece) for piece in self._step().split(b"\0"))

    # ---- steps

    def _step(self) -> bytes:
        draw = self._draw.random()
        if draw < 0.02:
            return self._begin()
        if draw < 0.04:
            return self._stray_open()
        wire = self._post_frame() if draw < 0.2 else self._request()
        self._sent = [*self._sent[-15:], wire]
        fate = self._draw.random()
        if fate < 0.06:
            return b""
        if fate < 0.12:
            return wire + wire
        if fate < 0.22:
            return self._draw.choice(self._sent) + wire
        if fate < 0.30:
            return self._hurt(wire)
        if fate < 0.34:
            return self._draw.randbytes(self._draw.randrange(40)) + b"\0" + wire
        return wire

    def _hurt(self, wire: bytes) -> bytes:
        hurt = bytearray(wire)
        for _ in range(self._draw.randrange(1, 4)):
            bit = self._draw.randrange(8 * len(hurt))
            hurt[bit // 8] ^= 1 << bit % 8
        return bytes(hurt) + b"\0"

    # ---- sessions

    def _begin(self) -> bytes:
        self._nonce += 1
        self._epoch = self._draw.randrange(0xFF00)
        self._id = self._post = 0
        self._sent = []
        self._outputs = {}
        hello = Frame(p.REQUEST_KIND_HELLO, bytes([self._draw.choice((1, 1, 1, 2)), 2])).encode()
        opening = Frame(p.REQUEST_KIND_OPEN, field((self._nonce, 2), (self._epoch, 2), (0, 1))).encode()
        return hello + opening + (opening if self._draw.random() < 0.3 else b"")

    def _stray_open(self) -> bytes:
        nonce = self._draw.randrange(self._nonce + 1)
        epoch = self._draw.choice((self._draw.randrange(0x10000), 0xFFFF))
        return Frame(
            p.REQUEST_KIND_OPEN, field((nonce, 2), (epoch, 2), (self._draw.randrange(3), 1))
        ).encode()

    def _encode(self, kind: int, payload: bytes) -> bytes:
        assert self._epoch is not None
        return Frame(kind, payload).encode(self._epoch)

    # ---- posts and requests

    def _post_frame(self) -> bytes:
        number = (self._post + self._draw.choice((0, 0, 0, 0, 0, 0, -1, 1, 5))) % 0x10000
        if number == self._post:
            self._post += 1
        if self._draw.random() < 0.6:
            return self._encode(p.REQUEST_KIND_POST, field((number, 2), *self._word()))
        return self._encode(p.REQUEST_KIND_POST_LIST, field((number, 2)) + self._operations(WRITES, 3))

    def _address(self) -> tuple[int, int]:
        if self._written and self._draw.random() < 0.4:  # where a word is that is probably not zero
            return (self._draw.choice(self._written), self.settings.a)
        return (self._draw.randrange(self._addresses), self.settings.a)

    def _data(self) -> tuple[int, int]:
        d = self.settings.d
        return (self._draw.choice((0, 1, self._draw.randrange(1 << 8 * d))), d)

    def _word(self) -> tuple[tuple[int, int], tuple[int, int]]:
        address = self._address()
        self._written = [*self._written[-3:], address[0]]
        return address, self._data()

    def _operations(self, known: tuple[int, ...], most: int) -> bytes:
        operations = b""
        for _ in range(self._draw.randrange(1, most + 1)):
            operation = self._draw.choice(known)
            count = self._draw.randrange(1, 5)
            operations += field((operation, 1), (count, 1))
            shape = operation & 0x0F
            together = shape in (p.LIST_OPERATION_READ_UP, p.LIST_OPERATION_READ_FIFO)
            operations += field(self._address()) if together else b""
            for _ in range(count):
                operations += b"" if together else field(self._address())
                operations += field(self._data()) if operation == p.LIST_OPERATION_WRITE_MASKED else b""
                operations += field(self._data()) if operation in WRITES else b""
        return operations

    def _request(self) -> bytes:
        draw = self._draw
        number = self._id
        self._id = (self._id + 1) % 0x10000
        if draw.random() < 0.05:
            number = (number + draw.choice((-40, -1, 3, 100))) % 0x10000
        kind, body = self._body()
        head = field((number, 2))
        if draw.random() < 0.2:
            kind |= p.FRAME_CHAINED_BIT
        if draw.random() < 0.2:
            kind |= p.FRAME_BARRIER_BIT
            head += field(((self._post + draw.choice((0, 0, 0, 1))) % 0x10000, 2))
        if draw.random() < 0.05:  # a wrong form
            body = body[: draw.randrange(len(body) + 1)] if draw.random() < 0.5 else body + draw.randbytes(1)
        return self._encode(kind, head + body)

    def _body(self) -> tuple[int, bytes]:
        draw, s = self._draw, self.settings
        choice = draw.randrange(18 if self._timed else 12)
        if choice < 2:
            return p.REQUEST_KIND_READ, field(self._address())
        if choice < 5:
            return p.REQUEST_KIND_WRITE, field(*self._word())
        if choice < 7:
            return p.REQUEST_KIND_LIST, field((draw.randrange(2), 1)) + self._operations(READS + WRITES, 4)
        if choice == 7:
            return p.REQUEST_KIND_SYNC, b""
        if choice == 8:
            return p.REQUEST_KIND_READ_CONTROL, field(
                (draw.choice(CONTROLS), 2), (draw.choice((1, 1, 2, 5)), 1)
            )
        if choice > 14:
            words = [self._address() for _ in range(draw.randrange(1, 4))]
            rate = (draw.randrange(4), 4), (draw.randrange(2), 1)
            head = field((draw.randrange(s.groups + 1), 1), *rate, (len(words), 1))
            return p.REQUEST_KIND_DEFINE_GROUP, head + field(*words)
        if choice > 11:
            register = draw.choice(
                (p.CONTROL_PUBLISH, p.CONTROL_PUBLISH, p.CONTROL_DEADMAN_TICKS, p.CONTROL_ARM)
            )
            value = draw.randrange(4) if register == p.CONTROL_DEADMAN_TICKS else 1
            return p.REQUEST_KIND_WRITE_CONTROL, field((register, 2), (value, 4))
        group = draw.randrange(s.exchanges + 1)
        if choice == 9 or not self._outputs:
            sizes = [draw.randrange(1, s.d + 1) for _ in range(draw.randrange(5))]
            outputs = draw.randrange(len(sizes) + 1)
            self._outputs[group] = sum(sizes[:outputs])
            head = field((group, 1), (outputs, 1), (len(sizes) - outputs, 1))
            return p.REQUEST_KIND_DEFINE_EXCHANGE, head + b"".join(
                field(self._address(), (n, 1)) for n in sizes
            )
        if draw.random() < 0.8:
            group = draw.choice(list(self._outputs))
        size = self._outputs.get(group, 0) if draw.random() < 0.8 else draw.randrange(6)
        return p.REQUEST_KIND_EXCHANGE, field((group, 1)) + draw.randbytes(size)
