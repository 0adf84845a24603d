# SPDX-License-Identifier: BSD-3-Clause
"""Requests of both protocols as bytes, and the lengths of their replies."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from importlib.util import module_from_spec, spec_from_file_location
from types import ModuleType

from unitylink import protocol as p
from unitylink.layer1_stream import ClassicEncoder
from unitylink.resources import resource_folder

READ_ADDRESS, WRITE_ADDRESS = 0x10, 0x11  # addresses of words in SPEC
SPEC = """link plain;
public experiment() {
   @input = 0x10: READ(ID="input");
   @output = 0x11: WRITE(ID="output");
}
"""
EPOCH = 0x1234
# bytes of a reply beside its payload, if that has less than 254 bytes: kind, COBS, check, border
_FRAME_BYTES = 6
_REPLY_HEAD_BYTES = 4  # the id and the count of posts
_LIST_WORDS = 60  # the most that fit into a reply of 250 bytes of payload


@dataclass(frozen=True)
class Exchange:
    """A request and the number of bytes in its reply. `number` counts the requests of a session from 0.

    >>> read().request(0), read().reply_bytes
    (b'#R:10\\n', 14)
    """

    name: str
    request: Callable[[int], bytes]
    reply_bytes: int
    checked: bool = False

    @property
    def request_bytes(self) -> int:
        return len(self.request(0))

    @property
    def bits(self) -> int:
        return 8 * (self.request_bytes + self.reply_bytes)

    @property
    def title(self) -> str:
        return self.name + (", CRC" if self.checked else "")

    def burst(self, count: int) -> bytes:
        """Return the first `count` requests of a session."""
        return b"".join(map(self.request, range(count)))


def read(*, checked: bool = False) -> Exchange:
    """Return the classic read of one word."""
    return _classic("read", "R", bytes([READ_ADDRESS]), 14, checked)


def read_many(words: int, *, checked: bool = False) -> Exchange:
    """Return the classic read of `words` words in one request."""
    data = bytes([words]) + bytes([READ_ADDRESS]) * words
    return _classic(f"read {words}", "RM", data, 7 + 8 * words, checked)


def write(*, checked: bool = False) -> Exchange:
    """Return the classic write of one word. The word is the request's number, from 1."""
    tail = 3 if checked else 0
    encoder = ClassicEncoder(checked=checked)

    def request(number: int) -> bytes:
        return encoder.encode("W", bytes([WRITE_ADDRESS]) + (number + 1).to_bytes(4, "big"))

    return Exchange("write", request, 5 + tail, checked)


def _classic(name: str, command: str, data: bytes, reply_bytes: int, checked: bool) -> Exchange:
    request = ClassicEncoder(checked=checked).encode(command, data)
    return Exchange(name, lambda _: request, reply_bytes + (3 if checked else 0), checked)


@cache
def plain_client() -> ModuleType:
    """Return the example `plain_client`: a bare script that speaks frames with nothing but Python."""
    path = resource_folder("examples") / "plain_client" / "client.py"
    spec = spec_from_file_location("unitylink_plain_client", path)
    assert spec is not None and spec.loader is not None
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def frame(kind: int, payload: bytes, epoch: int = EPOCH) -> bytes:
    """Return a frame.

    >>> frame(p.REQUEST_KIND_HELLO, bytes([1, 1]), p.FRAME_OPEN_EPOCH).hex()[:8]
    '80030101'
    """
    data: bytes = plain_client().frame(kind, payload, epoch)
    return data


def framed_read() -> Exchange:
    """Return the framed read of one word."""
    return _framed("read", p.REQUEST_KIND_READ, lambda _: bytes([READ_ADDRESS]), 4)


def framed_write() -> Exchange:
    """Return the framed write of one word. The word is the request's number, from 1."""
    return _framed(
        "write", p.REQUEST_KIND_WRITE, lambda n: bytes([WRITE_ADDRESS]) + (n + 1).to_bytes(4, "big"), 0
    )


def framed_post() -> Exchange:
    """Return the post of one word: a write without an answer."""
    return _framed(
        "post", p.REQUEST_KIND_POST, lambda n: bytes([WRITE_ADDRESS]) + (n + 1).to_bytes(4, "big"), None
    )


def framed_read_many(words: int) -> Exchange:
    """Return the read of `words` scattered words, in as few requests as possible."""
    parts = [min(_LIST_WORDS, words - start) for start in range(0, words, _LIST_WORDS)]

    def request(number: int) -> bytes:
        return b"".join(
            frame(
                p.REQUEST_KIND_LIST,
                _id(len(parts) * number + index)
                + bytes([0, p.LIST_OPERATION_READ, part])
                + bytes([READ_ADDRESS]) * part,
            )
            for index, part in enumerate(parts)
        )

    done_bytes = 2
    replies = sum(_FRAME_BYTES + _REPLY_HEAD_BYTES + done_bytes + 4 * part for part in parts)
    return Exchange(f"read {words}", request, replies)


def _framed(name: str, kind: int, rest: Callable[[int], bytes], data_bytes: int | None) -> Exchange:
    reply = 0 if data_bytes is None else _FRAME_BYTES + _REPLY_HEAD_BYTES + data_bytes
    return Exchange(name, lambda number: frame(kind, _id(number) + rest(number)), reply)


def _id(number: int) -> bytes:
    return (number % 0x10000).to_bytes(2, "big")
