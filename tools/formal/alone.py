# SPDX-License-Identifier: BSD-3-Clause
"""Induction for a model that is too large for ABC's own: ABC is asked about each property alone.

All properties are taken as good in the clocks before, from any state at all. So if each of them holds in the
next clock, all of them do: that is the same induction, in smaller questions.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

import solvers
from model import Model

from unitylink.errors import ToolError

# Not a field of `Block`, because all fields are in the digests of all blocks.
ALONE = ("frame_application_lists",)


@dataclass(frozen=True)
class Aiger:
    """A binary AIGER file. A literal is twice a variable, plus 1 if it is inverted.

    First come the inputs, then the latches, then the gates.
    """

    inputs: int
    latches: list[int]  # what each one takes next
    bad: list[int]  # each is 1 when a property is violated
    assumed: list[int]
    gates: list[tuple[int, int]]

    @staticmethod
    def read(path: Path) -> Aiger:
        data = path.read_bytes()
        line_end = data.index(b"\n")
        numbers = [int(word) for word in data[:line_end].split()[1:]] + [0] * 4
        _, inputs, latches, outputs, gates, bad, assumed = numbers[:7]
        at = line_end + 1
        lines = []
        for _ in range(latches + outputs + bad + assumed):
            line_end = data.index(b"\n", at)
            lines.append(int(data[at:line_end].split()[0]))
            at = line_end + 1
        pairs = []
        for gate in range(gates):
            first, at = _number(data, at)
            second, at = _number(data, at)
            left = 2 * (inputs + latches + 1 + gate) - first
            pairs.append((left, left - second))
        bad_from = latches + outputs
        return Aiger(
            inputs, lines[:latches], lines[bad_from : bad_from + bad], lines[bad_from + bad :], pairs
        )


def step(model: Model, depth: int) -> Path:
    """Write a model with an output for each property: it is violated after `depth` good clocks.

    Its latches begin with any value, but for `depth` ones that count the clocks, and one that is set when
    something was wrong. Return its path.
    """
    old = Aiger.read(model.aiger)
    kept = old.inputs + len(old.latches)
    more = depth + 1

    def moved(literal: int) -> int:
        return literal if literal // 2 <= kept else literal + 2 * more

    gates = [(moved(left), moved(right)) for left, right in old.gates]

    def both(left: int, right: int) -> int:
        gates.append((max(left, right), min(left, right)))
        return 2 * (kept + more + len(gates))

    counting = [2 * (kept + 1 + clock) for clock in range(depth)]
    wrong = 2 * (kept + more)
    allowed = 1
    for literal in old.assumed:
        allowed = both(allowed, moved(literal))
    good = allowed
    for literal in old.bad:
        good = both(good, moved(literal) ^ 1)
    asked = both(both(wrong ^ 1, allowed), counting[-1])
    outputs = [both(moved(literal), asked) for literal in old.bad]
    wrong_next = both(wrong ^ 1, good) ^ 1

    lines = [f"{moved(literal)} {2 * (old.inputs + 1 + index)}" for index, literal in enumerate(old.latches)]
    lines += [f"{literal} 0" for literal in [1, *counting[:-1], wrong_next]]
    lines += map(str, outputs)
    latches = len(old.latches) + more
    size = old.inputs + latches + len(gates)
    head = f"aig {size} {old.inputs} {latches} {len(outputs)} {len(gates)}\n"
    data = bytearray()
    for index, (left, right) in enumerate(gates):
        data += _bytes(2 * (kept + more + 1 + index) - left) + _bytes(left - right)
    path = model.aiger.with_name("step.aig")
    path.write_bytes((head + "\n".join(lines) + "\n").encode() + data)
    return path


def inductive(model: Model, depth: int) -> bool:
    """Return whether ABC shows, for each property alone, that it holds after `depth` good clocks."""
    question = f"read_aiger {step(model, depth)}; logic; undc; strash; bmc3 -a -x -F {depth + 1}"
    code, said = solvers.run(["yosys-abc", "-c", question])
    if code == 0 and re.search(r"was asserted in frame", said):
        return False
    if code == 0 and f"No output asserted in {depth + 1} frames" in said:
        return True
    raise ToolError(f"yosys-abc has no answer for {model.top}:\n{said[-2000:]}")


def _number(data: bytes, at: int) -> tuple[int, int]:
    """Return the number at this place, and the place behind it."""
    value = shift = 0
    while data[at] & 0x80:
        value |= (data[at] & 0x7F) << shift
        shift += 7
        at += 1
    return value | data[at] << shift, at + 1


def _bytes(value: int) -> bytes:
    data = bytearray()
    while value > 0x7F:
        data.append(value & 0x7F | 0x80)
        value >>= 7
    data.append(value)
    return bytes(data)
