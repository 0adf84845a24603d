# SPDX-License-Identifier: BSD-3-Clause
"""Rings of TosNet nodes in GHDL: they start, exchange, come through faults, and speak the published wire."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from gateware.tosnet_line import decode_line
from gateware.tosnet_packets import Node, from_master, start_up

# The first nodes of tosnet_bench_pkg, in the order of the line.
IDS = (9, 3, 6, 11, 2, 13, 1)

RINGS: dict[str, dict[str, Any]] = {
    "two_nodes": {"nodes": 2, "error_bits": 5000, "seed": 2},
    "five_nodes": {"nodes": 5, "cycles": 2, "resets": 0},
    "other_registers": {"nodes": 4, "kind": "mixed", "cycles": 3, "resets": 1, "error_bits": 9000, "seed": 3},
    "three_clocks_a_bit": {"nodes": 3, "clocks_per_bit": 3, "cycles": 8, "error_bits": 5000, "seed": 4},
    "a_bit_a_clock": {
        "nodes": 3,
        "clocks_per_bit": 1,
        "samples_per_clock": 4,
        "hop_bits": 62,
        "error_bits": 5000,
        "seed": 5,
    },
    "wide_check": {"nodes": 3, "check_bytes": 2, "error_bits": 3000, "cut": False, "resets": 0, "seed": 8},
    "exact_hops": {"nodes": 4, "exact_hops": True, "cycles": 2, "error_bits": 5000, "resets": 0, "seed": 9},
    "one_may_be_master": {"nodes": 3, "only_first_master": True, "cycles": 5, "seed": 6},
    "two_rings_joined": {
        "nodes": 4,
        "two_rings": True,
        "check_bytes": 2,
        "cut": False,
        "cycles": 3,
        "seed": 7,
    },
}


# In long only: two rings have exact hops and a wide check. Four nodes with other registers do what five do,
# and five keep to the published line below.
LONG = {"wide_check", "exact_hops", "five_nodes"}


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.long if name in LONG else ()) for name in RINGS]
)
def test_a_ring_exchanges_and_comes_through_faults(ghdl: Any, name: str) -> None:
    ghdl.run("tosnet_ring_tb", **{"watchdog_bits": 8000, "cycles": 10, **RINGS[name]})


@pytest.mark.long  # four nodes do the same
def test_fifteen_nodes_keep_the_published_cycle(ghdl: Any) -> None:
    ghdl.run("tosnet_ring_tb", nodes=15, cycles=2, cut=False, resets=0, messages=False)


@pytest.mark.parametrize("refused", ["same_id", "no_master", "too_many"])
def test_a_ring_that_cannot_be_says_why(ghdl: Any, refused: str) -> None:
    ghdl.run("tosnet_ring_tb", nodes=4, watchdog_bits=5000, refused=refused)


def test_a_hop_that_is_too_short_stops_elaboration(ghdl: Any) -> None:
    ghdl.refuse("tosnet_ring_tb", "hop_bits of 40 are too few", hop_bits=40)


def test_a_bit_that_is_too_short_stops_elaboration(ghdl: Any) -> None:
    ghdl.refuse("tosnet_ring_tb", "a bit of 2 samples is too short", clocks_per_bit=2)


@pytest.mark.parametrize(("nodes", "clocks_per_bit"), [(2, 4), (3, 4), (5, 3)])
def test_the_line_is_the_published_one(ghdl: Any, tmp_path: Path, nodes: int, clocks_per_bit: int) -> None:
    """The model of the wire was written without the VHDL. It reads the line of the ring's first node."""
    log = tmp_path / "line.txt"
    ghdl.run(
        "tosnet_ring_tb",
        nodes=nodes,
        clocks_per_bit=clocks_per_bit,
        cycles=3,
        apart_ppm=0,
        cut=False,
        resets=0,
        messages=False,
        log_file=str(log),
    )
    samples = [int(level) for level in log.read_text(encoding="ascii").replace("\n", "")]
    packets = [packet for packet in decode_line(samples, clocks_per_bit) if not packet.broken]
    ring = from_master([Node(number, 0x01) for number in IDS[:nodes]])
    place = [node.id for node in ring].index(IDS[0])
    sent = [packet.body for packet in packets]
    lists = [body for body in sent if body[0] >> 4 in (4, 5, 6, 7)]
    assert lists == [body for body in start_up(ring, place) if body[0] >> 4 in (4, 5, 6, 7)]
    assert {body[0] for body in sent if body[0] >> 4 == 3} == {0x30 | min(IDS[:nodes])}
    data = [body for body in sent if body[0] == 0xA0]
    assert len(data) >= 6
    assert {len(body) for body in data} == {16 + 32 * nodes}


@pytest.mark.parametrize(
    ("slaves", "rounds", "seed"), [(2, 3, 1), pytest.param(4, 1, 2, marks=pytest.mark.long)]
)
def test_the_bridge_shows_the_ring_to_the_bus(ghdl: Any, slaves: int, rounds: int, seed: int) -> None:
    ghdl.run("tosnet_bridge_tb", slaves=slaves, rounds=rounds, seed=seed)


@pytest.mark.parametrize("other_spec", [2, 3])
def test_a_node_of_another_spec_is_refused_by_its_id(ghdl: Any, other_spec: int) -> None:
    ghdl.run("tosnet_bridge_tb", slaves=2, rounds=1, watchdog_bits=3000, other_spec=other_spec)


@pytest.mark.parametrize(
    "options",
    [
        {"rings": 2, "hand_overs": 3},
        pytest.param({"rings": 2}, marks=pytest.mark.long),  # with eight of them
        {"rings": 2, "talkative": True, "hand_overs": 1},
        {"rings": 1, "hand_overs": 0},
    ],
)
def test_no_command_reaches_a_node_of_another_spec_that_has_come(ghdl: Any, options: dict[str, Any]) -> None:
    ghdl.run("tosnet_spec_tb", **options)


# The watchdog of the first one stops a ring between the strobes of the two: who sees each sees one too many.
@pytest.mark.parametrize(
    "generics",
    [
        {"rounds": 5, "check_bytes": 1, "watchdog_bits": 2198, "seed": 1},
        # two rings that are joined have the wide check, too
        pytest.param(
            {"rounds": 1, "check_bytes": 2, "watchdog_bits": 3000, "seed": 2}, marks=pytest.mark.long
        ),
    ],
)
def test_a_cut_of_one_of_two_rings_costs_no_cycle(ghdl: Any, generics: dict[str, Any]) -> None:
    ghdl.run("tosnet_bridge_tb", slaves=2, rings=2, **generics)


@pytest.mark.parametrize(
    ("generics", "why"),
    [
        ({"rings": 2, "exact": False}, "two rings need exact_hops"),
        ({"watchdog_bits": 2197}, "at least 2198 are needed"),
    ],
)
def test_a_ring_that_cannot_run_is_refused(ghdl: Any, generics: dict[str, Any], why: str) -> None:
    ghdl.refuse("tosnet_bridge_tb", why, **generics)
