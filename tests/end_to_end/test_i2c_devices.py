# SPDX-License-Identifier: BSD-3-Clause
"""Devices on I²C, on the twin and the compiled VHDL alike: set-up, values, a device that is gone."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator

import pytest

from unitylink import Link
from unitylink.layer4_data import load_spec_objects
from unitylink.simulate import Board
from unitylink.simulate.rtl import RtlBoard
from unitylink.simulate.rtl.board import rtl_configuration
from unitylink.spec import compile_text

TEXT = """
link body (ADDRESS=8);
public body() {
   imu: mpu6050(start=1 ms, period=3 ms);
   encoder: as5600(period=3 ms);
   converter: ads1115(period=3 ms);
   meter: ina219(shunt_ohm=0.01, period=3 ms);
   warmth: tmp102(address=0x49, period=3 ms);
   tilt: lis3dh(period=3 ms);
}
"""

pytestmark = pytest.mark.xdist_group("rtl")


@pytest.fixture(params=[Board, pytest.param(RtlBoard, marks=pytest.mark.long)])
def board(request: pytest.FixtureRequest) -> Iterator[Board]:
    spec = compile_text(TEXT, "body.ul").spec
    assert spec is not None
    configuration = rtl_configuration(spec, clock_hz=8_000_000)
    with request.param(spec, configuration=configuration, endpoint="tcp") as made:
        yield made


@pytest.fixture
def robot(board: Board) -> Iterator[Callable[[str], object]]:
    with Link(f"{board.url}?timeout=20") as link:
        objects = load_spec_objects(board.spec, link)
        yield lambda name: objects[name].read()


def until(true: Callable[[], object]) -> None:
    end = time.monotonic() + 60
    while not true():
        assert time.monotonic() < end
        time.sleep(0.002)


def words(*values: int, order: str = "big") -> bytes:
    return b"".join(value.to_bytes(2, order, signed=True) for value in values)  # type: ignore[arg-type]


def test_a_magnetic_encoder_tells_its_angle_and_its_magnet(board: Board, robot: Callable) -> None:
    encoder = board.components["encoder"].device
    encoder[0x0B:0x0E] = bytes([0x20]) + words(1024)
    until(lambda: robot("encoder.angle") == pytest.approx(math.pi / 2))
    magnet = robot("encoder.magnet")
    assert magnet.detected and not magnet.too_weak and not magnet.too_strong
    encoder[0x0B] = 0x10
    until(lambda: robot("encoder.magnet").too_weak)
    encoder.plugged = False
    until(lambda: not robot("encoder.status").valid)
    assert robot("encoder.status").failure.name == "no_answer"
    assert robot("encoder.angle") == pytest.approx(math.pi / 2)  # the last one
    encoder.plugged = True
    until(lambda: robot("encoder.status").valid)


def test_a_converter_and_a_meter_have_registers_of_two_bytes(board: Board, robot: Callable) -> None:
    converter = board.components["converter"].device_with(register_bytes=2)
    converter[0:2] = words(-8000)
    converter[6] = 0x7F  # its upper limit, as after a reset
    until(lambda: robot("converter.status").valid)
    assert robot("converter.voltage") == pytest.approx(-1.0)
    assert bytes(converter[2:4]) == bytes([0x42, 0xE3])  # the set-up has written it

    meter = board.components["meter"].device_with(register_bytes=2)
    meter[2:6] = words(-500, 24000)
    until(lambda: robot("meter.status").valid)
    assert bytes(meter[0:2]) == bytes([0x39, 0x9F])
    assert robot("meter.current") == pytest.approx(-0.5)  # -5 mV at 10 milliohms
    assert robot("meter.voltage") == pytest.approx(12.0)


def test_temperature_and_acceleration(board: Board, robot: Callable) -> None:
    warmth = board.components["warmth"].device_with(register_bytes=2)
    warmth[0:2] = bytes([0xE7, 0x00])  # of the datasheet
    until(lambda: robot("warmth.temperature") == -25)
    warmth[0:2] = bytes([0x4B, 0x00])
    until(lambda: robot("warmth.temperature") == 75)

    tilt = board.components["tilt"].device
    tilt[0x28 | 0x80 : 0x2E | 0x80] = words(
        16000, -16000, 16, order="little"
    )  # bit 7: the next register follows
    time.sleep(0.05)
    assert not robot("tilt.status").valid  # it does not say who it is
    tilt[0x0F] = 0x33
    until(lambda: robot("tilt.status").valid)
    assert bytes(tilt[0x20:0x24:1]) == bytes([0x57, 0, 0, 0x88])
    assert robot("tilt.acceleration[0]") == pytest.approx(9.80665)
    assert robot("tilt.acceleration[1]") == pytest.approx(-9.80665)


def test_an_inertial_sensor_is_set_up_and_read(board: Board, robot: Callable) -> None:
    imu = board.components["imu"].device
    imu[0x3B:0x49] = words(16384, -16384, 0, -12420, 131, -131, 0)
    imu[0x75] = 0x68
    until(lambda: robot("imu.status").valid)
    assert bytes(imu[0x6B:0x6C]) == b"\x01"
    assert robot("imu.acceleration[0]") == pytest.approx(9.80665)
    assert robot("imu.temperature") == pytest.approx(0, abs=0.01)
    assert robot("imu.turn[1]") == pytest.approx(-1)
