# SPDX-License-Identifier: BSD-3-Clause
"""Devices on a bus, on the virtual boards, the twin and the compiled VHDL alike: set-up, units, failures."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator

import pytest

from unitylink import Link
from unitylink.errors import ValueRangeError
from unitylink.layer4_data import load_spec_objects
from unitylink.simulate import Board
from unitylink.simulate.rtl import RtlBoard
from unitylink.spec import compile_text

TEXT = """
link body (ADDRESS=8);
public body() {
   imu: icm42688(rate=100 Hz, start=2 ms);
   other: lsm6dso();
   gauge: spi_device(command=0x90, words=2, bytes=3, order="little", mode=2);
   converter: mcp3008(scale=3.3 V);
   heat: max31855();
   wheel: quadrature_encoder();
}
"""

pytestmark = pytest.mark.xdist_group("rtl")


@pytest.fixture(params=[Board, RtlBoard])
def board(request: pytest.FixtureRequest) -> Iterator[Board]:
    spec = compile_text(TEXT, "body.ul").spec
    assert spec is not None
    with request.param(spec, endpoint="tcp") as made:
        yield made


def until(true: Callable[[], object]) -> None:
    end = time.monotonic() + 60
    while not true():
        assert time.monotonic() < end
        time.sleep(0.002)


def test_an_inertial_sensor_is_set_up_and_read(board: Board) -> None:
    imu = board.components["imu"].device
    with Link(f"{board.url}?timeout=20") as link:
        robot = load_spec_objects(board.spec, link)
        until(lambda: robot["imu.failures"].read() > 3)  # register 75 is not yet 47
        assert not robot["imu.status"].read().valid
        imu[0x1D:0x2B] = b"".join(
            value.to_bytes(2, "big", signed=True) for value in (1325, 2048, -2048, 0, 16384, -16384, 1)
        )
        imu[0x75] = 0x47
        until(lambda: robot["imu.status"].read().valid)
        assert bytes(imu[0x4E:0x51]) == bytes([0x0F, 0x06, 0x06])  # the set-up has written them
        assert robot["imu.temperature"].read() == pytest.approx(35, abs=0.01)
        assert robot["imu.acceleration[0]"].read() == pytest.approx(9.80665)
        assert robot["imu.acceleration[1]"].read() == pytest.approx(-9.80665)
        assert robot["imu.turn[0]"].read() == pytest.approx(1000)
        assert robot["imu.turn[1]"].read() == pytest.approx(-1000)
        assert robot["imu.age"].read() <= 1200
        imu.plugged = False
        until(lambda: not robot["imu.status"].read().valid)
        assert robot["imu.status"].read().failure.name == "wrong_reply"
        assert robot["imu.acceleration[0]"].read() == pytest.approx(9.80665)  # the last good one, and its age
        until(lambda: robot["imu.age"].read() > 5000)
        imu.plugged = True
        until(lambda: robot["imu.status"].read().valid)


def test_another_sensor_has_the_low_byte_first(board: Board) -> None:
    other = board.components["other"].device
    with Link(f"{board.url}?timeout=20") as link:
        robot = load_spec_objects(board.spec, link)
        other[0x22:0x2E] = b"".join(
            value.to_bytes(2, "little", signed=True) for value in (1000, -1000, 0, 2049, -2049, 1)
        )
        other[0x0F] = 0x6C
        until(lambda: robot["other.status"].read().valid)
        assert bytes(other[0x10:0x13]) == bytes([0x84, 0x8C, 0x44])
        assert robot["other.turn[0]"].read() == pytest.approx(70)
        assert robot["other.turn[1]"].read() == pytest.approx(-70)
        assert robot["other.acceleration[0]"].read() == pytest.approx(9.806, abs=0.005)
        other[0x0F] = 0
        until(lambda: not robot["other.status"].read().valid)


def test_values_of_three_bytes_with_the_lowest_first(board: Board) -> None:
    gauge = board.components["gauge"].device
    with Link(f"{board.url}?timeout=20") as link:
        robot = load_spec_objects(board.spec, link)
        gauge[0x10:0x16] = bytes([1, 2, 3, 0xFF, 0xFE, 0xFD])
        until(lambda: robot["gauge.value[1]"].read() == 0xFDFEFF)
        assert robot["gauge.value[0]"].read() == 0x030201
        robot["gauge.control"].write({"enable": False})
        until(lambda: not robot["gauge.status"].read().valid)


def test_converters_without_registers_send_words(board: Board) -> None:
    converter = board.components["converter"].device_with(word_bits=10, numbered=True)
    heat = board.components["heat"].device_with(word_bits=32)
    converter.set_word(8 + 3, 512)
    heat.set_word(0, 0xF060C900)  # of the datasheet
    with Link(f"{board.url}?timeout=20") as link:
        robot = load_spec_objects(board.spec, link)
        until(lambda: robot["converter.level[3]"].read() == pytest.approx(1.65))
        assert robot["converter.level[4]"].read() == 0
        until(lambda: robot["heat.temperature"].read() == -250)
        assert robot["heat.junction"].read() == -55 and not robot["heat.fault"].read().open
        converter.plugged = False
        until(lambda: robot["converter.status"].read().failure.name == "wrong_reply")
        assert robot["converter.level[3]"].read() == pytest.approx(1.65)  # the last good one
    seen = converter.shortest_s
    assert seen["sclk_high"] >= 125e-9 and seen["select_high"] >= 270e-9  # of its datasheet


def test_a_shaft_turns_beside_a_device(board: Board) -> None:
    board.components["imu"].device[0x75] = 0x47
    with Link(f"{board.url}?timeout=20") as link:
        robot = load_spec_objects(board.spec, link)
        board.components["wheel"].turn(101, 0.02)
        until(lambda: robot["imu.status"].read().valid)
        before = robot["imu.stamp"].read()
        until(lambda: robot["imu.stamp"].read() - before > 2_000_000)  # 40 ms of the board
        assert robot["wheel.position"].read() == 101


def test_whether_there_is_a_component_can_be_asked(board: Board) -> None:
    assert "imu" in board.components
    assert "arm" not in board.components and 5 not in board.components


def test_what_a_device_has_not_is_refused(board: Board) -> None:
    gauge = board.components["gauge"].device
    for place, value in ((256, 0), (-1, 0), (0, 256), (0, -1), (slice(0, 2), b"1"), (slice(0, 2), 7)):
        with pytest.raises(ValueRangeError, match="gauge"):
            gauge[place] = value
    with pytest.raises(ValueRangeError, match="0 to 255"):
        gauge[300]
    for number, word in ((16, 0), (-1, 0), (0, 1 << 32), (0, -1)):
        with pytest.raises(ValueRangeError, match="gauge has words 0 to 15"):
            gauge.set_word(number, word)
    with pytest.raises(ValueRangeError, match="word_bits 1 to 32"):
        board.components["imu"].device_with(word_bits=33)
    assert gauge is board.components["gauge"].device
