# SPDX-License-Identifier: BSD-3-Clause
"""Packets to messages, each with its meaning: lines of the classic protocol, and frames.

The host's lines are read as text. The decoder of layer 1 reads the device's lines. The order of requests
tells which one a reply answers. The last WSA of a group tells the contents of its publishes. The bytes of a
reply or a publish do not tell this.
"""

from __future__ import annotations

import heapq
import re
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass

from unitylink import protocol
from unitylink.layer1_stream import (
    ApplicationError,
    BadMessage,
    Busy,
    ClassicDecoder,
    DatalinkError,
    Event,
    Garbage,
    Publish,
    Reply,
)

from .frames import FrameReader
from .pcapng import RECEIVED, SENT, Packet

_REQUEST = re.compile(rb"(!?)([#$])([A-Za-z]*)(?::([0-9A-Fa-f]*))?(?:\*([0-9A-Fa-f]{2}))?$")
_IGNORED = bytes.maketrans(b"", b""), b"\t ,.\r"
# After a border or a line feed, the next byte decides (docs/protocol.md, section 1).
_PIECE = re.compile(rb"\x00*(?:[\x80-\xff][^\x00]*\x00|[^\x00\x80-\xff][^\n\x00]*[\n\x00]|\n)", re.DOTALL)
_OUT_OF_ORDER_MOST = 16
_KINDS_FIRST = 0x80  # of frames
Show = Callable[[int, int], str]  # address, raw word -> text


@dataclass(frozen=True)
class CaptureMessage:
    """One message. `time_s` is the time of its last byte, `text` its bytes, `meaning` their meaning.

    `kind` is "request", "reply", "publish", "error" (sent by the device) or "damaged" (to be ignored).
    """

    time_s: float
    direction: str
    data: bytes
    kind: str
    meaning: str
    label: str = ""

    @property
    def text(self) -> str:
        """The bytes in printable form: `$R:12*58`. For a frame its kind and id: `READ 7`, `OK 7`."""
        if self.label:
            return self.label
        return self.data.rstrip(b"\r\n").decode("ascii", "backslashreplace").replace("\x1b", "\\x1b")


@dataclass(frozen=True)
class _Request:
    command: str
    data: bytes
    address: int | None = None


def messages(packets: Iterable[Packet], reader: MessageReader | None = None) -> Iterator[CaptureMessage]:
    """Yield the messages in `packets`, as `reader` understands them.

    The device tells the widths in its CNF. If the capture has no CNF, give the widths to the reader.
    Otherwise addresses are not decoded.
    """
    reader = reader or MessageReader()
    sides = {SENT: Pieces(), RECEIVED: Pieces()}
    time_s = 0.0
    for packet in _in_order(packets):
        time_s = packet.time_s
        for piece in sides[packet.direction].feed(packet.data):
            yield reader.read(time_s, packet.direction, piece)
    for direction, side in sides.items():
        if side.rest:
            why = "the capture ends within this message"
            yield CaptureMessage(time_s, direction, side.rest, "damaged", why)


class Pieces:
    r"""Cuts one direction of a link into lines, each with its line feed, and frames, each with its closing
    border.

    Borders before a piece belong to it, so that no byte is left out.

    >>> Pieces().feed(b"#R:12\n\0\x80\3\1\1\xfa\x92\x83\0")
    [b'#R:12\n', b'\x00\x80\x03\x01\x01\xfa\x92\x83\x00']
    """

    def __init__(self) -> None:
        self.rest = b""

    def feed(self, data: bytes) -> list[bytes]:
        """Return the pieces that are complete with `data`. They may begin in earlier bytes."""
        self.rest += data
        pieces = []
        while match := _PIECE.match(self.rest):
            pieces.append(match[0])
            self.rest = self.rest[match.end() :]
        return pieces


def _in_order(packets: Iterable[Packet]) -> Iterator[Packet]:
    """Sort by time within a few packets. The sending and the receiving thread write independently."""
    heap: list[tuple[float, int, Packet]] = []
    for number, packet in enumerate(packets):
        heapq.heappush(heap, (packet.time_s, number, packet))
        if len(heap) > _OUT_OF_ORDER_MOST:
            yield heapq.heappop(heap)[2]
    while heap:
        yield heapq.heappop(heap)[2]


