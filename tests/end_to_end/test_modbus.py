# SPDX-License-Identifier: BSD-3-Clause
"""A frequency converter on Modbus is read and told what to do, on the twin and on the compiled VHDL alike."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from unitylink import Link
from unitylink.layer4_data import load_spec_objects
from unitylink.simulate import Board
from unitylink.simulate.modbus_device import ModbusDevice
from unitylink.simulate.rtl import RtlBoard
from unitylink.simulate.rtl.board import rtl_configuration
from unitylink.spec import compile_text

EXAMPLE = Path(__file__).resolve().parents[2] / "components/modbus_master/example.ul"

pytestmark = pytest.mark.xdist_group("rtl")


@pytest.fixture(params=[Board, pytest.param(RtlBoard, marks=pytest.mark.long)])
def board(request: pytest.FixtureRequest) -> Iterator[Board]:
    spec = compile_text(EXAMPLE.read_text(encoding="utf-8"), "well.ul").spec
    assert spec is not None
    configuration = rtl_configuration(spec, clock_hz=2_000_000)
    with request.param(spec, configuration=configuration, endpoint="tcp") as made:
        yield made


def until(device: ModbusDevice, true: Callable[[], object]) -> None:
    end = time.monotonic() + 60
    while not true():
        assert time.monotonic() < end
        device.answer()
        time.sleep(0.002)


def test_a_converter_is_read_and_written(board: Board) -> None:
    device = board.components["pump"].modbus(unit=1)
    device[0x0300] = 0
    for register, value in ((0x2100, 0), (0x2101, 3512), (0x2102, 27), (0x2000, 7), (0x2001, 7)):
        device[register] = value
    with Link(board.url) as link:
        robot = load_spec_objects(board.spec, link)
        status = robot["pump.status"].read
        until(device, lambda: status() & 1)
        assert device[0x0300] == 1  # the set-up
        assert robot["pump.frequency"].read() == pytest.approx(35.12)
        assert robot["pump.current"].read() == pytest.approx(2.7)
        assert (device[0x2000], device[0x2001]) == (7, 7)  # nobody has said anything yet

        robot["pump.command"].write(1)
        robot["pump.speed"].write(40.0)
        until(device, lambda: (device[0x2000], device[0x2001]) == (1, 4000))

        device.plugged = False
        until(device, lambda: not status() & 1)
        assert status() >> 4 & 3 == 1  # no answer
        assert robot["pump.frequency"].read() == pytest.approx(35.12)
        assert robot["pump.age"].read() > 100_000
        device.plugged = True
        device[0x2001] = 0
        until(device, lambda: status() & 1 and device[0x2001] == 4000)  # it is told again


def test_a_register_that_does_not_exist_is_refused(board: Board) -> None:
    device = board.components["pump"].modbus(unit=1)
    device[0x0300] = 0
    with Link(board.url) as link:
        robot = load_spec_objects(board.spec, link)
        until(device, lambda: robot["pump.status"].read() >> 4 & 3 == 3)
        assert robot["pump.status"].read() >> 6 == 2
        assert not robot["pump.status"].read() & 1
