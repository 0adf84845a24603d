# SPDX-License-Identifier: BSD-3-Clause
"""The reference device keeps what docs/protocol.md promises."""

from __future__ import annotations

import pytest
from reference.bus import Bus
from reference.device import ReferenceDevice
from reference.framing import Borders, Frame, field
from reference.settings import Settings

from unitylink import protocol as p

EPOCH = 0x1234


class Host:
    """Sends frames to a reference device and takes its answers apart."""

    def __init__(self, device: ReferenceDevice | None = None, epoch: int = EPOCH) -> None:
        self.device = device or ReferenceDevice()
        self.epoch = epoch

    def outside(self, kind: int, payload: bytes) -> list[Frame | None]:
        return [
            Frame.decode(piece, p.FRAME_OPEN_EPOCH)
            for piece in Borders().feed(self.device.feed(Frame(kind, payload).encode()))
        ]

    def hello(self) -> int:
        (answer,) = self.outside(p.REQUEST_KIND_HELLO, bytes([1, 1]))
        assert answer is not None and answer.kind == p.DEVICE_KIND_HELLO
        assert answer.payload[0] == p.FRAME_VERSION
        return int.from_bytes(answer.payload[1:3], "big")

    def open(self) -> Host:
        nonce = self.hello()
        (answer,) = self.outside(p.REQUEST_KIND_OPEN, field((nonce, 2), (self.epoch, 2), (0, 1)))
        assert answer is not None and answer.kind == p.DEVICE_KIND_OPEN
        return self

    def ask(self, kind: int, payload: bytes) -> Frame | None:
        wire = self.device.feed(Frame(kind, payload).encode(self.epoch))
        pieces = list(Borders().feed(wire))
        assert len(pieces) <= 1
        return Frame.decode(pieces[0], self.epoch) if pieces else None

    def request(self, kind: int, payload: bytes) -> tuple[int, bytes]:
        """Return the status, and the bytes after `posts`."""
        answer = self.ask(kind, payload)
        assert answer is not None
        return answer.kind - p.DEVICE_KIND_REPLY, answer.payload[4:]


@pytest.fixture
def host() -> Host:
    return Host().open()


def test_write_and_read(host: Host) -> None:
    assert host.request(p.REQUEST_KIND_WRITE, field((0, 2), (0x10, 2), (7, 4))) == (0, b"")
    assert host.request(p.REQUEST_KIND_READ, field((1, 2), (0x10, 2))) == (0, field((7, 4)))


def test_a_repeat_is_answered_and_not_executed(host: Host) -> None:
    wish = field((0, 2), (0x10, 2), (7, 4))
    first = host.ask(p.REQUEST_KIND_WRITE, wish)
    assert host.ask(p.REQUEST_KIND_WRITE, wish) == first
    assert host.device.bus.log == [("write", 0x10, 7)]
    assert host.device.counters[p.CONTROL_DUPLICATES] == 1


def test_a_late_request_is_stale(host: Host) -> None:
    window = host.device.settings.window
    late = field((0, 2), (0x10, 2), (1, 4))
    host.request(p.REQUEST_KIND_WRITE, late)
    host.request(p.REQUEST_KIND_WRITE, field((window, 2), (0x10, 2), (2, 4)))
    assert host.ask(p.REQUEST_KIND_WRITE, late) is None
    assert host.device.bus.words[0x10] == 2


def test_a_chained_request_waits_for_the_one_before(host: Host) -> None:
    kind = p.REQUEST_KIND_WRITE | p.FRAME_CHAINED_BIT
    assert host.request(kind, field((1, 2), (1, 2), (1, 4)))[0] == p.REPLY_STATUS_ORDER
    assert host.request(kind, field((0, 2), (0, 2), (1, 4)))[0] == 0
    assert host.request(kind, field((1, 2), (1, 2), (1, 4)))[0] == 0


def test_a_list_stops_at_the_first_error() -> None:
    device = ReferenceDevice(bus=Bus(bad={3: p.REPLY_STATUS_BUS_TIMEOUT}, words={1: 11, 2: 22}))
    host = Host(device).open()
    status, reply = host.request(p.REQUEST_KIND_LIST, field((0, 2), (0, 1), (2, 1), (3, 1), (1, 2)))
    assert (status, reply) == (p.REPLY_STATUS_BUS_TIMEOUT, field((2, 2)))
    status, reply = host.request(p.REQUEST_KIND_LIST, field((1, 2), (0, 1), (2, 1), (2, 1), (1, 2)))
    assert (status, reply) == (0, field((2, 2), (11, 4), (22, 4)))


def test_masked_write_and_add(host: Host) -> None:
    operations = field((0x14, 1), (1, 1), (5, 2), (0xF0, 4), (0xAB, 4)) + field(
        (0x15, 1), (1, 1), (5, 2), (1, 4)
    )
    assert host.request(p.REQUEST_KIND_LIST, field((0, 2), (0, 1)) + operations) == (0, field((2, 2)))
    assert host.device.bus.words[5] == 0xA1


def test_posts_stay_in_order_and_come_once(host: Host) -> None:
    def post(number: int) -> None:
        assert host.ask(p.REQUEST_KIND_POST, field((number, 2), (number, 2), (number, 4))) is None

    for number in (0, 2, 1, 1, 2):
        post(number)
    assert [address for _, address, _ in host.device.bus.log] == [0, 1, 2]
    assert host.request(p.REQUEST_KIND_SYNC, field((0, 2))) == (0, field((3, 2), (0, 2), (0, 2), (0, 1)))


