# SPDX-License-Identifier: BSD-3-Clause
"""The twin promises nothing that the gateware of the same spec lacks: limits, publishes, exchanges.

Every design is compiled, which takes a while. So there are only two here. With UNITYLINK_PARITY=20 in the
environment, twenty more are drawn at random.
"""

from __future__ import annotations

import os
import random
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import pytest

from unitylink import Link
from unitylink.errors import DeviceMismatch
from unitylink.interface.board_configuration import BoardConfiguration
from unitylink.layer4_data import load_spec_objects
from unitylink.simulate import Board
from unitylink.simulate.rtl import RtlBoard, rtl_configuration
from unitylink.spec import Spec, compile_text, load

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
EXCHANGES = 1000
MORE = int(os.environ.get("UNITYLINK_PARITY", "0"))
TIMEOUT = "timeout=20"  # long enough for a busy machine


SIDES = (
    "@flags = {0:#x}: u8 W1C();",
    "@state = {1:#x}: u8 READ();",
    "@start = {1:#x}: u8 PULSE();",
    "@stop = {2:#x}: u8 PULSE();",
    "@level = {2:#x}: u8 READ();",
)


class Still:
    """A plant in which nothing moves. The test sets the registers on the board's side."""

    period_s = 1.0

    def attach(self, spec: Spec | None, registers: Any) -> None:
        pass

    def step(self, time_s: float) -> None:
        pass


@dataclass
class Drawn:
    """A spec and settings. `of` draws them from a seed."""

    spec: Spec
    settings: dict[str, Any] = field(default_factory=dict)

    @classmethod
    def of(cls, seed: int) -> Drawn:
        """Draw words and settings.

        The words have several rates, and one rate has more words than a publish carries.
        """
        draw = random.Random(seed)
        step = draw.choice((1, 1, 5))
        lines, address = [], draw.choice((0, 0x40))
        for number in range(draw.randrange(66, 80)):
            lines.append(f"@fast{number} = {address:#x}: READ(PUBLISH(1,4));")
            address += 1 if number % 10 else step
        for number in range(draw.randrange(1, 20)):
            publish = f"PUBLISH(1,{draw.choice((10, 20, 50))})" if draw.random() < 0.5 else ""
            width = draw.choice(("u8", "i16", "u32", "f32"))
            lines.append(f"@slow{number} = {address:#x}: {width} READ({publish});")
            address += step
        for number in range(draw.randrange(1, 30)):
            width = draw.choice(("u8", "i16", "u32"))
            lines.append(f"@out{number} = {address:#x}: {width} WRITE();")
            address += step
        for line in SIDES:  # a word with a READ and a WRITE, which stand in either order in the text
            lines.append(line.format(address, address + 1, address + 2))
        text = "link plain;\npublic drawn() {\n   " + "\n   ".join(lines) + "\n}\n"
        spec = compile_text(text.encode(), "drawn.ul").spec
        assert spec is not None, text
        settings = {
            "exchanges": draw.randrange(1, 5),
            "base_hz": draw.choice((200, 1000)),
            "read_many": draw.choice((16, 255)),
            "window": draw.choice((8, 64)),
            "rate_bytes": draw.choice((1, 2)),
        }
        return cls(spec, {name: value for name, value in settings.items() if draw.random() < 0.7})


DRAWN = [
    pytest.param(Drawn(load(EXAMPLES / "walker18" / "walker18.ul")), 36, id="walker18"),
    *(pytest.param(Drawn.of(seed), None, id=f"seed{seed}") for seed in range(1 + MORE)),
]


@contextmanager
def both(drawn: Drawn) -> Iterator[tuple[tuple[Board, Link], tuple[Board, Link]]]:
    """Yield the same board as twin and as compiled gateware, each with a link."""
    twin = BoardConfiguration.for_spec(drawn.spec, **drawn.settings)
    gateware = rtl_configuration(drawn.spec, **drawn.settings)
    assert replace(twin, clock_hz=gateware.clock_hz, tosnet=gateware.tosnet) == gateware
    with (
        Board(drawn.spec, configuration=replace(twin, clock_hz=gateware.clock_hz), plant=Still()) as model,
        RtlBoard(drawn.spec, configuration=gateware, plant=Still()) as compiled,
        Link(f"{model.url}?{TIMEOUT}") as to_model,
        Link(f"{compiled.url}?{TIMEOUT}") as to_compiled,
    ):
        yield (model, to_model), (compiled, to_compiled)


