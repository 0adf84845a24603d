# SPDX-License-Identifier: BSD-3-Clause
"""Frames of the framed protocol (docs/protocol.md), each with its meaning."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Protocol

from unitylink import protocol as p

_REQUESTS = {
    number: name.removeprefix("REQUEST_KIND_")
    for name, number in vars(p).items()
    if name.startswith("REQUEST_KIND_")
}
_UNFLAGGED = {p.REQUEST_KIND_HELLO, p.REQUEST_KIND_OPEN, p.REQUEST_KIND_POST, p.REQUEST_KIND_POST_LIST}
_STATUSES = {
    number: name.removeprefix("REPLY_STATUS_").lower()
    for name, number in vars(p).items()
    if name.startswith("REPLY_STATUS_")
}
_CONTROLS = {
    number: name.removeprefix("CONTROL_").lower()
    for name, number in vars(p).items()
    if name.startswith("CONTROL_") and not name.startswith("CONTROL_VALUE")
}
_ANSWERED_MOST = 256  # requests that a reply may still name: twice the largest window


class Words(Protocol):
    """The known names and widths of a device's words."""

    names: Mapping[int, str]
    show: Callable[[int, int], str]
    address_bytes: int | None
    data_bytes: int | None


class FrameReader:
    """Reads the frames of a link in order. It remembers session, requests and groups."""

    def __init__(self, words: Words) -> None:
        self.words = words
        self.epoch: int | None = None
        self.always_long = False
        self.requests: dict[int, tuple[str, tuple[tuple[str, int], ...]]] = {}  # requests by id
        self.groups: dict[int, tuple[int, ...]] = {}
        self.exchanges: dict[int, tuple[list[tuple[int, int]], list[tuple[int, int]]]] = {}
        self._offered: tuple[int, bool] | None = None

    def read(self, between: bytes) -> tuple[str, str, str]:
        """Return kind, label and meaning of the bytes between two borders. See CaptureMessage."""
        kind, payload, wrong = self._open(between)
        if wrong:
            return "damaged", between.hex(), wrong
        try:
            if kind & p.FRAME_DEVICE_BIT:
                return self._answer(kind, _Fields(payload))
            return self._request(kind, _Fields(payload))
        except _CutError:
            return "damaged", between.hex(), "a frame whose payload does not fit its kind"

    def _open(self, between: bytes) -> tuple[int, bytes, str]:
        outside = between[0] in _OUTSIDE
        epoch = p.FRAME_OPEN_EPOCH if outside else self.epoch
        if self._offered is not None and not outside:  # OPEN was sent, but its reply is not in the capture
            epoch = self._offered[0] if epoch is None else epoch
        long = len(between) > p.FRAME_SHORT_MAX + p.FRAME_CRC16_BYTES or (self.always_long and not outside)
        size = len(between) - (p.FRAME_CRC32_BYTES if long else p.FRAME_CRC16_BYTES)
        if size < 2:
            return 0, b"", "too short for a frame"
        body = between[:size]
        if epoch is not None and between[size:] != check_bytes(body, epoch, long):
            return 0, b"", "wrong check: damaged on the way, or from another session"
        payload = _cobs_decoded(body[1:])
        return (0, b"", "not a frame") if payload is None else (body[0], payload, "")

    # ---- messages of the PC

    def _request(self, kind: int, fields: _Fields) -> tuple[str, str, str]:
        flags = "" if kind in _UNFLAGGED else self._flags(kind)
        operation = kind if kind in _UNFLAGGED else kind & ~(p.FRAME_CHAINED_BIT | p.FRAME_BARRIER_BIT)
        name = _REQUESTS.get(operation)
        if name is None:
            return "damaged", f"{kind:02x}", "an unknown kind of frame"
        if operation == p.REQUEST_KIND_HELLO:
            return "request", name, f"who is there? versions {fields.take(1)} to {fields.take(1)}"
        if operation == p.REQUEST_KIND_OPEN:
            fields.take(2)
            epoch, how = fields.take(2), fields.take(1)
            self._offered = epoch, bool(how & p.FRAME_CHECKED_LONG_FLAG)
            return "request", name, f"begin a session (epoch {epoch:04x})"
        number = fields.take(2)
        label = f"{name} {number}"
        behind = (
            f"after post {fields.take(2)}: " if kind not in _UNFLAGGED and kind & p.FRAME_BARRIER_BIT else ""
        )
        meaning, reads = self._asked(operation, fields)
        fields.end()
        if operation not in (p.REQUEST_KIND_POST, p.REQUEST_KIND_POST_LIST):
            self.requests.pop(number, None)
            self.requests[number] = name, reads
            if len(self.requests) > _ANSWERED_MOST:
                del self.requests[next(iter(self.requests))]
        return "request", label, flags + behind + meaning

    def _flags(self, kind: int) -> str:
        return "in order: " if kind & p.FRAME_CHAINED_BIT else ""

    def _asked(self, operation: int, fields: _Fields) -> tuple[str, tuple[tuple[str, int], ...]]:
        """Return the meaning of a request, and the words of its reply, each as (name, address)."""
        if operation == p.REQUEST_KIND_READ:
            address = self._address(fields)
            return f"read {self._name(address)}", ((self._name(address), address),)
        if operation in (p.REQUEST_KIND_WRITE, p.REQUEST_KIND_POST):
            return f"write {self._written(fields)}", ()
        if operation in (p.REQUEST_KIND_LIST, p.REQUEST_KIND_POST_LIST):
            atomic = operation == p.REQUEST_KIND_LIST and fields.take(1) & p.FRAME_ATOMIC_FLAG
            said, reads = self._listed(fields)
            return ("with the bus held: " if atomic else "") + "; ".join(said), tuple(reads)
        if operation == p.REQUEST_KIND_EXCHANGE:
            return self._exchanged(fields)
        if operation == p.REQUEST_KIND_READ_CONTROL:
            first, count = fields.take(2), fields.take(1)
            controls = [_CONTROLS.get(first + n, f"control {first + n:04x}") for n in range(count)]
            return f"read {_shortened(controls)}", tuple((control, -1) for control in controls)
        if operation == p.REQUEST_KIND_WRITE_CONTROL:
            control = fields.take(2)
            return f"{_CONTROLS.get(control, f'control {control:04x}')} = {fields.take(4)}", ()
        if operation == p.REQUEST_KIND_DEFINE_GROUP:
            group, divisor, flags = fields.take(1), fields.take(4), fields.take(1)
            addresses = tuple(self._address(fields) for _ in range(fields.take(1)))
            self.groups[group] = addresses
            rate = f" every {divisor} base periods" if divisor else ""
            event = " on its event" if flags & p.FRAME_EVENT_FLAG else ""
            return f"group {group} is {', '.join(map(self._name, addresses)) or 'empty'}{rate}{event}", ()
        if operation == p.REQUEST_KIND_DEFINE_EXCHANGE:
            return self._defined(fields), ()
        return {"SYNC": "how far are the posts?", "CLOSE": "end the session"}[_REQUESTS[operation]], ()

    def _listed(self, fields: _Fields) -> tuple[list[str], list[tuple[str, int]]]:
        said: list[str] = []
        reads: list[tuple[str, int]] = []
        while not fields.empty:
            operation, count = fields.take(1), fields.take(1)
            up = operation in (p.LIST_OPERATION_READ_UP, p.LIST_OPERATION_WRITE_UP)
            same = operation in (p.LIST_OPERATION_READ_FIFO, p.LIST_OPERATION_WRITE_FIFO)
            address, parts = 0, []
            for index in range(count):
                if index == 0 or not (up or same):
                    address = self._address(fields)
                elif up:
                    address += 1
                if operation < p.LIST_OPERATION_WRITE:
                    reads.append((self._name(address), address))
                    parts.append(self._name(address))
                elif operation == p.LIST_OPERATION_WRITE_MASKED:
                    mask = self._word(fields)
                    parts.append(f"{self._name(address)} (bits {mask:x}) = 0x{self._word(fields):x}")
                else:
                    word = self._word(fields)
                    sign = "+=" if operation == p.LIST_OPERATION_ADD else "="
                    parts.append(f"{self._name(address)} {sign} {self.words.show(address, word)}")
            verb = "read" if operation < p.LIST_OPERATION_WRITE else "write"
            said.append(f"{verb} {_shortened(parts)}")
        return said, reads

    def _defined(self, fields: _Fields) -> str:
        group, outputs, inputs = fields.take(1), fields.take(1), fields.take(1)
        sorts = [
            [(self._address(fields), fields.take(1)) for _ in range(count)] for count in (outputs, inputs)
        ]
        self.exchanges[group] = sorts[0], sorts[1]
        told = [_shortened([self._name(address) for address, _ in words]) or "nothing" for words in sorts]
        return f"exchange group {group} writes {told[0]}, reads {told[1]}"

    def _exchanged(self, fields: _Fields) -> tuple[str, tuple[tuple[str, int], ...]]:
        group = fields.take(1)
        if group not in self.exchanges:
            return f"exchange group {group}: {fields.rest().hex()}", ()
        outputs, inputs = self.exchanges[group]
        told = [f"{self._name(a)} = {self.words.show(a, fields.take(size))}" for a, size in outputs]
        return f"exchange group {group}: write {_shortened(told) or 'nothing'}", tuple(
            (self._name(address), address) for address, _ in inputs
        )

    # ---- messages of the device

    def _answer(self, kind: int, fields: _Fields) -> tuple[str, str, str]:
        if kind == p.DEVICE_KIND_HELLO:
            return "reply", "HELLO", self._greeting(fields)
        if kind == p.DEVICE_KIND_OPEN:
            self.epoch = fields.take(2)
            self.always_long = self._offered is not None and self._offered == (self.epoch, True)
            self.requests.clear()
            self.groups.clear()
            self.exchanges.clear()
            return (
                "reply",
                "OPEN",
                f"the session is open (epoch {self.epoch:04x}); device clock {fields.take(4)}",
            )
        if kind == p.DEVICE_KIND_CLOSED:
            return "error", "CLOSED", "no session is open here"
        if kind == p.DEVICE_KIND_PUBLISH:
            group, sequence, clock = fields.take(1), fields.take(2), fields.take(4)
            words = self._words_left(fields)
            addresses = self.groups.get(group, ())
            if len(addresses) != len(words):
                told = ", ".join(f"0x{word:x}" for word in words)
            else:
                told = self._pairs(((self._name(a), a) for a in addresses), words)
            return "publish", f"PUBLISH {sequence}", f"publish of group {group} at clock {clock}: {told}"
        status = _STATUSES.get(kind - p.DEVICE_KIND_REPLY)
        if status is None:
            return "damaged", f"{kind:02x}", "an unknown kind of frame"
        number = fields.take(2)
        fields.take(2)
        name, reads = self.requests.get(number, ("", ()))
        if status != "ok":
            about = f" (asked: {name})" if name else ""
            done = f" after {fields.take(2)} words" if not fields.empty else ""
            return "error", f"{status.upper()} {number}", f"{status}{done}{about}"
        return "reply", f"OK {number}", self._told(name, number, reads, fields)

    def _told(self, name: str, number: int, reads: tuple[tuple[str, int], ...], fields: _Fields) -> str:
        if not name:
            return f"answer to request {number}, which is not in the capture"
        if name == "SYNC":
            return f"{fields.take(2)} posts executed, {fields.take(2)} failed"
        if name == "LIST":
            fields.take(2)
        if name == "READ_CONTROL":
            return _shortened([f"{control} = {fields.take(4)}" for control, _ in reads])
        if name == "EXCHANGE" and reads:
            words = []
            for _, size in next(
                i for _, i in self.exchanges.values() if [a for a, _ in i] == [a for _, a in reads]
            ):
                words.append(fields.take(size))
            return self._pairs(reads, words)
        return self._pairs(reads, self._words_left(fields)) or "done"

    def _greeting(self, fields: _Fields) -> str:
        version, _, epoch = fields.take(1), fields.take(2), fields.take(2)
        self.words.address_bytes, self.words.data_bytes = fields.take(1), fields.take(1)
        credit, request, reply, window = (fields.take(n) for n in (2, 2, 2, 1))
        if self.epoch is None and epoch != p.FRAME_OPEN_EPOCH:
            self.epoch = epoch
        widths = f"{self.words.address_bytes} address bytes, {self.words.data_bytes} data bytes"
        payloads = f"payloads up to {request} and {reply} bytes"
        return f"version {version}, {widths}, window {window}, credit {credit}, {payloads}"

    # ---- parts

    def _address(self, fields: _Fields) -> int:
        if self.words.address_bytes is None:
            raise _CutError
        return fields.take(self.words.address_bytes)

    def _word(self, fields: _Fields) -> int:
        if self.words.data_bytes is None:
            raise _CutError
        return fields.take(self.words.data_bytes)

    def _written(self, fields: _Fields) -> str:
        address = self._address(fields)
        return f"{self._name(address)} = {self.words.show(address, self._word(fields))}"

    def _words_left(self, fields: _Fields) -> list[int]:
        words = []
        while not fields.empty:
            words.append(self._word(fields))
        return words

    def _name(self, address: int) -> str:
        return self.words.names.get(address, f"0x{address:x}")

    def _pairs(self, named: object, words: list[int]) -> str:
        pairs = zip(named, words)  # type: ignore[call-overload]  # noqa: B905  # a device may say less
        return _shortened([f"{name} = {self.words.show(address, word)}" for (name, address), word in pairs])


