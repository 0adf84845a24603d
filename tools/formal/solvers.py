# SPDX-License-Identifier: BSD-3-Clause
"""The solvers. Each function asks one of them one question about a model."""

from __future__ import annotations

import re
from pathlib import Path

from model import Model, run

from unitylink.errors import ToolError

_ASSERTED = re.compile(r"Output +(\d+)\b.* was asserted in frame +(\d+)")
_SATISFIABLE = re.compile(r"^SATISFIABLE", re.MULTILINE)
# in a model without memory, one clock is as good as many
_NO_MEMORY = "Does not work for combinational networks"


def violated(model: Model, depth: int, trace: Path | None = None) -> list[str]:
    """Return what z3 finds violated within `depth` clocks of power-up. The waves go to `trace`."""
    waves = [f"--dump-vcd={trace}"] if trace else []
    return _violated(model, "-t", str(depth), *waves)


def violated_at(model: Model, depth: int) -> tuple[int, str] | None:
    """Return the first of `depth` clocks in which ABC finds a violation, and its property.

    Return None if there is none.

    The inputs that lead there are kept beside the model, for `followed`.
    """
    said = _abc(model, f"bmc3 -F {depth}; write_cex -a {model.witness}")
    if found := _ASSERTED.search(said):
        return int(found.group(2)), model.asserted[int(found.group(1))]
    if f"No output asserted in {depth} frames" in said:
        return None
    if _NO_MEMORY in said:
        failed = violated(model, 1)
        return (0, failed[0]) if failed else None
    raise ToolError(f"yosys-abc has no answer for {model.top}:\n{said[-2000:]}")


def followed(model: Model, trace: Path) -> list[str]:
    """Return what z3 finds violated with the inputs that ABC found. The waves go to `trace`."""
    witness = f"{model.aiger}.map:{model.witness}"
    return _violated(model, "--aig", witness, "--aig-noheader", f"--dump-vcd={trace}")


def inductive(model: Model, depth: int) -> bool:
    """Return whether z3 shows that a good clock follows after `depth` good clocks, from any state at all."""
    return _smtbmc(model, "-t", str(depth), "-i")[0] == 0


def reached(covers: Model, depth: int) -> dict[str, int]:
    """Return the covers that ABC reaches within `depth` clocks, each with its clock.

    `covers` is the result of `unreachable`.
    """
    if not covers.asserted:
        return {}
    said = _abc(covers, f"bmc3 -a -x -F {depth}")
    if _NO_MEMORY in said:
        outputs = enumerate(covers.asserted)
        return {
            name: 0 for output, name in outputs if _SATISFIABLE.search(_abc(covers, f"cone -O {output}; sat"))
        }
    return {covers.asserted[int(output)]: int(clock) for output, clock in _ASSERTED.findall(said)}


def reached_late(covers: Model, name: str) -> int | None:
    """Return the clock in which ABC reaches a cover, however late. Return None if it never does."""
    said = _abc(covers, f"cone -O {covers.asserted.index(name)} -s; scorr; dc2; scorr; pdr")
    if found := _ASSERTED.search(said):
        return int(found.group(2))
    if "Property proved" in said:
        return None
    raise ToolError(f"yosys-abc has no answer for {name} of {covers.top}:\n{said[-2000:]}")


def always(model: Model, name: str | None = None) -> bool:
    """Return whether ABC finds an invariant under which no property is ever violated, or not the one called
    `name`.
    """
    alone = f"cone -O {model.asserted.index(name)} -s; scorr; dc2; " if name else ""
    said = _abc(model, f"{alone}scorr; pdr")
    if "Property proved" in said:
        return True
    if "was asserted in frame" in said:
        return False
    raise ToolError(f"yosys-abc has no answer for {model.top}:\n{said[-2000:]}")


def _violated(model: Model, *options: str) -> list[str]:
    code, said = _smtbmc(model, *options)
    failed = re.findall(r"Assert failed in \S+: (\S+)", said)
    if (code == 0) == bool(failed):
        raise ToolError(f"yosys-smtbmc ended with {code} and says:\n{said[-2000:]}")
    return failed


def _smtbmc(model: Model, *options: str) -> tuple[int, str]:
    code, said = run(["yosys-smtbmc", "--noprogress", "--unroll", "-s", "z3", *options, str(model.smt2)])
    if "Status: " not in said:
        raise ToolError(f"yosys-smtbmc ended with {code} and says:\n{said[-2000:]}")
    return code, said


def _abc(model: Model, question: str) -> str:
    code, said = run(["yosys-abc", "-c", f"read_aiger {model.aiger}; fold; strash; {question}"])
    if code != 0:
        raise ToolError(f"yosys-abc ended with {code} and says:\n{said[-2000:]}")
    return said