def publishes(spec: Spec, link: Link) -> list[Any]:
    """Return which values travel together, how often, and whether the device sends them by itself."""
    robot = load_spec_objects(spec, link)
    with robot.publishing():
        return [(one.paths, one.rate_hz, one.hardware) for one in robot.publisher.reports()]


@pytest.mark.parametrize(("drawn", "cycle"), DRAWN)
def test_twin_and_gateware_are_the_same_device(drawn: Drawn, cycle: int | None) -> None:
    with both(drawn) as ((model, to_model), (compiled, to_compiled)):
        assert to_model.description == to_compiled.description
        assert to_model.configuration == to_compiled.configuration
        told = to_model.description
        assert told is not None
        assert told.features == 0x1F
        split = publishes(drawn.spec, to_model)
        assert split == publishes(drawn.spec, to_compiled)
        if cycle is None:
            assert max(len(paths) for paths, _, _ in split) == 60, "one rate has more than a publish carries"
            assert all(hardware for _, _, hardware in split)
        exchange(drawn.spec, told.exchange_size, cycle, [(model, to_model), (compiled, to_compiled)])
        if cycle is None:
            words_with_two_sides(drawn.spec, model, to_model)
            words_with_two_sides(drawn.spec, compiled, to_compiled)
        groups_that_do_not_exist(told, to_model, to_compiled)


def words_with_two_sides(spec: Spec, board: Board, link: Link) -> None:
    """A one that the PC writes clears its flag, each time. A PULSE does not change the READ of its word."""
    robot, address = load_spec_objects(spec, link), {path: one.address for path, one in spec.walk()}
    board.registers[address["flags"]] = 0xFF
    for mask, left in ((0x0F, 0xF0), (0x10, 0xE0), (0x10, 0xE0)):
        robot["flags"].clear(mask)
        assert robot["flags"].read() == board.registers[address["flags"]] == left
    board.registers[address["flags"]] = 0x10
    robot["flags"].clear(0x10)
    assert robot["flags"].read() == 0
    for read, pulse in (("state", "start"), ("level", "stop")):
        board.registers[address[read]] = 0x55
        robot[pulse].pulse(3)
        assert robot[read].read() == board.registers[address[read]] == 0x55


def exchange(spec: Spec, most: int, cycle: int | None, sides: list[tuple[Board, Link]]) -> None:
    """Play a control cycle on both sides, with random words.

    It has as many words as an exchange group holds.
    """
    draw = random.Random(7)
    elements = [element for _, element in spec.walk()]
    outputs = [e.address for e in elements if e.access == "WRITE" and e.link.kind == "memory"]
    committed = [e.address for e in elements if e.writable and e.link.kind == "tosnet"]
    inputs = [e.address for e in elements if e.pollable and not e.writable]
    writes = (outputs + committed)[: most // 2]
    reads = inputs[: min(most - len(writes), 60)]
    assert cycle is None or len(writes) + len(reads) == cycle
    groups = [link.exchange_group(writes=writes, reads=reads) for _, link in sides]
    for number in range(EXCHANGES):
        if number % 50 == 0 and not committed:
            for address in reads:
                value = draw.getrandbits(32)
                for board, _ in sides:
                    board.registers[address] = value
        words = [draw.getrandbits(32) for _ in writes]
        first, second = (group.exchange(words).tolist() for group in groups)
        assert first == second, f"exchange {number}"
        if number % 100 == 0 and not committed:
            for board, _ in sides:
                assert [board.registers[address] for address in writes] == words


def groups_that_do_not_exist(told: Any, *links: Link) -> None:
    """Twin and gateware refuse one word or one group too many with the same message. It names the limit."""
    said = []
    for link in links:
        with pytest.raises(DeviceMismatch) as caught:
            link.exchange_group(reads=[0] * (told.exchange_size + 1))
        said.append(str(caught.value))
        while True:
            try:
                link.exchange_group(reads=[0])
            except DeviceMismatch as error:
                said.append(str(error))
                break
    assert said[:2] == said[2:]
    assert f"hold {told.exchange_size}" in said[0]
    assert f"all {told.exchanges} exchange groups" in said[1]