class _CutError(Exception):
    """A payload does not have the form of its kind."""


class _Fields:
    """Takes fields from the front of a payload."""

    def __init__(self, payload: bytes) -> None:
        self._payload = payload

    @property
    def empty(self) -> bool:
        return not self._payload

    def take(self, count: int) -> int:
        if len(self._payload) < count:
            raise _CutError
        value, self._payload = int.from_bytes(self._payload[:count], "big"), self._payload[count:]
        return value

    def rest(self) -> bytes:
        left, self._payload = self._payload, b""
        return left

    def end(self) -> None:
        if self._payload:
            raise _CutError


_OUTSIDE = (
    p.REQUEST_KIND_HELLO,
    p.REQUEST_KIND_OPEN,
    p.DEVICE_KIND_HELLO,
    p.DEVICE_KIND_OPEN,
    p.DEVICE_KIND_CLOSED,
)


def _table(polynomial: int) -> list[int]:
    table = []
    for value in range(256):
        for _ in range(8):
            value = value >> 1 ^ (polynomial if value & 1 else 0)  # noqa: PLW2901
        table.append(value)
    return table


_CRC16, _CRC32 = _table(p.FRAME_CRC16_POLYNOMIAL), _table(p.FRAME_CRC32_POLYNOMIAL)


def check_bytes(body: bytes, epoch: int, long: bool) -> bytes:
    """Return the check of kind and COBS bytes: seven bits in each byte, the low ones first.

    >>> check_bytes(bytes.fromhex("80030101"), 0xFFFF, False).hex()
    'fa9283'
    """
    table, value = (_CRC32, epoch << 16 | epoch) if long else (_CRC16, epoch)
    for byte in body:
        value = value >> 8 ^ table[(value ^ byte) & 0xFF]
    count = p.FRAME_CRC32_BYTES if long else p.FRAME_CRC16_BYTES
    return bytes(0x80 | value >> 7 * index & 0x7F for index in range(count))


def _cobs_decoded(encoded: bytes) -> bytes | None:
    payload = bytearray()
    while encoded:
        code, block, encoded = encoded[0], encoded[1 : encoded[0]], encoded[encoded[0] :]
        if code == 0 or len(block) != code - 1:
            return None
        payload += block
        if encoded and code < 255:
            payload.append(0)
    return bytes(payload)


def _shortened(parts: list[str]) -> str:
    """Join the parts. If there are very many, leave out the middle."""
    if len(parts) > 40:
        parts = [*parts[:20], f"… {len(parts) - 21} more …", parts[-1]]
    return ", ".join(parts)
