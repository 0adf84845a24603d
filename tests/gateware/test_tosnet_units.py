# SPDX-License-Identifier: BSD-3-Clause
"""The parts of a TosNet node, each in a bench of its own."""

from __future__ import annotations

from typing import Any

import pytest


@pytest.mark.parametrize(
    ("clocks_per_bit", "samples_per_clock", "apart_ppm"),
    [(4, 1, 0), (4, 1, 10_000), (4, 1, -10_000), (3, 1, 200), (8, 1, -500), (1, 4, 1000), (2, 2, -3000)],
)
def test_line(ghdl: Any, clocks_per_bit: int, samples_per_clock: int, apart_ppm: int) -> None:
    ghdl.run(
        "tosnet_line_tb",
        clocks_per_bit=clocks_per_bit,
        samples_per_clock=samples_per_clock,
        apart_ppm=apart_ppm,
        seed=clocks_per_bit,
    )


def test_a_bit_that_is_too_short_stops_elaboration(ghdl: Any) -> None:
    ghdl.refuse("tosnet_line_tb", "a bit of 2 samples is too short; three are needed", clocks_per_bit=2)


@pytest.mark.parametrize(
    "generics",
    [
        {"symbol_clocks": 10},
        {"symbol_clocks": 10, "check_bytes": 2, "seed": 2},
        {"symbol_clocks": 40, "packets": 40, "exact_start": True, "seed": 3},
        {"symbol_clocks": 10, "packets": 60, "check_bytes": 2, "exact_start": True, "seed": 4},
    ],
)
def test_packets(ghdl: Any, generics: dict[str, Any]) -> None:
    ghdl.run("tosnet_packet_tb", **generics)


@pytest.mark.parametrize(("rings", "is_master"), [(1, False), (1, True), (2, False), (2, True)])
def test_words(ghdl: Any, rings: int, is_master: bool) -> None:
    ghdl.run("tosnet_words_tb", rings=rings, is_master=is_master, seed=rings)


@pytest.mark.parametrize(("clocks_per_bit", "apart_ppm"), [(4, 300), (4, -300), (1, 0)])
def test_clock(ghdl: Any, clocks_per_bit: int, apart_ppm: int) -> None:
    ghdl.run("tosnet_clock_tb", clocks_per_bit=clocks_per_bit, apart_ppm=apart_ppm)


@pytest.mark.parametrize(("step_clocks", "seed"), [(10, 1), (3, 2)])
def test_walk(ghdl: Any, step_clocks: int, seed: int) -> None:
    ghdl.run("tosnet_walk_tb", step_clocks=step_clocks, seed=seed)


@pytest.mark.parametrize("may_be_master", [True, False])
@pytest.mark.parametrize("symbol_clocks", [10, 40])
def test_start(ghdl: Any, may_be_master: bool, symbol_clocks: int) -> None:
    ghdl.run("tosnet_start_tb", may_be_master=may_be_master, symbol_clocks=symbol_clocks)


@pytest.mark.parametrize(
    ("master", "may_be_master", "word_clocks", "seed"),
    [(False, True, 1, 1), (False, False, 2, 2), (True, True, 1, 3), (True, True, 2, 4)],
)
def test_exchange(ghdl: Any, master: bool, may_be_master: bool, word_clocks: int, seed: int) -> None:
    ghdl.run(
        "tosnet_exchange_tb",
        master=master,
        may_be_master=may_be_master,
        word_clocks=word_clocks,
        tells=seed != 2,
        seed=seed,
    )


@pytest.mark.parametrize(("hop_clocks", "pause_clocks"), [(30, 12), (40, 40), (17, 1)])
def test_timing(ghdl: Any, hop_clocks: int, pause_clocks: int) -> None:
    ghdl.run("tosnet_timing_tb", hop_clocks=hop_clocks, pause_clocks=pause_clocks)


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_mailbox(ghdl: Any, seed: int) -> None:
    ghdl.run("tosnet_mailbox_tb", seed=seed)


@pytest.mark.parametrize("clocks_per_bit", [3, 4])
def test_node(ghdl: Any, clocks_per_bit: int) -> None:
    ghdl.run("tosnet_node_tb", clocks_per_bit=clocks_per_bit)


def test_a_hop_that_is_too_short_stops_elaboration(ghdl: Any) -> None:
    ghdl.refuse("tosnet_node_tb", "hop_bits of 40 are too few; at least 51 are needed", hop_bits=40)


def test_carrier(ghdl: Any) -> None:
    ghdl.run("tosnet_carrier_tb")
