# SPDX-License-Identifier: BSD-3-Clause
"""Frames in a capture, made by the reference implementation and by a real link."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from reference.framing import Frame

from unitylink import Link
from unitylink import protocol as p
from unitylink.capture import CaptureMessage, MessageReader, Packet, messages, read_packets
from unitylink.errors import BusError
from unitylink.simulate import Board, BoardConfiguration

NAMES = {0x10: "x.position", 0x11: "x.target"}
EPOCH = 0x1234


def field(*parts: tuple[int, int]) -> bytes:
    return b"".join(value.to_bytes(size, "big") for value, size in parts)


def greeting() -> bytes:
    told = field((1, 1), (7, 2), (0xFFFF, 2), (2, 1), (4, 1), (512, 2), (250, 2), (250, 2), (8, 1), (16, 1))
    return Frame(p.DEVICE_KIND_HELLO, told + bytes(10)).encode()


def said(*parts: tuple[str, bytes]) -> list[CaptureMessage]:
    """Return the messages of a session in which these bytes follow its opening."""
    opening = [
        (">", b"\0" + Frame(p.REQUEST_KIND_HELLO, b"\1\1").encode()),
        ("<", greeting()),
        (">", Frame(p.REQUEST_KIND_OPEN, field((7, 2), (EPOCH, 2), (0, 1))).encode()),
        ("<", Frame(p.DEVICE_KIND_OPEN, field((EPOCH, 2), (99, 4))).encode()),
    ]
    packets = [
        Packet(float(index), "sent" if arrow == ">" else "received", data)
        for index, (arrow, data) in enumerate([*opening, *parts])
    ]
    return list(messages(packets, MessageReader(NAMES)))[len(opening) :]


def request(kind: int, *parts: tuple[int, int]) -> tuple[str, bytes]:
    return ">", Frame(kind, field(*parts)).encode(EPOCH)


def answer(kind: int, *parts: tuple[int, int]) -> tuple[str, bytes]:
    return "<", Frame(kind, field(*parts)).encode(EPOCH)


def test_answers_belong_to_the_requests_whose_id_they_have() -> None:
    found = said(
        request(p.REQUEST_KIND_READ, (5, 2), (0x10, 2)),
        request(
            p.REQUEST_KIND_WRITE | p.FRAME_CHAINED_BIT | p.FRAME_BARRIER_BIT,
            (6, 2),
            (3, 2),
            (0x11, 2),
            (9, 4),
        ),
        answer(p.DEVICE_KIND_REPLY + p.REPLY_STATUS_DENIED, (6, 2), (3, 2)),
        answer(p.DEVICE_KIND_REPLY, (5, 2), (3, 2), (0x1F, 4)),
    )
    assert [(m.kind, m.text, m.meaning) for m in found] == [
        ("request", "READ 5", "read x.position"),
        ("request", "WRITE 6", "in order: after post 3: write x.target = 0x9"),
        ("error", "DENIED 6", "denied (asked: WRITE)"),
        ("reply", "OK 5", "x.position = 0x1f"),
    ]


def test_groups_give_publishes_and_exchanges_their_names() -> None:
    found = said(
        request(p.REQUEST_KIND_DEFINE_GROUP, (0, 2), (2, 1), (10, 4), (0, 1), (1, 1), (0x10, 2)),
        answer(p.DEVICE_KIND_PUBLISH, (2, 1), (7, 2), (1000, 4), (0x22, 4)),
        request(
            p.REQUEST_KIND_DEFINE_EXCHANGE,
            (1, 2),
            (0, 1),
            (1, 1),
            (1, 1),
            (0x11, 2),
            (1, 1),
            (0x10, 2),
            (2, 1),
        ),
        request(p.REQUEST_KIND_EXCHANGE, (2, 2), (0, 1), (0x33, 1)),
        answer(p.DEVICE_KIND_REPLY, (2, 2), (0, 2), (0x4455, 2)),
    )
    assert [m.meaning for m in found] == [
        "group 2 is x.position every 10 base periods",
        "publish of group 2 at clock 1000: x.position = 0x22",
        "exchange group 0 writes x.target, reads x.position",
        "exchange group 0: write x.target = 0x33",
        "x.position = 0x4455",
    ]


def test_damage_and_other_sessions_are_believed_by_nobody() -> None:
    good = request(p.REQUEST_KIND_READ, (5, 2), (0x10, 2))[1]
    flipped = bytes([good[0], good[1] ^ 4]) + good[2:]
    other = Frame(p.REQUEST_KIND_READ, field((5, 2), (0x10, 2))).encode(EPOCH + 1)
    short = request(p.REQUEST_KIND_READ, (5, 2), (0x10, 1))[1]
    found = said((">", flipped), (">", other), (">", short), (">", b"\x82\1\0"))
    assert [m.kind for m in found] == ["damaged"] * 4
    assert [m.meaning.split(":")[0] for m in found[:3]] == [
        "wrong check",
        "wrong check",
        "a frame whose payload does not fit its kind",
    ]


@given(data=st.lists(st.tuples(st.booleans(), st.binary(max_size=40)), max_size=8))
def test_any_bytes_in_a_session_give_messages_that_hold_them(data: list[tuple[bool, bytes]]) -> None:
    found = said(*((">" if sent else "<", part) for sent, part in data))
    for direction, sent in (("sent", True), ("received", False)):
        whole = b"".join(part for side, part in data if side == sent)
        assert b"".join(m.data for m in found if m.direction == direction) == whole


def test_a_real_session_has_no_byte_without_meaning(tmp_path: Path) -> None:
    trace = tmp_path / "all.pcapng"
    configuration = BoardConfiguration(silent_ranges=((0x77, 0x77),))
    with Board(configuration=configuration) as board, Link(f"{board.url}?timeout=2&trace={trace}") as link:
        link.write(0x11, 3)
        link.post_many([0x11, 0x12, 0x13], [1, 2, 3])
        link.sync()
        with link.batch() as batch:
            batch.add(0x11, 1)
            batch.write_masked(0x12, 0xF, 5)
            batch.read_many(range(0x10, 0x30))
        with link.exchange_group(writes=[(0x11, 2)], reads=[0x10, (0x11, 1)]) as group:
            group.exchange([500])
        with pytest.raises(BusError):
            link.read(0x77)
        with link.subscribe([0x10], divisor=1) as positions:
            positions.wait(2.0)
    found = list(messages(read_packets(trace), MessageReader(NAMES)))
    assert not [m for m in found if m.kind == "damaged"]
    told = " | ".join(m.meaning for m in found)
    for part in (
        "write x.target = 0x1, 0x12 = 0x2, 0x13 = 0x3",
        "1 posts executed, 0 failed",
        "write x.target += 0x1; write 0x12 (bits f) = 0x5; read x.position, x.target",
        "exchange group 0: write x.target = 0x1f4",
        "x.target = 0xf4",
        "bus_timeout (asked: READ)",
        "publish of group",
    ):
        assert part in told, part