class MessageReader:
    """Reads the lines of a link in order. It remembers requests, widths and groups.

    >>> reader = MessageReader({0x88: "j1.cpos"}, address_bytes=1)
    >>> reader.read(0.0, "sent", b"#R:88\\n").meaning
    'read j1.cpos'
    >>> reader.read(0.1, "received", b"#S_R:00000005\\n").meaning
    'j1.cpos = 0x5'
    """

    def __init__(
        self,
        names: Mapping[int, str] | None = None,
        show: Show | None = None,
        *,
        address_bytes: int | None = None,
        data_bytes: int | None = None,
        polynomial: int | None = protocol.CRC8_POLYNOMIAL,
    ) -> None:
        self.names = names or {}
        self.show = show or _hex_word
        self.address_bytes = address_bytes
        self.data_bytes = data_bytes
        self.polynomial = polynomial
        self.waiting: deque[_Request] = deque()
        self.groups: dict[int, tuple[int, ...]] = {}
        self.frames = FrameReader(self)

    def read(self, time_s: float, direction: str, line: bytes) -> CaptureMessage:
        """Return the message of `line` with its line feed, or of a frame with its border."""
        bare = line.strip(b"\0")
        if bare and bare[0] >= _KINDS_FIRST:
            kind, label, meaning = self.frames.read(bare)
            return CaptureMessage(time_s, direction, line, kind, meaning, label)
        kind, meaning = self._request(line) if direction == SENT else self._answer(line)
        return CaptureMessage(time_s, direction, line, kind, meaning)

    # ---- messages of the PC

    def _request(self, line: bytes) -> tuple[str, str]:
        match = _REQUEST.match(line.lstrip(b"\0")[:-1].translate(*_IGNORED))
        if match is None or len(match[4] or b"") % 2:
            return "damaged", "not a request"
        fence, _, letters, digits, _ = match.groups()
        command, data = letters.decode().upper(), bytes.fromhex((digits or b"").decode())
        request = _Request(command, data)
        if fence:
            self.waiting.clear()
            meaning = "resynchronise: all earlier requests are void"
        else:
            meaning = self._asked(request)
        self.waiting.append(request)
        return "request", meaning

    def _asked(self, request: _Request) -> str:
        command, data = request.command, request.data
        if command in _PLAIN_REQUESTS:
            return _PLAIN_REQUESTS[command]
        if command == protocol.COMMAND_WRITE_EVENT_MASK:
            return f"publish on event: groups {_groups_of(data)}"
        rates = protocol.COMMAND_READ_GROUP, protocol.COMMAND_WRITE_GROUP_RATE
        if command in rates and 0 < len(data) <= _RATE_BYTES_MOST:
            rate = int.from_bytes(data[1:], "big")
            if command == protocol.COMMAND_READ_GROUP:
                return f"what is group {data[0]} set to?"
            return f"group {data[0]}: " + (f"publish every {rate} base periods" if rate else "no rate")
        if self.address_bytes is None:
            return f"{command} (address width not known; add --address-bytes)" if command else "empty message"
        size = self.address_bytes
        if command == protocol.COMMAND_READ and len(data) == size:
            return f"read {self._name(int.from_bytes(data, 'big'))}"
        if command == protocol.COMMAND_WRITE and len(data) > size:
            address = int.from_bytes(data[:size], "big")
            return f"write {self._name(address)} = {self.show(address, int.from_bytes(data[size:], 'big'))}"
        if command == protocol.COMMAND_READ_MANY and data and len(data) == 1 + data[0] * size:
            return "read " + ", ".join(map(self._name, self._addresses(data[1:])))
        if command == protocol.COMMAND_WRITE_GROUP_ADDRESSES and data[1:] and len(data) == 2 + data[1] * size:
            addresses = self._addresses(data[2:])
            self.groups[data[0]] = addresses
            return f"group {data[0]} is " + (", ".join(map(self._name, addresses)) or "empty")
        return f"{command}: unknown or not complete" if command else "empty message"

    # ---- messages of the device

    def _answer(self, line: bytes) -> tuple[str, str]:
        decoder = ClassicDecoder(data_bytes=self.data_bytes or 0, polynomial=self.polynomial)
        events = decoder.feed(line.lstrip(b"\0"))
        kinds, meanings = zip(*(self._said(event) for event in events), strict=True) if events else ((), ())
        if not events:
            return "damaged", "no message"
        worst = next((kind for kind in ("damaged", "error") if kind in kinds), kinds[-1])
        return worst, "; ".join(meanings)

    def _said(self, event: Event) -> tuple[str, str]:
        if isinstance(event, Publish):
            return "publish", self._published(event)
        if isinstance(event, Reply):
            return "reply", self._replied(event)
        if isinstance(event, ApplicationError):
            request = self.waiting.popleft() if self.waiting else None
            about = f" (asked: {self._asked(request)})" if request else ""
            return "error", f"{event.error}: {protocol.APPLICATION_ERRORS.get(event.error, 'unknown')}{about}"
        if isinstance(event, DatalinkError):
            if self.waiting:
                self.waiting.popleft()
            return "error", f"datalink: {_datalink_error(event.code)}"
        if isinstance(event, Busy):
            return "error", "the board serves another program"
        if isinstance(event, BadMessage):
            if self.waiting and event.head in "#$":
                self.waiting.popleft()
            return "damaged", event.reason.replace("_", " ")
        assert isinstance(event, Garbage)
        return "damaged", f"{event.count} bytes that belong to no message"

    def _published(self, event: Publish) -> str:
        addresses = self.groups.get(event.group, ())
        if len(addresses) != len(event.words):
            words = ", ".join(f"0x{word:x}" for word in event.words)
            return f"publish of group {event.group}: {words or 'not read: the data width is not known'}"
        return f"publish of group {event.group}: " + self._pairs(addresses, event.words)

    def _replied(self, event: Reply) -> str:
        request = self.waiting.popleft() if self.waiting else None
        if event.letters == protocol.REPLY_READ_CONFIGURATION:
            fields = [int(field, 16) if field else 0 for field in event.fields.split(",")]
            if len(fields) == 8 and all(1 <= width <= 4 for width in fields[:2]):
                self.address_bytes, self.data_bytes = fields[0], fields[1]
                return (
                    f"configuration: {fields[0]} address bytes, {fields[1]} data bytes, "
                    f"read-many {fields[2]}, base {fields[4]} Hz, {fields[5] or 256} groups of {fields[6]}"
                )
            return "configuration that no device has"
        if request is None or event.letters != f"S_{request.command}":
            return f"{event.letters} to a request that is not in the capture"
        words = self._words(event.data)
        if request.command == protocol.COMMAND_READ and self.address_bytes and len(words) == 1:
            return self._pairs([int.from_bytes(request.data, "big")], words)
        if request.command == protocol.COMMAND_READ_MANY and self.address_bytes:
            return self._pairs(self._addresses(request.data[1:]), words)
        if request.command == protocol.COMMAND_READ_EVENT_MASK:
            return f"groups on event: {_groups_of(event.data)}"
        return "done"

    # ---- parts

    def _name(self, address: int) -> str:
        return self.names.get(address, f"0x{address:x}")

    def _pairs(self, addresses: Iterable[int], words: Iterable[int]) -> str:
        pairs = zip(addresses, words)  # noqa: B905  # a device may say less than was asked
        return ", ".join(f"{self._name(address)} = {self.show(address, word)}" for address, word in pairs)

    def _addresses(self, data: bytes) -> tuple[int, ...]:
        size = self.address_bytes or 1
        return tuple(int.from_bytes(data[at : at + size], "big") for at in range(0, len(data), size))

    def _words(self, data: bytes) -> tuple[int, ...]:
        size = self.data_bytes or len(data) or 1
        return tuple(int.from_bytes(data[at : at + size], "big") for at in range(0, len(data), size))


