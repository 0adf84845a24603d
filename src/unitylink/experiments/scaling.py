# SPDX-License-Identifier: BSD-3-Clause
"""What a read costs this host as the spec and the number of links grow: time of the thread that calls."""

from __future__ import annotations

from contextlib import ExitStack
from itertools import cycle
from statistics import median
from typing import Any

from .software_cost import thread_s

REGISTERS = (10, 100, 1000, 5000)
LINKS = (1, 2, 4, 8, 16, 32)


def scaling(*, rounds: int, count: int = 100) -> dict[str, list[dict[str, Any]]]:
    """Return the cost of a read by name against the number of registers, and of links."""
    return {
        "registers": [
            {"count": number, "read_s": registers_s(number, rounds=rounds, count=count)}
            for number in REGISTERS
        ],
        "links": [
            {"count": number, "read_s": links_s(number, rounds=rounds, count=count)} for number in LINKS
        ],
    }


def registers_s(number: int, *, rounds: int, count: int) -> float:
    """Return the seconds of a read, spread over the registers of a spec with so many."""
    return _read_s(number, 1, rounds, count)


def links_s(number: int, *, rounds: int, count: int) -> float:
    """Return the seconds of a read, in turns over so many links in one process."""
    return _read_s(1, number, rounds, count)


def _read_s(registers: int, links: int, rounds: int, count: int) -> float:
    from unitylink import connect
    from unitylink.layer4_data import ReadValue, load_spec_objects
    from unitylink.simulate import Board, BoardConfiguration
    from unitylink.spec import compile_text

    lines = "".join(f'   @r{n} = {n:#x}: READ(ID="r{n}");\n' for n in range(registers))
    spec = compile_text(f"link plain;\npublic many() {{\n{lines}}}\n".encode(), "many.ul").spec
    assert spec is not None
    configuration = BoardConfiguration.for_spec(spec)
    with ExitStack() as stack:
        words: list[ReadValue[Any]] = []
        for _ in range(links):
            board = stack.enter_context(Board(configuration=configuration))
            tree = load_spec_objects(spec, stack.enter_context(connect(board.url)))
            for n in range(0, registers, max(1, registers // 16)):
                word = tree[f"r{n}"]
                assert isinstance(word, ReadValue)
                words.append(word)
        turn = cycle(words)
        return median(thread_s(lambda: next(turn).read(), count) for _ in range(rounds))
