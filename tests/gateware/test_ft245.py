# SPDX-License-Identifier: BSD-3-Clause
"""FT245 physical layers against models of the chip that check its timing.

Also the parts of which they are made.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

CHIP_BYTES_A_SECOND = 8_000_000  # bytes a second that both chips move in asynchronous mode
SYNC_BYTES_A_SECOND = 57_000_000  # 95 % of one byte in each clock
CLOCKS = [4_000_000, 12_000_000, 50_000_000, 60_000_000, 66_000_000, 100_000_000]


@pytest.mark.parametrize("slowest", [False, True])
@pytest.mark.parametrize("flag_flops", [1, 2])
@pytest.mark.parametrize("clock_hz", CLOCKS)
def test_async_timing(ghdl: Any, clock_hz: int, flag_flops: int, slowest: bool) -> None:
    seed = clock_hz // 1_000_000
    ghdl.run("ft245_tb", clock_hz=clock_hz, flag_flops=flag_flops, slowest=slowest, bytes=700, seed=seed)


@pytest.mark.parametrize("slowest", [False, True])
@pytest.mark.parametrize(
    ("clock_hz", "flag_flops", "least"),
    [
        (50_000_000, 1, CHIP_BYTES_A_SECOND),
        (50_000_000, 2, 6_200_000),
        (100_000_000, 2, CHIP_BYTES_A_SECOND),
    ],
)
def test_async_sustains_its_rate(
    ghdl: Any, clock_hz: int, flag_flops: int, least: int, slowest: bool
) -> None:
    settings = {"clock_hz": clock_hz, "flag_flops": flag_flops, "rate_hz_least": least}
    ghdl.run("ft245_tb", slowest=slowest, bytes=10, **settings)


@pytest.mark.parametrize("mode", ["never", "publishes", "replies", "both"])
@pytest.mark.parametrize("seed", [2, 3])
def test_async_send_immediate_while_everybody_stalls(ghdl: Any, mode: str, seed: int) -> None:
    ghdl.run("ft245_tb", send_immediate=mode, busy_percent=20, stall_percent=50, slowest=False, seed=seed)


def test_async_netlist(ghdl: Any, tmp_path: Path) -> None:
    ghdl.run_netlist("ft245_async", tmp_path, "ft245_tb", bytes=300)


@pytest.mark.parametrize("busy_percent", [0, 5])
@pytest.mark.parametrize("clock_hz", [12_000_000, 50_000_000, 59_900_000, 80_000_000, 133_000_000])
def test_sync_timing(ghdl: Any, clock_hz: int, busy_percent: int) -> None:
    seed = clock_hz // 1_000_000
    ghdl.run("ft245_tb", synchronous=True, clock_hz=clock_hz, busy_percent=busy_percent, seed=seed)


def test_sync_sustains_a_byte_a_clock(ghdl: Any) -> None:
    ghdl.run("ft245_tb", synchronous=True, clock_hz=80_000_000, rate_hz_least=SYNC_BYTES_A_SECOND, bytes=10)


@pytest.mark.parametrize("mode", ["never", "publishes", "replies", "both"])
def test_sync_send_immediate(ghdl: Any, mode: str) -> None:
    ghdl.run("ft245_tb", synchronous=True, send_immediate=mode, busy_percent=10, stall_percent=50, seed=5)


def test_sync_netlist(ghdl: Any, tmp_path: Path) -> None:
    ghdl.run_netlist("ft245_sync", tmp_path, "ft245_tb", synchronous=True, bytes=300)


@pytest.mark.parametrize("clock_hz", CLOCKS)
def test_siwu_pulse(ghdl: Any, clock_hz: int) -> None:
    ghdl.run("siwu_pulse_tb", clock_hz=clock_hz, seed=clock_hz // 1_000_000)


@pytest.mark.parametrize(
    ("depth", "margin", "write_period_ps", "read_period_ps"),
    [
        (4, 0, 50_000, 16_667),
        (8, 2, 16_667, 3_100),
        (16, 0, 16_667, 20_000),
        (16, 2, 20_000, 20_001),
        (64, 3, 16_667, 83_000),
        (256, 0, 10_000, 10_000),
    ],
)
def test_async_fifo(ghdl: Any, depth: int, margin: int, write_period_ps: int, read_period_ps: int) -> None:
    ghdl.run(
        "async_fifo_tb",
        depth=depth,
        margin=margin,
        write_period_ps=write_period_ps,
        read_period_ps=read_period_ps,
        seed=depth,
    )


def test_async_fifo_refuses_a_depth_that_is_not_a_power_of_two(ghdl: Any) -> None:
    ghdl.refuse("async_fifo_tb", "async_fifo: depth must be a power of two", depth=12)


def test_async_fifo_netlist(ghdl: Any, tmp_path: Path) -> None:
    ghdl.run_netlist("async_fifo", tmp_path)