def test_a_request_does_not_overtake_a_lost_post(host: Host) -> None:
    kind = p.REQUEST_KIND_READ | p.FRAME_BARRIER_BIT
    assert host.request(kind, field((0, 2), (1, 2), (0x10, 2)))[0] == p.REPLY_STATUS_BEHIND
    host.ask(p.REQUEST_KIND_POST, field((0, 2), (0x10, 2), (9, 4)))
    assert host.request(kind, field((0, 2), (1, 2), (0x10, 2))) == (0, field((9, 4)))


def test_another_session_begins_empty_and_a_stray_open_does_nothing(host: Host) -> None:
    device = host.device
    stale = Frame(p.REQUEST_KIND_OPEN, field((1, 2), (EPOCH, 2), (0, 1))).encode()
    other = Host(device, 0x2222).open()
    assert device.feed(stale) == b""
    assert other.request(p.REQUEST_KIND_READ, field((0, 2), (1, 2)))[0] == 0
    assert host.ask(p.REQUEST_KIND_WRITE, field((1, 2), (1, 2), (1, 4))) is None
    assert device.counters[p.CONTROL_DISCARDED_CHECK] == 1


def test_without_a_session_closed_is_said_once() -> None:
    host = Host()
    wire = Frame(p.REQUEST_KIND_READ, bytes(4)).encode(EPOCH)
    closed = Frame(p.DEVICE_KIND_CLOSED).encode()
    assert [host.device.feed(wire), host.device.feed(wire)] == [closed, b""]
    host.hello()
    assert host.device.feed(wire) == closed


def test_the_dead_man() -> None:
    device = ReferenceDevice(Settings(safe=((0x10, 0),)), Bus(words={0x10: 5}))
    host = Host(device).open()
    assert (
        host.request(p.REQUEST_KIND_WRITE_CONTROL, field((0, 2), (p.CONTROL_DEADMAN_TICKS, 2), (3, 4)))[0]
        == 0
    )
    device.tick()
    device.tick()
    assert host.request(p.REQUEST_KIND_WRITE, field((1, 2), (0x10, 2), (6, 4)))[0] == 0
    for _ in range(3):
        device.tick()
    assert device.bus.words[0x10] == 0
    assert host.request(p.REQUEST_KIND_WRITE, field((2, 2), (0x10, 2), (6, 4)))[0] == p.REPLY_STATUS_DENIED
    arm = field((3, 2), (p.CONTROL_ARM, 2), (1, 4))
    assert host.request(p.REQUEST_KIND_WRITE_CONTROL, arm)[0] == p.REPLY_STATUS_DENIED
    host = Host(device, 0x3333).open()
    assert host.request(p.REQUEST_KIND_WRITE, field((0, 2), (0x10, 2), (6, 4)))[0] == p.REPLY_STATUS_DENIED
    assert host.request(p.REQUEST_KIND_WRITE_CONTROL, arm)[0] == 0
    assert host.request(p.REQUEST_KIND_WRITE, field((4, 2), (0x10, 2), (6, 4)))[0] == 0


def test_publishes_carry_sequence_and_clock(host: Host) -> None:
    define = field((0, 2), (1, 1), (2, 4), (0, 1), (2, 1), (0x10, 2), (0x11, 2))
    assert host.request(p.REQUEST_KIND_DEFINE_GROUP, define)[0] == 0
    assert host.request(p.REQUEST_KIND_WRITE_CONTROL, field((1, 2), (p.CONTROL_PUBLISH, 2), (1, 4)))[0] == 0
    host.device.clock = 0x1_0000_0005
    published = b"".join(host.device.tick() for _ in range(4))
    frames = [Frame.decode(piece, EPOCH) for piece in Borders().feed(published)]
    words = field((0, 4), (0, 4))
    assert frames == [
        Frame(p.DEVICE_KIND_PUBLISH, field((1, 1), (0, 2), (5, 4)) + words),
        Frame(p.DEVICE_KIND_PUBLISH, field((1, 1), (1, 2), (5, 4)) + words),
    ]


def test_an_exchange_writes_all_and_reads_all(host: Host) -> None:
    host.device.bus.words = {0x20: 0x1234}
    define = field((0, 2), (0, 1), (2, 1), (1, 1), (0x10, 2), (1, 1), (0x11, 2), (2, 1), (0x20, 2), (1, 1))
    assert host.request(p.REQUEST_KIND_DEFINE_EXCHANGE, define)[0] == 0
    status, inputs = host.request(p.REQUEST_KIND_EXCHANGE, field((1, 2), (0, 1), (0xAA, 1), (0xBEEF, 2)))
    assert (status, inputs) == (0, b"\x34")
    assert host.device.bus.words == {0x10: 0xAA, 0x11: 0xBEEF, 0x20: 0x1234}
    assert (
        host.request(p.REQUEST_KIND_EXCHANGE, field((2, 2), (0, 1), (0xAA, 1)))[0] == p.REPLY_STATUS_INVALID
    )


def test_byte_budgets() -> None:
    """Section 8, at 16-bit addresses and 32-bit words."""

    def size(kind: int, payload: int) -> int:
        return len(Frame(kind, bytes(payload)).encode(EPOCH))

    assert size(p.REQUEST_KIND_READ, 4) + size(p.DEVICE_KIND_REPLY, 8) == 24
    assert size(p.REQUEST_KIND_WRITE, 8) + size(p.DEVICE_KIND_REPLY, 4) == 24
    assert size(p.REQUEST_KIND_POST, 8) == 14
    for words in (1, 16, 61, 62, 255):
        payload = bytes([1]) * (7 + 4 * words)
        long = 2 if len(payload) + 1 + -(-len(payload) // 254) > p.FRAME_SHORT_MAX else 0
        assert (
            len(Frame(p.DEVICE_KIND_PUBLISH, payload).encode(EPOCH))
            <= 14 + 4 * words + len(payload) // 254 + long
        )
