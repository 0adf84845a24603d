# SPDX-License-Identifier: BSD-3-Clause
"""The messages of a bridge: what goes in comes out, and whatever else comes is a ProtocolError."""

from __future__ import annotations

import random
from collections.abc import Callable
from typing import Any

import pytest

from unitylink.errors import LeaseHeld, ProtocolError, UnityLinkError, UnknownName, ValueRangeError
from unitylink.zenoh.failures import decode_failure, encode_failure
from unitylink.zenoh.hello import read_welcome
from unitylink.zenoh.messages import (
    DO,
    HEAD_BYTES,
    ONCE,
    SUBSCRIBE,
    WRITE_VALUE,
    Answer,
    Request,
    SetPoint,
    decode_answer,
    decode_request,
    decode_sample,
    decode_set_point,
    operations_of,
)

MUTATIONS = 25_000  # of each kind of message
REQUEST = Request(DO, 7, 9, 3, -5, ONCE, operations=((1, 0x10, 0, 0), (20, 0x11, 5, 0xF0)))
POINT = SetPoint("lab/arm1/set/j1", 7, 2, 10**12, b"\x01\x02\x03\x04")

WELCOME = (
    b'{"visit":7,"bridge":"ab","now_ns":5,"hash":"12","configuration":{"address_bytes":2,"data_bytes":4,'
    b'"read_many":8,"publish_mode":1,"base_hz":1000,"groups":2,"group_size":8,"rate_bytes":2,'
    b'"discovered":true,"usable_group_size":8}}'
)


def test_a_request_comes_out_as_it_went_in() -> None:
    for request in (
        REQUEST,
        Request(SUBSCRIBE, 1, 2, argument=10, detail=3, operations=operations_of(1, [5, 6])),
        Request(WRITE_VALUE, 2**64 - 1, 2**64 - 1, body=b"12345678"),
    ):
        assert decode_request(request.encode()) == request
    assert REQUEST.writes and REQUEST.once
    assert not Request(DO, 1, 1, operations=operations_of(1, [5])).once


def test_an_answer_and_a_set_point_come_out_as_they_went_in() -> None:
    answer = Answer(9, 4, (0, 2**32 - 1))
    assert decode_answer(answer.encode()) == answer
    assert decode_set_point(POINT.key, POINT.encode()) == POINT


@pytest.mark.parametrize(
    ("data", "why"),
    [
        (b"", "its head alone"),
        (b"\x02" + REQUEST.encode()[1:], "of version 2"),
        (b"\x01\x63" + REQUEST.encode()[2:], "the kind 99"),
        (REQUEST.encode()[:-1], "2 operations, which take"),
        (REQUEST.encode() + b"x", "2 operations, which take"),
        (REQUEST.encode()[:HEAD_BYTES] + b"\x09" + REQUEST.encode()[HEAD_BYTES + 1 :], "the operation 9"),
        (REQUEST.encode()[:2] + b"\xff\xff" + REQUEST.encode()[4:], "the flags"),
    ],
)
def test_a_wrong_request_is_named(data: bytes, why: str) -> None:
    with pytest.raises(ProtocolError, match=why):
        decode_request(data)


@pytest.mark.parametrize(
    ("good", "decode"),
    [
        (REQUEST.encode(), decode_request),
        (Answer(1, 2, (3, 4)).encode(), decode_answer),
        (POINT.encode(), lambda data: decode_set_point("k", data)),
        (b"\0" * 20, lambda data: decode_sample(data, 2)),
        (encode_failure(LeaseHeld("ana holds it", address=5)), decode_failure),
        (WELCOME, read_welcome),
    ],
    ids=["request", "answer", "set-point", "sample", "failure", "welcome"],
)
def test_mutated_bytes_are_refused_and_nothing_else(good: bytes, decode: Callable[[bytes], Any]) -> None:
    """A decoder meets what anybody on the network puts there."""
    chance = random.Random(24)
    refused = 0
    for _ in range(MUTATIONS):
        data = bytearray(good)
        for _ in range(chance.randint(1, 4)):
            place = chance.randrange(len(data) + 1)
            kind = chance.randrange(4)
            if kind == 0 and place < len(data):
                data[place] ^= 1 << chance.randrange(8)
            elif kind == 1:
                data[place:place] = chance.randbytes(chance.randint(1, 9))
            elif kind == 2:
                del data[place : place + chance.randint(1, 9)]
            elif place < len(data):
                data[place] = chance.choice((0, 0xFF, 0x7F, 0x80))
        try:
            decode(bytes(data))
        except ProtocolError:
            refused += 1
    assert refused > MUTATIONS / 4 or decode is decode_failure


@pytest.mark.parametrize(
    ("old", "new"),
    [
        (b'"visit":7', b'"visit":Infinity'),
        (b'"visit":7', b'"visit":-1'),
        (b'"visit":7', b'"visit":1e30'),
        (b'"now_ns":5', b'"now_ns":36893488147419103232'),
        (b'"bridge":"ab"', b'"bridge":"-ab"'),
        (b'"data_bytes":4', b'"data_bytes":0'),
        (b'"data_bytes":4', b'"data_bytes":Infinity'),
        (b'"groups":2', b'"groups":-2'),
        (b'"groups":2,', b""),
        (WELCOME, b"[" * 100_000),
    ],
)
def test_a_bridge_that_cannot_be_is_refused_at_its_hello(old: bytes, new: bytes) -> None:
    assert read_welcome(WELCOME)["configuration"]["data_bytes"] == 4
    with pytest.raises(ProtocolError, match="answers a hello with something else"):
        read_welcome(WELCOME.replace(old, new))


def test_errors_keep_their_kind() -> None:
    named = (ValueRangeError("j1: NaN"), UnknownName("j9 is no item"))
    for error in (LeaseHeld("ana holds it", address=5), *named, ProtocolError("x")):
        told = decode_failure(encode_failure(error))
        assert type(told) is type(error) and str(told) == str(error)
        assert getattr(told, "address", None) == getattr(error, "address", None)
    assert isinstance(decode_failure(b'{"error":"SystemExit","text":"x"}'), UnityLinkError)
