# SPDX-License-Identifier: BSD-3-Clause
"""A board whose device is compiled VHDL does the same for links and plants as the twin."""

from __future__ import annotations

import socket
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from unitylink import _native, connect
from unitylink.errors import BusError, ToolError, UnityLinkError, ValueRangeError
from unitylink.layer2_message import Link
from unitylink.simulate import BoardConfiguration
from unitylink.simulate.rtl import RtlBoard, RtlDesign, RtlModel, build_model, design_of, rtl_configuration
from unitylink.spec import Spec, load

SPEC = """public small() {
   @lamp = 0x00: WRITE(ID="lamp");
   @level = 0x04: signed READ(ID="level", PUBLISH(1,100));
   @echo = 0x05: READ(ID="what the lamp is", PUBLISH(1,100));
   @far = 0x30: READ(ID="far");
}
"""


class Follower:
    """A plant in Python: `level` counts down, `echo` follows the lamp."""

    period_s = 0.001

    def __init__(self) -> None:
        self.times: list[float] = []

    def attach(self, spec: Spec | None, registers: Any) -> None:
        self.registers = registers

    def step(self, time_s: float) -> None:
        self.times.append(time_s)
        self.registers[4] = -len(self.times)
        self.registers[5] = self.registers[0]


@pytest.fixture(scope="module")
def spec(tmp_path_factory: pytest.TempPathFactory) -> Spec:
    file = tmp_path_factory.mktemp("spec") / "small.ul"
    file.write_text(SPEC)
    return load(file)


@pytest.mark.parametrize("endpoint", ["fd", "pty", "tcp", "udp"])
def test_words_go_both_ways(spec: Spec, endpoint: str) -> None:
    plant = Follower()
    with RtlBoard(spec, plant=plant, endpoint=endpoint) as board, Link(f"{board.url}?timeout=10") as link:
        assert link.configuration.address_bytes == 1
        link.write(0, 0xDEADBEEF)
        assert board.registers[0] == 0xDEADBEEF
        while link.read(5) != 0xDEADBEEF:
            pass
        assert link.read(4) > 0x80000000
        board.registers[0x30] = 77
        assert link.read(0x30) == 77
        with pytest.raises(BusError):
            link.read(0x10)
        assert board.error is None
    assert plant.times == [step / 1000 for step in range(len(plant.times))], "steps follow device time"


def test_publishes_are_isochronous_in_device_time(spec: Spec) -> None:
    with RtlBoard(spec, plant=Follower()) as board, Link(f"{board.url}?timeout=10") as link:
        # 100 Hz, a tenth of 1 kHz; the plant counts every millisecond
        subscription = link.subscribe([4, 5], divisor=10)
        levels: list[int] = []
        while len(levels) < 20:
            assert subscription.wait(5.0)
            levels += (-subscription.drain()[1][:, 0].astype("int32")).tolist()
        assert {after - before for before, after in pairwise(levels)} == {10}
        assert subscription.lost == 0


def test_event_publishes(spec: Spec) -> None:
    with RtlBoard(spec, plant=Follower()) as board, Link(f"{board.url}?timeout=10") as link:
        subscription = link.subscribe([0x30], on_event=True)
        for value in (5, 6, 7):
            board.registers[0x30] = value
            board.event(subscription.group)
            assert subscription.wait(5.0)
            assert subscription.drain()[1][:, 0].tolist() == [value]


def test_what_a_plant_may_not_set(spec: Spec) -> None:
    with RtlBoard(spec, plant=Follower()) as board:
        with pytest.raises(ValueRangeError, match="0x0000 cannot be set"):
            board.registers[0] = 1
        with pytest.raises(ValueRangeError, match="nothing is there"):
            _ = board.registers[0x20]
        with pytest.raises(UnityLinkError, match="use `sim:`"):
            board.set_online(False)
        with pytest.raises(UnityLinkError, match="use `sim:`"):
            board.set_node(2, False)


