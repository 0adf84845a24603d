# SPDX-License-Identifier: BSD-3-Clause
"""A TosNet ring always finds itself, with one master: shown on a model that answers as the VHDL does."""

from __future__ import annotations

import random
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from gateware.tosnet_election import Node, Packet, Phase, Ring, explored, received

from gateware import tosnet_election


def one_master(ring: Ring) -> None:
    masters = [node.id for node in ring.nodes if node.phase is Phase.RUNNING and node.master]
    assert len(masters) <= 1, f"two masters run: {ring}"


@pytest.mark.parametrize("ids", [(2, 1), (1, 3, 2), (3, 1, 2), (2, 4, 1, 3), (2, 5, 1, 3, 4)])
def test_a_ring_without_faults_always_finds_itself(ids: tuple[int, ...]) -> None:
    rings, stuck = explored(Ring.of(ids), faults=False, bound=100_000, look=one_master)
    assert len(rings) < 100_000, "not all was seen"
    assert not stuck
    assert any(ring.complete for ring in rings)


def test_resets_and_damage_in_any_order_end_in_a_ring() -> None:
    """All that two nodes can do, whatever is reset, damaged or dropped, and how often."""
    rings, stuck = explored(Ring.of((2, 1)), faults=True, bound=100_000, look=one_master)
    assert 500 < len(rings) < 100_000
    assert not stuck


@pytest.mark.long
def test_three_nodes_with_faults_in_any_order_end_in_a_ring() -> None:
    rings, stuck = explored(Ring.of((3, 1, 2)), faults=True, bound=1_000_000, look=one_master)
    assert 50_000 < len(rings) < 1_000_000
    assert not stuck


@pytest.mark.parametrize("seed", range(4))
def test_five_nodes_find_themselves_after_faults(seed: int) -> None:
    """Wherever random faults have brought a ring of five, each way on from there ends in a ring."""
    draw = random.Random(seed)
    ring = Ring.of((2, 5, 1, 3, 4))
    for _ in range(draw.randrange(20, 300)):
        ring = draw.choice(list(ring.steps(faults=True)))
        one_master(ring)
    rings, stuck = explored(ring, faults=False, bound=100_000, look=one_master)
    assert len(rings) < 100_000, "not all was seen"
    assert not stuck


@pytest.mark.parametrize("mistake", ["never claims", "keeps its list", "claims twice"])
def test_a_mistake_of_a_node_is_seen(monkeypatch: pytest.MonkeyPatch, mistake: str) -> None:
    def wrong(node: Node, packet: Packet, *, ghost: bool = False) -> tuple[Node, tuple[Packet, ...]]:
        if mistake == "never claims":
            node = replace(node, may_be_master=False)
        after, sent = received(node, packet, ghost=ghost)
        if mistake == "keeps its list" and packet.data[0] >> 4 == tosnet_election.NET_SET:
            after = replace(after, members=node.members)
        if mistake == "claims twice" and node.phase is Phase.COUNTING:
            after = replace(after, phase=Phase.RUNNING, master=True)
        return after, sent

    monkeypatch.setattr(tosnet_election, "received", wrong)
    try:
        _, stuck = explored(Ring.of((3, 1, 2)), faults=False, bound=100_000, look=one_master)
    except AssertionError:
        return
    assert stuck


def hexadecimal(packets: tuple[Packet, ...]) -> str:
    return "".join(bytes(one.data).hex().upper() + (".!"[not one.good]) for one in packets)


def random_packet(draw: random.Random, node: Node) -> Packet:
    """Return a packet that may come: most fit the node's phase, and some are wrong in any way."""
    command = draw.choice([2, 3, 2 * max(node.phase, 1), 2 * max(node.phase, 1) + 1, draw.randrange(2, 8)])
    ids = draw.sample([1, 3, 4, 7, 9, 12], draw.randrange(1, 6))
    if command in {2, 3}:
        return Packet((command << 4 | draw.choice([7, 7, *ids]),), draw.random() < 0.9)
    if command in {4, 5}:
        if command == 5 and draw.random() < 0.8:
            ids = [number for number in ids if number != 7]
            ids.insert(min(node.own_address, len(ids)), 7)
        payload = [place << 4 | number for place, number in enumerate(ids)]
        count = len(ids) if draw.random() < 0.9 else draw.randrange(16)
    else:
        payload = [mask for mask in draw.sample(range(256), max(node.nodes, 1)) for _ in (0, 1)]
        count = 0
    if draw.random() < 0.1:
        payload[draw.randrange(len(payload))] = draw.randrange(256)
    if draw.random() < 0.1:
        payload = payload[:-1]
    return Packet((command << 4 | count, *payload), draw.random() < 0.9)


@pytest.mark.parametrize(("may_be_master", "seed"), [(True, 1), (True, 2), (False, 3)])
def test_the_model_answers_as_the_vhdl(ghdl: Any, tmp_path: Path, may_be_master: bool, seed: int) -> None:
    draw = random.Random(seed)
    node = Node(7, 0x83, may_be_master=may_be_master)
    foreign, lines = 0, []
    seen: set[Phase] = set()
    for _ in range(1500):
        packet = random_packet(draw, node)
        is_foreign = packet.good and packet.data[0] >> 4 == 2 and packet.data[0] & 0xF < node.id
        foreign += is_foreign
        node, sent = received(node, packet, ghost=is_foreign and foreign % 32 == 0)
        seen.add(node.phase)
        state = f"{node.phase is Phase.RUNNING:d}{node.master:d}"
        digits = bytes(packet.data).hex().upper()
        lines.append(f"{digits} {'.!'[not packet.good]} ={hexadecimal(sent)} {state}")
    assert len(seen) == 4, "the packets do not reach all phases"
    script = tmp_path / "script.txt"
    script.write_text("\n".join(lines) + "\n", encoding="ascii")
    ghdl.run(
        "tosnet_start_tb", may_be_master=may_be_master, election_clocks=4_000_000, script_file=str(script)
    )
