# SPDX-License-Identifier: BSD-3-Clause
"""The reference's frames: COBS, checks, borders."""

from __future__ import annotations

import doctest
import random

import pytest
from hypothesis import given
from hypothesis import strategies as st
from reference import framing
from reference.framing import Borders, Frame, NotCobs, cobs_decode, cobs_encode, crc

from unitylink import protocol as p

payloads = st.binary(max_size=40) | st.lists(st.sampled_from([0, 1, 255]), max_size=600).map(bytes)


def test_the_examples() -> None:
    assert doctest.testmod(framing).failed == 0


def test_check_values() -> None:
    assert crc(p.FRAME_CRC16_POLYNOMIAL, 0xFFFF, b"123456789") == p.FRAME_CRC16_CHECK
    assert crc(p.FRAME_CRC32_POLYNOMIAL, 0xFFFFFFFF, b"123456789") == p.FRAME_CRC32_CHECK


@given(payloads)
def test_cobs_there_and_back(payload: bytes) -> None:
    encoded = cobs_encode(payload)
    assert 0 not in encoded
    assert cobs_decode(encoded) == payload
    assert len(encoded) <= len(payload) + 1 + len(payload) // 254


@pytest.mark.parametrize("size", [0, 1, 253, 254, 255, 508, 509])
def test_cobs_of_long_runs(size: int) -> None:
    ones = bytes([1] * size)
    assert cobs_decode(cobs_encode(ones)) == ones  # the last block of these looks like an empty block
    payload = bytes([7]) * size
    assert cobs_decode(cobs_encode(payload)) == payload
    assert len(cobs_encode(payload)) == max(size + 1, size + -(-size // 254))


@given(st.binary(max_size=300))
def test_cobs_takes_any_bytes(encoded: bytes) -> None:
    try:
        payload = cobs_decode(encoded)
    except NotCobs:
        return
    assert cobs_decode(cobs_encode(payload)) == payload


@given(st.integers(0x80, 0xFF), payloads, st.integers(0, 0xFEFF), st.booleans())
def test_frames_there_and_back(kind: int, payload: bytes, epoch: int, always_long: bool) -> None:
    wire = Frame(kind, payload).encode(epoch, always_long=always_long)
    assert wire.endswith(b"\0") and 0 not in wire[:-1]
    assert Frame.decode(wire[:-1], epoch, always_long=always_long) == Frame(kind, payload)
    assert Frame.decode(wire[:-1], epoch ^ 1, always_long=always_long) is None


def test_the_hello_is_free_of_classic_heads() -> None:
    wire = b"\0" + Frame(p.REQUEST_KIND_HELLO, bytes([p.FRAME_VERSION] * 2)).encode()
    assert not set(wire) & set(b"#$%&")


@pytest.mark.parametrize("seed", range(2))
def test_one_and_two_flipped_bits_never_pass(seed: int) -> None:
    draw = random.Random(seed)
    epoch = draw.randrange(0xFF00)
    wire = Frame(0x83, draw.randbytes(8)).encode(epoch)
    around = Frame(0x82, draw.randbytes(4)).encode(epoch)
    stream = b"\0" + around + wire + around
    begin, end = len(around), len(around) + len(wire) + 1
    sent = [around[:-1], wire[:-1], around[:-1]]
    bits = range(8 * begin, 8 * end)
    for first in bits:
        for second in range(first, 8 * end):
            flipped = bytearray(stream)
            for bit in {first, second}:
                flipped[bit // 8] ^= 1 << bit % 8
            pieces = list(Borders().feed(bytes(flipped)))
            passed = [piece for piece in pieces if Frame.decode(piece, epoch)]
            assert all(piece in sent for piece in passed)


def test_borders_in_any_chunks() -> None:
    stream = b"\0\0one\0two\0\0three"
    borders = Borders()
    pieces = [piece for byte in stream for piece in borders.feed(bytes([byte]))]
    assert pieces == [b"one", b"two"]
    assert list(borders.feed(b"\0")) == [b"three"]
