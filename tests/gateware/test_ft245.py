# SPDX-License-Identifier: BSD-3-Clause
"""FT245 physical layers against models of the chip that check its timing."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

CHIP_BYTES_A_SECOND = 8_000_000  # what both chips move in asynchronous mode
CLOCKS = [4_000_000, 12_000_000, 50_000_000, 60_000_000, 66_000_000, 100_000_000]


@pytest.mark.parametrize("slowest", [False, True])
@pytest.mark.parametrize("clock_hz", CLOCKS)
def test_async_timing(ghdl: Any, clock_hz: int, slowest: bool) -> None:
    ghdl.run("ft245_async_tb", clock_hz=clock_hz, slowest=slowest, bytes=700, seed=clock_hz // 1_000_000)


@pytest.mark.parametrize("slowest", [False, True])
def test_async_sustains_what_the_chip_can(ghdl: Any, slowest: bool) -> None:
    ghdl.run("ft245_async_tb", rate_hz_least=CHIP_BYTES_A_SECOND, slowest=slowest, bytes=10)


@pytest.mark.parametrize("mode", ["never", "publishes", "replies", "both"])
@pytest.mark.parametrize("seed", [2, 3])
def test_async_send_immediate_while_everybody_stalls(ghdl: Any, mode: str, seed: int) -> None:
    ghdl.run(
        "ft245_async_tb", send_immediate=mode, busy_percent=20, stall_percent=50, slowest=False, seed=seed
    )


def test_async_netlist(ghdl: Any, tmp_path: Path) -> None:
    ghdl.run_netlist("ft245_async", tmp_path, bytes=300)
