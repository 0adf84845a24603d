# SPDX-License-Identifier: BSD-3-Clause
"""The question for an invariant, where ABC must first merge all registers that are always equal.

A property file may keep the same memory as the design. `solvers.always` merges both, but it gives up a node
after 1000 conflicts, and then finds no invariant at all. Here it may try for longer.
"""

from __future__ import annotations

import solvers
from model import Model

from unitylink.errors import ToolError

# Not a field of `Block`, because all fields are in the digests of all blocks.
SWEPT = ("encoder_bank",)

_CONFLICTS_MOST = 100_000  # for one node


def always(model: Model) -> bool:
    """Return whether ABC finds an invariant under which no property is ever violated."""
    said = solvers._abc(model, f"scorr -C {_CONFLICTS_MOST}; pdr")
    if "Property proved" in said:
        return True
    if "was asserted in frame" in said:
        return False
    raise ToolError(f"yosys-abc has no answer for {model.top}:\n{said[-2000:]}")
