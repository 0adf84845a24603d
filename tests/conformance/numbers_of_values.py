# SPDX-License-Identifier: BSD-3-Clause
"""Random values and numbers, which programs encode and decode as Python does."""

from __future__ import annotations

import math
import random
import subprocess
from collections.abc import Callable, Iterator
from pathlib import Path

from unitylink.errors import ValueRangeError
from unitylink.spec import compile_text
from unitylink.spec.model import Spec
from unitylink.values import Codec, Quantity


def quantities(chance: random.Random) -> Iterator[str]:
    """Yield the words of values in a spec: those with each end of their limits, and random ones."""
    for type_ in ("u8", "u64", "i16", "i64"):
        for facts in ("MIN=3", "MAX=90", "MIN=3, MAX=90", "MIN=3, MAX=90, OVERFLOW=saturate"):
            yield f"{type_} WRITE({facts})"
    for _ in range(120):
        width = chance.choice([1, 2, 7, 8, 15, 16, 31, 32, 33, 53, 63, 64])
        kind = chance.choice(["u", "u", "i", "i", "f", "fixed"])
        if kind == "fixed":
            fraction = chance.randint(0, 16)
            type_ = f"{chance.choice(['fixed', 'ufixed'])}({chance.randint(1, 16)},{fraction})"
        else:
            type_ = f"f{chance.choice([32, 64])}" if kind == "f" else f"{kind}{max(width, 2)}"
        facts = []
        if chance.random() < 0.5:
            facts.append(f"SCALE={chance.choice([0.001, -0.1, 3, 0.3333, 1e-9, 1e6])}")
        if chance.random() < 0.3:
            facts.append(f"MIN={chance.choice([-1, 0, 1])}, MAX={chance.choice([1, 1, 50])}")
        if facts and chance.random() < 0.5:
            facts.append("OVERFLOW=saturate")
        yield f"{type_} WRITE({', '.join(facts)})"


def random_spec(seed: int) -> Spec:
    """Return a spec with the values whose facts go together."""
    kept: list[str] = []
    for words in quantities(random.Random(seed)):
        one = f"@v{len(kept)} = 0x{4 * len(kept):X}: {words};"
        if compile_text(f"public random() {{ {one} }}", "random.ul").spec is not None:
            kept.append(one)
    spec = compile_text(f"public random() {{ {' '.join(kept)} }}", "random.ul").spec
    assert spec is not None and len(kept) > 40
    return spec


def compare_numbers(
    program: Path | list[str | Path],
    spec: Spec,
    seed: int,
    written: Callable[[float], str],
    rounds: int = 60,
) -> None:
    """Ask a program for random numbers, and compare its answers with Python's.

    `written` writes a real number. `rounds` is how often each value is asked for.
    """
    chance = random.Random(seed)
    asked: list[str] = []
    wanted: list[int | float | None] = []
    for index, (_, element) in enumerate(spec.walk()):
        codec = Codec(element.path, Quantity.of(element), 32, commanded=True)
        whole = codec.integer_sign is not None
        for _ in range(rounds):
            raw = chance.choice([0, 1, codec.mask, codec.mask >> 1, chance.getrandbits(codec.width)])
            value = codec.decode(raw)
            asked.append(f"d {index} {raw}")
            wanted.append(value if whole else float(value))
            near = (
                value if chance.random() < 0.5 else chance.choice([codec.minimum, codec.maximum, 0, 7, 1e30])
            )
            number = int(near) + chance.randint(-2, 2) if whole else float(near) * chance.uniform(0.9, 1.1)
            if not whole and chance.random() < 0.05:
                number = chance.choice([math.nan, math.inf, -math.inf])
            if whole and not (0 if codec.type.kind == "uint" else -(1 << 63)) <= number < 1 << 63:
                continue  # no whole number of 64 bits
            asked.append(f"e {index} {number if whole else written(number)}")
            try:
                wanted.append(codec.encode(number))
            except ValueRangeError:
                wanted.append(None)
    command = [program] if isinstance(program, Path) else program
    done = subprocess.run(command, input="\n".join(asked), capture_output=True, text=True, check=True)
    found = done.stdout.splitlines()
    assert len(found) == len(wanted)
    for question, ours, theirs in zip(asked, found, wanted, strict=True):
        assert _same(ours, theirs), (question, ours, theirs)
    assert None in wanted


def _same(found: str, wanted: int | float | None) -> bool:
    if wanted is None or isinstance(wanted, int):
        return found == ("-" if wanted is None else str(wanted))
    number = float.fromhex(found) if "0x" in found else float(found)
    return number.hex() == wanted.hex()
