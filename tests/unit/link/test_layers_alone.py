# SPDX-License-Identifier: BSD-3-Clause
"""Layers 0 and 1 without those above. Cutting any bytes into any chunks gives the same messages."""

from __future__ import annotations

import doctest
import socket
from types import ModuleType

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

import unitylink.layer1_stream as layer1
from unitylink import LinkClosed, UrlError, ValueRangeError
from unitylink.layer0_driver import Driver
from unitylink.layer1_stream import (
    ApplicationError,
    BadMessage,
    Busy,
    ClassicDecoder,
    ClassicEncoder,
    DatalinkError,
    Garbage,
    Publish,
    Reply,
)

LINES = [
    b"$S_R:40de1212*2d\n",
    b"&PUB:000240de101040de1111*ba\n",
    b"?f4\n",
    b"$CNF:01,04,20,02,03e8,02,10,02*a7\n",
    b"#S_RM:40de1111?E_MAB\n",
    b"%PUB:0001aabbccdd\n",
    b"?busy\n",
    b"\n",
]
STREAM = st.lists(st.one_of(st.sampled_from(LINES), st.binary(max_size=40)), max_size=12).map(b"".join)


def test_driver_alone(fake: ModuleType) -> None:
    device = fake.FakeDevice()
    with Driver(device.url("")[:-1]) as driver:
        assert driver.fileno() >= 0
        assert driver.receive(timeout_s=0) == b""
        driver.send(b"#R:12\n")
        assert driver.receive(timeout_s=10) == b"#S_R:40de1212\n"
        device.unplug()
        with pytest.raises(LinkClosed, match="the other side closed"):
            driver.receive(timeout_s=10)
    with pytest.raises(LinkClosed, match="the driver is closed"):
        driver.send(b"x")
    device.close()
    with pytest.raises(UrlError):
        Driver("nothing")


def test_driver_over_udp_says_goodbye() -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as board:
        board.bind(("127.0.0.1", 0))
        board.settimeout(10)
        with Driver(f"udp://127.0.0.1:{board.getsockname()[1]}") as driver:
            driver.send(b"#RLC\n")
            assert board.recv(100) == b"#RLC\n"
        assert board.recv(100) == b""


def test_examples_in_the_documentation() -> None:
    assert doctest.testmod(layer1).failed == 0


def test_encoder() -> None:
    assert ClassicEncoder().encode("R", b"\x12") == b"#R:12\n"
    assert ClassicEncoder(checked=True).encode("RLC") == b"$RLC*9B\n"
    assert ClassicEncoder(checked=True, polynomial=None).encode("R", b"\x12") == b"$R:12*40\n"
    with pytest.raises(ValueRangeError, match="letters A to Z"):
        ClassicEncoder().encode("R:12\n#W")
    with pytest.raises(ValueRangeError, match="polynomial"):
        ClassicEncoder(polynomial=256)


def test_decoder_events() -> None:
    decoder = ClassicDecoder(data_bytes=4)
    assert decoder.feed(b"".join(LINES) + b"xy\n$S_W*00\n#S_R:1\n") == [
        Reply("$", "S_R", bytes.fromhex("40de1212")),
        Publish(True, 0, 2, (0x40DE1010, 0x40DE1111)),
        DatalinkError(0xF4),
        Reply("$", "CNF", b"", "01,04,20,02,03e8,02,10,02"),
        ApplicationError("#", "S_RM", bytes.fromhex("40de1111"), "E_MAB"),
        Publish(False, 0, 1, (0xAABBCCDD,)),
        Busy(),
        Garbage(1),
        Garbage(3),
        BadMessage("$", "bad_checksum"),
        BadMessage("#", "malformed"),
    ]
    with pytest.raises(ValueRangeError, match="1 to 4 bytes"):
        ClassicDecoder(data_bytes=5)


@given(stream=STREAM, data=st.data())
def test_chunks_do_not_matter(stream: bytes, data: st.DataObject) -> None:
    whole = ClassicDecoder().feed(stream)
    single = ClassicDecoder()
    assert [event for byte in stream for event in single.feed(bytes([byte]))] == whole
    cuts = sorted(data.draw(st.lists(st.integers(0, len(stream)), max_size=6)))
    pieces = ClassicDecoder()
    got = [e for a, b in zip([0, *cuts], [*cuts, len(stream)], strict=True) for e in pieces.feed(stream[a:b])]
    assert got == whole


@given(
    words=st.lists(st.integers(0, 2**32 - 1), min_size=1, max_size=255),
    position=st.integers(0),
    bit=st.integers(0, 7),
)
# a digit turns into the head of a message
@example(words=[0x8D4D6, 0x81F, 0x1052D74, 0x6E, 0x2CD08], position=48, bit=6)
def test_one_wrong_bit_gives_no_wrong_value(words: list[int], position: int, bit: int) -> None:
    data = b"".join(word.to_bytes(4, "big") for word in words)
    text = bytearray(ClassicEncoder(checked=True).encode("X", data).replace(b"$X", b"$S_RM").lower())
    text[1:5] = b"S_RM"
    text[-3:-1] = f"{_crc(b'S_RM' + data):02x}".encode()
    good = ClassicDecoder().feed(bytes(text))
    assert good == [Reply("$", "S_RM", data)]
    text[position % (len(text) - 1)] ^= 1 << bit
    for event in ClassicDecoder().feed(bytes(text)):
        if isinstance(event, Reply):  # the case of a letter in a hexadecimal digit means nothing
            assert event.data == data


def _crc(data: bytes) -> int:
    remainder = 0
    for byte in data:
        remainder ^= byte
        for _ in range(8):
            remainder = (remainder << 1 ^ 0x07) & 0xFF if remainder & 0x80 else remainder << 1
    return remainder


def test_a_head_with_a_letter_after_it_is_not_a_reply() -> None:
    """This is a checksum `3f` in which one bit was flipped."""
    assert not [e for e in ClassicDecoder().feed(b"$S_R:40de1212*#f\n") if isinstance(e, Reply)]
