# SPDX-License-Identifier: BSD-3-Clause
"""The device of docs/protocol.md without time: bytes in, frames out, and a dictionary as its bus."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable

from reference.bus import Bus, BusError
from reference.framing import Borders, Frame, field
from reference.requests import Invalid, Request, Word, parse, parse_post
from reference.settings import Settings
from reference.state import Exchange, Group, Place
from unitylink import protocol as p

MOST = 0xFFFFFFFF
POSTS = (p.REQUEST_KIND_POST, p.REQUEST_KIND_POST_LIST)
# their replies may be too long to keep
LONG = (p.REQUEST_KIND_LIST, p.REQUEST_KIND_EXCHANGE, p.REQUEST_KIND_READ_CONTROL)
OUTSIDE = (p.REQUEST_KIND_HELLO, p.REQUEST_KIND_OPEN)
COUNTERS = range(p.CONTROL_FRAMES, p.CONTROL_DEADMAN_TRIPS + 1)
STATE = range(p.CONTROL_TIME_LOW, p.CONTROL_PUBLISH + 1)


class ReferenceDevice:
    """One device. Its user sets `clock`. One call of `tick()` is one tick of base_hz."""

    def __init__(self, settings: Settings | None = None, bus: Bus | None = None, nonce: int = 0) -> None:
        self.settings = settings or Settings()
        self.bus = bus or Bus()
        self.clock = 0
        self.counters: Counter[int] = Counter()
        self.epoch = p.FRAME_OPEN_EPOCH
        self.tripped = False
        self._borders = Borders()
        self.nonce = nonce  # nonce of the last HELLO answer; it outlives a reset
        self._session_nonce = 0
        self._offered = False  # true after a HELLO answer whose nonce no OPEN has used
        self._closed_told = False
        self._tripped_in_session = False
        self._time_high = 0
        self._begin_session(p.FRAME_OPEN_EPOCH, 0)

    @property
    def open(self) -> bool:
        return self.epoch != p.FRAME_OPEN_EPOCH

    def feed(self, data: bytes) -> bytes:
        """Take bytes from the host, and return the device's answer."""
        return b"".join(self.take(piece) for piece in self._borders.feed(data))

    # ---- a frame, until its kind is known

    def take(self, piece: bytes) -> bytes:
        """Take the piece between two borders, and return the device's answer."""
        if piece[0] < 0x80:
            return b""  # no kind of frame: the byte belongs to the classic side
        if len(piece) > self.longest:
            return self._drop(p.CONTROL_DISCARDED_LONG)
        outside = piece[0] in OUTSIDE
        if not outside and not self.open:
            self._drop(p.CONTROL_DISCARDED_SESSION)
            told, self._closed_told = self._closed_told, True
            return b"" if told else self._frame(p.DEVICE_KIND_CLOSED)
        frame = Frame.decode(piece, *self._key(outside))
        if frame is None:
            return self._drop(p.CONTROL_DISCARDED_CHECK)
        if outside:
            return self._outside(frame)
        if len(frame.payload) > self.settings.request_max:
            return self._drop(p.CONTROL_DISCARDED_LONG)
        flagged = frame.kind & (p.FRAME_CHAINED_BIT | p.FRAME_BARRIER_BIT)
        if frame.kind & p.FRAME_DEVICE_BIT or (flagged and frame.kind - flagged in POSTS):
            return self._drop(p.CONTROL_DISCARDED_KIND)
        self._silent_ticks = 0
        return self._post(frame) if frame.kind in POSTS else self._request(frame)

    @property
    def longest(self) -> int:
        """Bytes between the borders of the longest request: kind, COBS, check."""
        return 1 + self.settings.request_max + self.settings.request_max // 254 + 1 + p.FRAME_CRC32_BYTES

    def _drop(self, counter: int) -> bytes:
        self._count(counter)
        return b""

    def _count(self, counter: int) -> None:
        self.counters[counter] = min(self.counters[counter] + 1, MOST)

    def _frame(self, kind: int, payload: bytes = b"") -> bytes:
        outside = kind in (p.DEVICE_KIND_HELLO, p.DEVICE_KIND_OPEN, p.DEVICE_KIND_CLOSED)
        return Frame(kind, payload).encode(*self._key(outside))

    def _key(self, outside: bool) -> tuple[int, bool]:
        return (p.FRAME_OPEN_EPOCH, False) if outside else (self.epoch, self._always_long)

    # ---- sessions

    def _outside(self, frame: Frame) -> bytes:
        body = frame.payload
        if frame.kind == p.REQUEST_KIND_HELLO:
            if len(body) != 2:
                return self._drop(p.CONTROL_DISCARDED_KIND)
            self._count(p.CONTROL_FRAMES)
            self._closed_told = False
            self._offered = True
            self.nonce = (self.nonce + 1) % 0x10000
            version = p.FRAME_VERSION if body[0] <= p.FRAME_VERSION <= body[1] else 0
            return self._frame(p.DEVICE_KIND_HELLO, self._description(version))
        if len(body) != 5:
            return self._drop(p.CONTROL_DISCARDED_KIND)
        nonce, epoch, flags = (int.from_bytes(part, "big") for part in (body[:2], body[2:4], body[4:]))
        again = self.open and (nonce, epoch) == (self._session_nonce, self.epoch)
        long = self.settings.features & p.CONTROL_VALUE_FEATURE_LONG_FRAMES
        known = p.FRAME_CHECKED_LONG_FLAG if long else 0
        fresh = self._offered and nonce == self.nonce and epoch >> 8 != 0xFF and flags & ~known == 0
        if not again and not fresh:
            return self._drop(p.CONTROL_DISCARDED_STALE)
        self._count(p.CONTROL_FRAMES)
        if not again:
            self._offered = False
            if self._deadman_ticks:
                self._trip()
            self._begin_session(epoch, flags)
            self._session_nonce = nonce
        return self._frame(p.DEVICE_KIND_OPEN, field((self.epoch, 2), (self.clock & MOST, 4)))

    def _begin_session(self, epoch: int, flags: int) -> None:
        window = self.settings.window
        self.epoch = epoch
        self._always_long = bool(flags & p.FRAME_CHECKED_LONG_FLAG)
        self._places = [Place((index - window) % 0x10000) for index in range(window)]
        self.posts = 0
        self._failed_posts = 0
        self._first_failed = (0, 0)
        self.groups = [Group() for _ in range(self.settings.groups)]
        self._exchanges: dict[int, Exchange] = {}
        self.publishing = False
        self._ticks = 0
        self._deadman_ticks = 0
        self._silent_ticks = 0
        self._tripped_in_session = False

    def _description(self, version: int) -> bytes:
        s = self.settings
        widths = ((s.a, 1), (s.d, 1))
        limits = ((s.credit, 2), (s.request_max, 2), (s.reply_max, 2), (s.window, 1), (s.cache, 1))
        known = ((s.features, 2), (s.spec_hash, 8))
        return field((version, 1), (self.nonce, 2), (self.epoch, 2), *widths, *limits, *known)

    # ---- posts

    def _post(self, frame: Frame) -> bytes:
        try:
            self._must_have(frame.kind)
            number, words = parse_post(frame.kind, frame.payload, self.settings.a, self.settings.d)
        except Invalid:
            return self._drop(p.CONTROL_DISCARDED_KIND)
        distance = (number - self.posts) % 0x10000
        if distance:
            return self._drop(p.CONTROL_POSTS_AHEAD if distance < 0x8000 else p.CONTROL_POSTS_OLD)
        self._count(p.CONTROL_POSTS)
        status = p.REPLY_STATUS_DENIED if self.tripped else p.REPLY_STATUS_OK
        if self.tripped:
            self._count(p.CONTROL_REFUSED)
        else:
            try:
                for word in words:
                    self._word(word)
            except BusError as error:
                status = error.status
        if status:
            self._count(p.CONTROL_POST_ERRORS)
            if not self._failed_posts:
                self._first_failed = (number, status)
            self._failed_posts = min(self._failed_posts + 1, 0xFFFF)
        self.posts = (self.posts + 1) % 0x10000
        return b""

    # ---- requests

    def _must_have(self, operation: int) -> None:
        """Raise `Invalid` for a request that needs something that the device was built without."""
        s = self.settings
        needs = {
            p.REQUEST_KIND_LIST: s.lists,
            p.REQUEST_KIND_POST_LIST: s.lists,
            p.REQUEST_KIND_EXCHANGE: s.exchanges,
            p.REQUEST_KIND_DEFINE_EXCHANGE: s.exchanges,
            p.REQUEST_KIND_DEFINE_GROUP: s.groups,
        }
        if not needs.get(operation, True):
            raise Invalid("left out")

    def _request(self, frame: Frame) -> bytes:
        if len(frame.payload) < 2:
            return self._drop(p.CONTROL_DISCARDED_KIND)
        request_id = int.from_bytes(frame.payload[:2], "big")
        try:
            self._must_have(frame.kind & ~(p.FRAME_CHAINED_BIT | p.FRAME_BARRIER_BIT))
            request = parse(frame.kind, frame.payload, self.settings.a, self.settings.d)
        except Invalid:
            self._count(p.CONTROL_FRAMES)
            return self._reply(request_id, p.REPLY_STATUS_INVALID)
        place = self._place(request.id)
        distance = (request.id - place.id) % 0x10000
        if distance >= 0x8000 or (distance == 0 and place.empty):
            return self._drop(p.CONTROL_DISCARDED_STALE)
        if distance == 0:
            self._count(p.CONTROL_DUPLICATES)
            if place.reply is not None:
                return self._reply(request.id, place.status, place.reply)
            refusal = self._refusal(request, repeated=True)
            if request.operation not in LONG:
                refusal = p.REPLY_STATUS_INVALID  # the id belonged to another request
            answer = (refusal, b"") if refusal else self._execute(request, repeated=True)
            return self._reply(request.id, *answer)
        self._count(p.CONTROL_FRAMES)
        refusal = self._untimely(request) or self._refusal(request, repeated=False)
        if refusal:
            if refusal == p.REPLY_STATUS_DENIED:
                self._count(p.CONTROL_REFUSED)
            return self._reply(request.id, refusal)
        status, reply = self._execute(request, repeated=False)
        place.id, place.status, place.empty = request.id, status, False
        place.reply = reply if len(reply) <= self.settings.cache else None
        answer = self._reply(request.id, status, reply)
        if request.operation == p.REQUEST_KIND_CLOSE:
            self._begin_session(p.FRAME_OPEN_EPOCH, 0)
        return answer

    def _place(self, request_id: int) -> Place:
        return self._places[request_id % self.settings.window]

    def _reply(self, request_id: int, status: int, reply: bytes = b"") -> bytes:
        return self._frame(p.DEVICE_KIND_REPLY + status, field((request_id, 2), (self.posts, 2)) + reply)

    def _untimely(self, request: Request) -> int:
        """Return why a request may not be executed yet, or 0 if it may."""
        before = (request.id - 1) % 0x10000
        if request.chained and (self._place(before).id - before) % 0x10000 >= 0x8000:
            return p.REPLY_STATUS_ORDER
        if request.barrier is not None and request.barrier != self.posts:
            return p.REPLY_STATUS_BEHIND
        return 0

    def _refusal(self, request: Request, *, repeated: bool) -> int:
        """Return why a request is never executed, or 0 if it is. The checks are in the order of the page."""
        s = self.settings
        writes = request.operation == p.REQUEST_KIND_WRITE or any(word.writes for word in request.words)
        size = 0
        match request.operation:
            case p.REQUEST_KIND_READ:
                size = s.d
            case p.REQUEST_KIND_LIST:
                size = 2 + s.d * sum(not word.writes for word in request.words)
                fifo = any(word.operation == p.LIST_OPERATION_READ_FIFO for word in request.words)
                if fifo and size > s.cache and not (self.tripped and writes and not repeated):
                    return p.REPLY_STATUS_TOO_LONG
            case p.REQUEST_KIND_EXCHANGE:
                exchange = self._exchanges.get(request.address)
                if exchange is None:
                    return p.REPLY_STATUS_NO_GROUP
                if len(request.outputs) != sum(size for _, size in exchange.outputs):
                    return p.REPLY_STATUS_INVALID
                writes = bool(exchange.outputs)
            case p.REQUEST_KIND_READ_CONTROL:
                last = request.address + request.value - 1
                if not any(request.address in block and last in block for block in self._blocks()):
                    return p.REPLY_STATUS_BAD_ADDRESS
                size = 4 * request.value
            case p.REQUEST_KIND_WRITE_CONTROL:
                return self._control_refusal(request.address, request.value)
            case p.REQUEST_KIND_DEFINE_GROUP:
                if request.address >= s.groups or len(request.addresses) > s.group_size:
                    return p.REPLY_STATUS_NO_GROUP
                size = 7 + s.d * len(request.addresses) - 4
            case p.REQUEST_KIND_DEFINE_EXCHANGE:
                if request.address >= s.exchanges or len(request.members) > s.exchange_size:
                    return p.REPLY_STATUS_NO_GROUP
                size = sum(size for _, size in request.members[request.output_count :])
        if writes and self.tripped and not repeated:
            return p.REPLY_STATUS_DENIED
        return p.REPLY_STATUS_TOO_LONG if 4 + size > s.reply_max else 0

    @staticmethod
    def _blocks() -> Iterable[range]:
        return (range(p.CONTROL_MAGIC, p.CONTROL_SPEC_HASH_LOW + 1), COUNTERS, STATE)

    def _control_refusal(self, address: int, value: int) -> int:
        has_deadman = self.settings.features & p.CONTROL_VALUE_FEATURE_DEADMAN
        known = {p.CONTROL_DEADMAN_TICKS: has_deadman, p.CONTROL_ARM: has_deadman}
        if not {**known, p.CONTROL_PUBLISH: self.settings.groups}.get(address):
            return p.REPLY_STATUS_BAD_ADDRESS
        if (address == p.CONTROL_ARM and value != 1) or (address == p.CONTROL_PUBLISH and value > 1):
            return p.REPLY_STATUS_INVALID
        late = address == p.CONTROL_ARM and self._tripped_in_session
        early = address == p.CONTROL_DEADMAN_TICKS and self.tripped
        return p.REPLY_STATUS_DENIED if late or early else 0

    def _execute(self, request: Request, *, repeated: bool) -> tuple[int, bytes]:
        """Return status and reply. A repeated request reads again, but does not write again."""
        d = self.settings.d
        done = 0
        try:
            match request.operation:
                case p.REQUEST_KIND_READ:
                    return 0, field((self._read(request.address), d))
                case p.REQUEST_KIND_WRITE:
                    self._word(Word(p.LIST_OPERATION_WRITE, request.address, request.value))
                case p.REQUEST_KIND_LIST:
                    read = b""
                    for word in request.words:
                        if not word.writes:
                            read += field((self._read(word.address), d))
                        elif not repeated:
                            self._word(word)
                        done += 1
                    return 0, field((done, 2)) + read
                case p.REQUEST_KIND_EXCHANGE:
                    return 0, self._exchange(self._exchanges[request.address], request.outputs, repeated)
                case p.REQUEST_KIND_READ_CONTROL:
                    span = range(request.address, request.address + request.value)
                    return 0, b"".join(field((self._control(address), 4)) for address in span)
                case p.REQUEST_KIND_WRITE_CONTROL:
                    self._set_control(request.address, request.value)
                case p.REQUEST_KIND_DEFINE_GROUP:
                    group = Group(request.addresses, request.value, request.flags)
                    self.groups[request.address] = group
                case p.REQUEST_KIND_DEFINE_EXCHANGE:
                    first = request.output_count
                    self._exchanges[request.address] = Exchange(
                        request.members[:first], request.members[first:]
                    )
                case p.REQUEST_KIND_SYNC:
                    number, status = self._first_failed
                    return 0, field((self.posts, 2), (self._failed_posts, 2), (number, 2), (status, 1))
        except BusError as error:
            return error.status, field((done, 2)) if request.operation == p.REQUEST_KIND_LIST else b""
        return 0, b""

    # ---- the bus

    def _access(self, access: Callable[[], int]) -> int:
        try:
            return access()
        except BusError as error:
            timeout = error.status == p.REPLY_STATUS_BUS_TIMEOUT
            self._count(p.CONTROL_BUS_TIMEOUTS if timeout else p.CONTROL_BUS_ERRORS)
            raise

    def _read(self, address: int) -> int:
        return self._access(lambda: self.bus.read(address % (1 << 8 * self.settings.a)))

    def _write(self, address: int, value: int) -> None:
        def write() -> int:
            self.bus.write(address % (1 << 8 * self.settings.a), value)
            return 0

        self._access(write)

    def _word(self, word: Word) -> None:
        value = word.value
        if word.operation == p.LIST_OPERATION_WRITE_MASKED:
            value = (self._read(word.address) & ~word.mask) | (value & word.mask)
        elif word.operation == p.LIST_OPERATION_ADD:
            value = (self._read(word.address) + value) % (1 << 8 * self.settings.d)
        self._write(word.address, value)

    def _exchange(self, exchange: Exchange, outputs: bytes, repeated: bool) -> bytes:
        for address, size in exchange.outputs:
            value, outputs = int.from_bytes(outputs[:size], "big"), outputs[size:]
            if not repeated:
                self._write(address, value)
        return b"".join(
            field((self._read(address) % (1 << 8 * size), size)) for address, size in exchange.inputs
        )

    # ---- control registers and time

    def _control(self, address: int) -> int:
        if address in COUNTERS:
            return self.counters[address]
        if address == p.CONTROL_TIME_LOW:
            self._time_high = self.clock >> 32
            return self.clock & MOST
        return {
            **self.settings.description(),
            p.CONTROL_TIME_HIGH: self._time_high,
            p.CONTROL_DEADMAN_TICKS: self._deadman_ticks,
            p.CONTROL_ARM: self.tripped | bool(self._deadman_ticks) << 1 | self.publishing << 2,
            p.CONTROL_PUBLISH: self.publishing,
        }[address]

    def _set_control(self, address: int, value: int) -> None:
        if address == p.CONTROL_DEADMAN_TICKS:
            self._deadman_ticks, self._silent_ticks = value, 0
        elif address == p.CONTROL_ARM:
            self.tripped = False
        else:
            self.publishing = bool(value)
            self._ticks = 0

    def tick(self) -> bytes:
        """Do one tick of base_hz: the dead-man counts, and the groups that are due publish."""
        if self._deadman_ticks:
            self._silent_ticks += 1
            if self._silent_ticks >= self._deadman_ticks:
                self._trip()
        published = b""
        if self.open and self.publishing:
            for number, group in enumerate(self.groups):
                if group.addresses and group.divisor and self._ticks % group.divisor == 0:
                    published += self.publish(number)
            self._ticks += 1
        return published

    def publish(self, number: int) -> bytes:
        """Return one publish of a group, as its tick or event makes it."""
        group = self.groups[number]
        try:
            words = b"".join(field((self._read(address), self.settings.d)) for address in group.addresses)
        except BusError:
            return b""
        head = field((number, 1), (group.sequence, 2), (self.clock & MOST, 4))
        group.sequence = (group.sequence + 1) % 0x10000
        self._count(p.CONTROL_PUBLISHES)
        return self._frame(p.DEVICE_KIND_PUBLISH, head + words)

    def _trip(self) -> None:
        self.tripped = True
        self._tripped_in_session = True
        self._deadman_ticks = 0
        self._count(p.CONTROL_DEADMAN_TRIPS)
        for address, value in self.settings.safe:
            self.bus.write(address, value)