def test_link_url_brings_the_board(spec: Spec, tmp_path: Path) -> None:
    (tmp_path / "small.ul").write_text(SPEC)
    with connect(f"rtl:{tmp_path / 'small.ul'}?plant=ramp&fifo=64&timeout=1") as link:
        assert isinstance(link.board, RtlBoard)
        assert link.board.configuration.clock_hz == 1_000_000
        while link.read(4) < 3:
            pass
        board = link.board
    assert board.closed


def test_slow_line_and_small_fifo_lose_nothing(spec: Spec) -> None:
    """The twin's physical layer stands before the compiled streams: a UART of 100 kBd on a clock of 1 MHz."""
    configuration = rtl_configuration(spec, baud_hz=100_000, fifo=16)
    with (
        RtlBoard(spec, configuration=configuration) as board,
        Link(f"{board.url}?fifo=16&timeout=1&protocol=classic") as link,
    ):
        assert len(link.read_many([4, 5, 0x30] * 5)) == 15
        assert board.statistics.overruns == 0
        board.receive_error(2)
        link.read(4)
        assert board.statistics.datalink_errors == 1


def test_machine_that_is_too_slow_slips_and_still_answers(spec: Spec) -> None:
    model = build_model(design_of(spec, rtl_configuration(spec)))
    with (
        serving(model, replace(rtl_configuration(spec), clock_hz=1_000_000_000)) as board,
        Link(f"{board.url()}?timeout=5") as link,
    ):
        while board.statistics()["time_slipped_s"] == 0.0:
            assert link.read(4) == 0


@contextmanager
def serving(model: RtlModel, configuration: BoardConfiguration) -> Iterator[Any]:
    board = _native.Board(configuration, "fd", "", model)
    board.start()
    try:
        yield board
    finally:
        board.stop()


def test_library_of_another_design(spec: Spec, tmp_path: Path) -> None:
    model = build_model(design_of(spec, rtl_configuration(spec)))
    with (
        pytest.raises(ToolError, match=r"another design \(3 words to read, 1 to write, 4 groups\)"),
        serving(RtlModel(model.library, (1, 2), ()), rtl_configuration(spec)),
    ):
        pass
    (tmp_path / "text.so").write_text("no library")
    with (
        pytest.raises(ToolError, match=r"cannot be loaded: .*text\.so"),
        serving(RtlModel(str(tmp_path / "text.so"), (), ()), rtl_configuration(spec)),
    ):
        pass


ECHO = """library ieee;
  use ieee.std_logic_1164.all;

entity echo is
  port (
    clock, reset, rx_valid, tx_ready : in std_ulogic;
    rx_data : in std_ulogic_vector(7 downto 0);
    rx_error : in std_ulogic_vector(2 downto 0);
    events : in std_ulogic_vector(0 downto 0);
    rx_ready, tx_valid : out std_ulogic;
    tx_data : out std_ulogic_vector(7 downto 0));
end entity;

architecture rtl of echo is
begin
  rx_ready <= tx_ready;
  tx_valid <= rx_valid;
  tx_data  <= rx_data;

  watch : process (clock)
  begin
    if rising_edge(clock) then
      assert rx_valid = '0' or rx_data /= x"21" severity failure;
    end if;
  end process;
end architecture;
"""


def test_failed_assertion_of_the_gateware_stops_it_and_says_where() -> None:
    """The design is the user's own, without any words."""
    model = build_model(RtlDesign("echo", {"echo.vhd": ECHO}))
    with (
        serving(model, BoardConfiguration(clock_hz=1_000_000, groups=1)) as board,
        socket.socket(fileno=int(board.url().removeprefix("fd:"))) as client,
    ):
        client.settimeout(10)
        client.sendall(b"hello")
        received = b""
        while received != b"hello":
            received += client.recv(5)
        assert board.failure() == ""
        client.sendall(b"!")
        while not board.failure():
            pass
        assert board.failure() == f"echo.vhd:{ECHO[: ECHO.index('assert')].count(chr(10)) + 1}"
