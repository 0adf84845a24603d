# SPDX-License-Identifier: BSD-3-Clause
"""The question for an induction, where ABC must first merge all registers that are always equal.

A property file may keep the same memory as the design. `sweep` merges more than registers. So it takes facts
out of the properties that it finds to be always true, and an induction needs them. Here ABC merges registers
alone.
"""

from __future__ import annotations

import solvers
from model import Model

from unitylink.errors import ToolError

# Not a field of `Block`, because all fields are in the digests of all blocks.
MERGED = ("pulse_counter_words", "quadrature_encoder_counts")

_CONFLICTS_MOST = 100_000  # for one register


def inductive(model: Model, depth: int) -> bool:
    """Return whether ABC shows, with registers merged, that a good clock follows after `depth` of them."""
    said = solvers._abc(model, f"lcorr -C {_CONFLICTS_MOST}; orpos; ind -F {depth}")
    if "Networks are equivalent" in said:
        return True
    if "Networks are UNDECIDED" in said:
        return False
    raise ToolError(f"yosys-abc has no answer for {model.top}:\n{said[-2000:]}")
