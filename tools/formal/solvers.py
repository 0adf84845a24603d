# SPDX-License-Identifier: BSD-3-Clause
"""The solvers, each asked one thing of a model."""

from __future__ import annotations

import re
from pathlib import Path

from model import Model, run

from unitylink.errors import ToolError


def violated(model: Model, first: int, clocks: int, trace: Path | None = None) -> list[str]:
    """Return what z3 finds violated within `clocks` clocks from number `first` on; the waves go to `trace`.

    The clocks before the first one are taken to be good.
    """
    waves = [f"--dump-vcd={trace}"] if trace else []
    code, said = _smtbmc(model, f"{first}:{first + clocks}" if first else f"{clocks}", *waves)
    failed = re.findall(r"Assert failed in \S+: (\S+)", said)
    if (code == 0) == bool(failed) or "Status: " not in said:
        raise ToolError(f"yosys-smtbmc ended with {code} and says:\n{said[-2000:]}")
    return failed


def violated_at(model: Model, depth: int) -> int | None:
    """Return the first of `depth` clocks in which ABC finds a property violated, or None."""
    said = _abc(model, f"bmc3 -F {depth}")
    if found := re.search(r"was asserted in frame (\d+)", said):
        return int(found.group(1))
    if f"No output asserted in {depth} frames" in said:
        return None
    raise ToolError(f"yosys-abc has no answer for {model.top}:\n{said[-2000:]}")


def inductive(model: Model, depth: int) -> bool:
    """Return whether z3 shows that `depth` good clocks, from any state at all, are followed by a good one."""
    code, said = _smtbmc(model, str(depth), "-i")
    if "Status: " not in said:
        raise ToolError(f"yosys-smtbmc ended with {code} and says:\n{said[-2000:]}")
    return code == 0


def reached(model: Model, depth: int) -> dict[str, int]:
    """Return which covers can be reached within `depth` clocks, and after how many."""
    code, said = _smtbmc(model, str(depth), "-c")
    if "Status: " not in said:
        raise ToolError(f"yosys-smtbmc ended with {code} and says:\n{said[-2000:]}")
    found = re.findall(r"Reached cover statement at (\S+) in step (\d+)", said)
    return {name: int(step) for name, step in found if name in model.covered}


def always(model: Model) -> bool:
    """Return whether ABC finds an invariant under which no property can ever be violated."""
    said = _abc(model, "scorr; pdr")
    if "Property proved" in said:
        return True
    if "was asserted in frame" in said:
        return False
    raise ToolError(f"yosys-abc has no answer for {model.top}:\n{said[-2000:]}")


def _smtbmc(model: Model, steps: str, *options: str) -> tuple[int, str]:
    return run(
        ["yosys-smtbmc", "--noprogress", "--unroll", "-s", "z3", "-t", steps, *options, str(model.smt2)]
    )


def _abc(model: Model, question: str) -> str:
    _, said = run(["yosys-abc", "-c", f"read_aiger {model.aiger}; fold; strash; {question}"])
    return said
