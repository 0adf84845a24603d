# SPDX-License-Identifier: BSD-3-Clause
"""The interconnect and the slaves for user logic."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest


@pytest.mark.parametrize("seed", [1, 2])
def test_wishbone_interconnect(ghdl: Any, seed: int) -> None:
    ghdl.run("wishbone_interconnect_tb", seed=seed)


def test_a_broken_address_map_stops_elaboration(ghdl: Any) -> None:
    ghdl.refuse("wishbone_interconnect_tb", "slaves 0 and 1 overlap", broken_map=1)
    ghdl.refuse("wishbone_interconnect_tb", "slave 3 passes the last address", broken_map=2)


@pytest.mark.parametrize(
    ("address_width", "data_width", "wait_clocks_most", "seed"),
    [(8, 32, 0, 1), (8, 32, 6, 2), (30, 12, 3, 3)],
)
def test_axi_lite_master(
    ghdl: Any, address_width: int, data_width: int, wait_clocks_most: int, seed: int
) -> None:
    ghdl.run(
        "axi_lite_master_tb",
        address_width=address_width,
        data_width=data_width,
        wait_clocks_most=wait_clocks_most,
        seed=seed,
    )


def test_an_address_too_wide_for_axi_stops_elaboration(ghdl: Any) -> None:
    ghdl.refuse("axi_lite_master_tb", "an address_width of 31 does not fit", address_width=31)


@pytest.mark.parametrize(("wait_clocks_most", "seed"), [(0, 1), (8, 2)])
def test_core_on_axi_lite(ghdl: Any, wait_clocks_most: int, seed: int) -> None:
    ghdl.run("core_axi_lite_tb", wait_clocks_most=wait_clocks_most, seed=seed)


def test_core_without_a_bus(ghdl: Any) -> None:
    ghdl.run("core_bii_tb")


def test_axi_lite_master_netlist(ghdl: Any, tmp_path: Path) -> None:
    ghdl.run_netlist("axi_lite_master", tmp_path, timeout_clocks=100)


@pytest.mark.parametrize(("stalls", "seed"), [(0, 1), (40, 2), (80, 3)])
def test_axi_lite_slave(ghdl: Any, stalls: int, seed: int) -> None:
    ghdl.run("axi_lite_slave_tb", stalls=stalls, seed=seed)


@pytest.mark.parametrize(("masters", "pauses", "seed"), [(1, 30, 1), (2, 0, 2), (3, 30, 3), (3, 0, 4)])
def test_wishbone_arbiter(ghdl: Any, masters: int, pauses: int, seed: int) -> None:
    ghdl.run("wishbone_arbiter_tb", masters=masters, pauses=pauses, seed=seed)


@pytest.mark.parametrize(
    ("master_period_ps", "slave_period_ps"),
    [(20_000, 16_667), (20_000, 83_000), (50_000, 3_100), (10_000, 10_000)],
)
def test_wishbone_crossing(ghdl: Any, master_period_ps: int, slave_period_ps: int) -> None:
    settings = {"master_period_ps": master_period_ps, "slave_period_ps": slave_period_ps}
    ghdl.run("wishbone_crossing_tb", seed=slave_period_ps, **settings)


@pytest.mark.parametrize(("lines", "seed"), [(1, 1), (5, 2), (30, 3)])
def test_interrupt_slave(ghdl: Any, lines: int, seed: int) -> None:
    ghdl.run("interrupt_slave_tb", lines=lines, seed=seed)


def test_axi_lite_slave_netlist(ghdl: Any, tmp_path: Path) -> None:
    ghdl.run_netlist("axi_lite_slave", tmp_path, timeout_clocks=100, accesses=60)


@pytest.mark.parametrize("data_width", [8, 12, 32])
@pytest.mark.parametrize("snapshot", [False, True])
def test_register_slave(ghdl: Any, data_width: int, snapshot: bool) -> None:
    ghdl.run("register_slave_tb", data_width=data_width, snapshot=snapshot)


@pytest.mark.parametrize("data_width", [8, 16, 32])
@pytest.mark.parametrize("words", [2, 5, 16])
def test_double_buffer_slave(ghdl: Any, data_width: int, words: int) -> None:
    ghdl.run("double_buffer_slave_tb", data_width=data_width, words=words, seed=words)


def test_double_buffer_slave_netlist(ghdl: Any, tmp_path: Path) -> None:
    ghdl.run_netlist("double_buffer_slave", tmp_path, words=16)


@pytest.mark.parametrize("entity", ["wishbone_interconnect", "register_slave", "core_axi_lite"])
def test_synthesis(ghdl: Any, entity: str) -> None:
    assert f"entity {entity} is" in ghdl.synthesise(entity)
