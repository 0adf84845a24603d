# SPDX-License-Identifier: BSD-3-Clause
"""The UART: every parity, from the fewest clocks for a bit to many, with whole and broken ratios."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

PARITIES = ["none", "even", "odd"]


@pytest.mark.parametrize("parity", PARITIES)
@pytest.mark.parametrize(
    ("clock_hz", "baud_hz"),
    [(8_000_000, 1_000_000), (50_000_000, 6_000_000), (50_000_000, 3_000_000)],
    ids=["8 clocks a bit", "8.3", "16.7"],
)
def test_uart_rx(ghdl: Any, parity: str, clock_hz: int, baud_hz: int) -> None:
    ghdl.run("uart_rx_tb", parity=parity, clock_hz=clock_hz, baud_hz=baud_hz, bytes=40)


@pytest.mark.parametrize(
    "parity",
    [pytest.param(parity, marks=() if parity == "even" else pytest.mark.long) for parity in PARITIES],
)
def test_uart_rx_on_a_slow_line(ghdl: Any, parity: str) -> None:
    """With 104.2 clocks for a bit the counters are longer.

    The tests of faster lines go through the states of each parity.
    """
    ghdl.run("uart_rx_tb", parity=parity, clock_hz=1_000_000, baud_hz=9_600, bytes=8)


@pytest.mark.parametrize("seed", [2, 3, 4])
def test_uart_rx_with_other_data(ghdl: Any, seed: int) -> None:
    ghdl.run("uart_rx_tb", parity="even", clock_hz=8_300_000, baud_hz=1_000_000, seed=seed)


@pytest.mark.parametrize("parity", PARITIES)
@pytest.mark.parametrize("stop_bits", [1, 2])
@pytest.mark.parametrize(("clock_hz", "baud_hz"), [(12_300_000, 3_000_000), (50_000_000, 3_000_000)])
def test_uart_tx(ghdl: Any, parity: str, stop_bits: int, clock_hz: int, baud_hz: int) -> None:
    ghdl.run("uart_tx_tb", parity=parity, stop_bits=stop_bits, clock_hz=clock_hz, baud_hz=baud_hz)


@pytest.mark.parametrize("parity", PARITIES)
@pytest.mark.parametrize("baud_hz", [pytest.param(1_000_000, marks=pytest.mark.long), 3_000_000])
def test_uart_both_ways_and_errors_in_their_place(ghdl: Any, parity: str, baud_hz: int) -> None:
    ghdl.run("uart_tb", parity=parity, baud_hz=baud_hz, bytes=60 if baud_hz == 1_000_000 else 200)


@pytest.mark.parametrize("depth", [2, 16])
def test_receive_buffer(ghdl: Any, depth: int) -> None:
    ghdl.run("receive_buffer_tb", depth=depth, seed=depth)


@pytest.mark.parametrize(
    ("clock_hz", "sck_hz"),
    [(25_000_000, 25_000_000), (50_000_000, 25_000_000), (100_000_000, 25_000_000), (12_000_000, 1_000_000)],
)
def test_spi_slave(ghdl: Any, clock_hz: int, sck_hz: int) -> None:
    size = 1500 if sck_hz > 1_000_000 else 300
    ghdl.run("spi_slave_tb", clock_hz=clock_hz, sck_hz=sck_hz, bytes=size, seed=clock_hz // 1_000_000)


def test_spi_slave_netlist(ghdl: Any, tmp_path: Path) -> None:
    ghdl.run_netlist("spi_slave", tmp_path, bytes=300)


@pytest.mark.parametrize(
    ("clock_hz", "baud_hz", "rounds"),
    [
        pytest.param(50_000_000, 3_000_000, 5, marks=pytest.mark.long),
        (1_000_000, 125_000, 6),
    ],
)
def test_rs485(ghdl: Any, clock_hz: int, baud_hz: int, rounds: int) -> None:
    ghdl.run("rs485_tb", clock_hz=clock_hz, baud_hz=baud_hz, rounds=rounds, seed=rounds)


@pytest.mark.parametrize("seed", [1, 2])
def test_rs485_node(ghdl: Any, seed: int) -> None:
    ghdl.run("rs485_node_tb", seed=seed)


@pytest.mark.long  # its parts are those of the UART, whose netlists are compared below
def test_rs485_netlist(ghdl: Any, tmp_path: Path) -> None:
    ghdl.run_netlist("rs485", tmp_path, clock_hz=50_000_000, baud_hz=3_000_000, rounds=2)


def test_rates(ghdl: Any) -> None:
    ghdl.run("rate_pkg_tb")


def test_a_clock_too_slow_for_the_baud_rate_stops_elaboration(ghdl: Any) -> None:
    ghdl.refuse("uart_rx_tb", "uart_rx: a bit needs 8 clocks or more", clock_hz=7_000_000, baud_hz=1_000_000)
    ghdl.refuse("uart_tx_tb", "uart_tx: a bit needs 4 clocks or more", clock_hz=3_000_000, baud_hz=1_000_000)


@pytest.mark.parametrize("entity", ["uart_rx", "uart_tx"])
def test_netlist(ghdl: Any, tmp_path: Path, entity: str) -> None:
    ghdl.run_netlist(entity, tmp_path, bytes=20)


def test_synthesis(ghdl: Any) -> None:
    assert "entity uart is" in ghdl.synthesise("uart")