_PLAIN_REQUESTS = {
    protocol.COMMAND_READ_CONFIGURATION: "what is your configuration?",
    protocol.COMMAND_ENABLE_PUBLISHING: "publishing on",
    protocol.COMMAND_ENABLE_CHECKED_PUBLISHING: "publishing on, with checksums",
    protocol.COMMAND_DISABLE_PUBLISHING: "publishing off",
    protocol.COMMAND_READ_EVENT_MASK: "which groups publish on event?",
}


_RATE_BYTES_MOST = 1 + 4  # the group and its rate


def _hex_word(address: int, word: int) -> str:
    return f"0x{word:x}"


def _groups_of(mask: bytes) -> str:
    if len(mask) > protocol.GROUPS_MAX // 8:
        return "more than there are"
    value = int.from_bytes(mask, "big")
    return ", ".join(str(bit) for bit in range(8 * len(mask)) if value >> bit & 1) or "none"


def _datalink_error(code: int) -> str:
    if code < protocol.DATALINK_ERROR_PHYSICAL:
        return protocol.DATALINK_ERRORS.get(code, f"code {code:x}")
    lines = ("parity", "framing", "overrun")
    flags = code - protocol.DATALINK_ERROR_PHYSICAL
    return " and ".join(line for bit, line in enumerate(lines) if flags >> bit & 1) + " error on the line"
