# SPDX-License-Identifier: BSD-3-Clause
"""Questions about large models: induction by ABC, and covers with a guide."""

from __future__ import annotations

import re

import model as models
import solvers
from block import Block
from model import Model

from unitylink.errors import ToolError


def inductive(model: Model, depth: int) -> bool:
    """Return whether ABC shows that a good clock follows after `depth` good clocks, from any state at all.

    It does so in seconds where z3 takes hours.
    """
    said = solvers._abc(model, f"orpos; ind -F {depth}")
    if "Networks are equivalent" in said:
        return True
    if "Networks are UNDECIDED" in said:
        return False
    raise ToolError(f"yosys-abc has no answer for {model.top}:\n{said[-2000:]}")


def unreachable(block: Block, model: Model) -> Model:
    """Return a model that asserts only that each cover is never reached. Its guided inputs are constants."""
    source = model.smt2.with_suffix(".v")
    verilog = re.sub(r"(?m)^.*\bassert\(.*$", "", source.read_text(encoding="utf-8"))
    verilog = re.sub(r"\bcover\(", "assert(!", verilog)
    before, top, after = verilog.partition(f"module {block.top}\n")
    for port, value in block.guided.items():
        found = re.search(rf"input +(\[\d+:0\] +)?{port}\b,\s*", after)
        if found is None:
            raise ToolError(f"{block.name}: there is no input {port} to be guided")
        after = after.replace(found.group(), "", 1)
        after = after.replace(");\n", f");\n  wire {found.group(1) or ''}{port} = {value};\n", 1)
    return models._made(block, before + top + after, source.with_name("covers.v"))
