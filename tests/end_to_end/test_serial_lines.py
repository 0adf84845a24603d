# SPDX-License-Identifier: BSD-3-Clause
"""Bytes go out and come in over a serial line of the gateware, on the twin and on the compiled VHDL alike."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator

import pytest

from unitylink import Link
from unitylink.errors import UnityLinkError, ValueRangeError
from unitylink.layer4_data import load_spec_objects
from unitylink.simulate import Board
from unitylink.simulate.rtl import RtlBoard
from unitylink.simulate.rtl.board import rtl_configuration
from unitylink.spec import compile_text

TEXT = """
link rover (ADDRESS=8);
public rover() {
   gnss: uart_bridge(baud_hz=115200, depth=16);
   motors: uart_bridge(baud_hz=57600, parity=1, half_duplex=1, hold=20 us, depth=4);
   other: gpio(pins=1);
}
"""

pytestmark = pytest.mark.xdist_group("rtl")


@pytest.fixture(params=[Board, pytest.param(RtlBoard, marks=pytest.mark.long)])
def board(request: pytest.FixtureRequest) -> Iterator[Board]:
    spec = compile_text(TEXT, "rover.ul").spec
    assert spec is not None
    configuration = rtl_configuration(spec, clock_hz=2_000_000)
    with request.param(spec, configuration=configuration, endpoint="tcp") as made:
        yield made


def until(true: Callable[[], object]) -> None:
    end = time.monotonic() + 20
    while not true():
        assert time.monotonic() < end
        time.sleep(0.002)


def test_bytes_come_and_go(board: Board) -> None:
    receiver = board.components["gnss"].serial()
    with Link(board.url) as link:
        robot = load_spec_objects(board.spec, link)
        came: list[int] = []
        robot["gnss.received"].on_publish(lambda _time, item: came.append(item.byte) if item.valid else None)
        receiver.send(b"$GNGGA,123519.00")
        until(lambda: bytes(came) == b"$GNGGA,123519.00")
        robot.stop_publishing()
        for byte in b"\xb5\x62":
            robot["gnss.send"].pulse(byte)
        heard = bytearray()
        until(lambda: heard.extend(receiver.take()) or heard == b"\xb5\x62")

        robot["gnss.baud"].write("baud_9600")
        receiver.baud_hz = 9600.0
        robot["gnss.send"].pulse(0x55)
        until(lambda: heard.extend(receiver.take()) or heard == b"\xb5\x62\x55")
        assert receiver.broken == 0
        receiver.send(b"\x0f")
        until(lambda: robot["gnss.received"].read().byte == 0x0F)


def test_what_is_lost_is_counted_and_a_full_queue_refuses(board: Board) -> None:
    drives = board.components["motors"].serial()
    with Link(board.url) as link:
        robot = load_spec_objects(board.spec, link)
        drives.send(bytes(range(7)))
        until(lambda: robot["motors.state"].read().lost == 2)
        for number in range(5):  # the queue has a byte more at its end
            item = robot["motors.received"].read()
            assert (item.valid, item.byte) == (True, number)
        assert not robot["motors.received"].read().valid
        drives.send(b"\x7f")
        until(lambda: robot["motors.room"].read() == 4)
        item = robot["motors.received"].read
        found: list[tuple[int, bool]] = []
        until(lambda: found.extend((one.byte, one.gap) for one in [item()] if one.valid) or found)
        assert found == [(0x7F, True)]

        robot["motors.baud"].write("baud_4800")
        with pytest.raises(UnityLinkError):
            for _ in range(200):
                robot["motors.send"].pulse(0xAA)
        drives.baud_hz = 4800.0
        assert robot["motors.state"].read().sending
        until(lambda: not robot["motors.state"].read().sending)
        sent = drives.take()
        assert len(sent) >= 4 and set(sent) == {0xAA}
        assert not robot["motors.received"].read().valid  # it does not hear itself
        assert board.components["motors"].level("tx_enable") is False


def test_a_line_that_is_none_is_refused(board: Board) -> None:
    with pytest.raises(ValueRangeError, match="has no input 'rx'; there are pin_in"):
        board.components["other"].serial()
    assert board.components["gnss"].serial() is board.components["gnss"].serial()
