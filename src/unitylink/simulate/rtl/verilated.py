# SPDX-License-Identifier: BSD-3-Clause
"""The code that Verilator has written."""

from __future__ import annotations

import re
from pathlib import Path

_OF_ROOT = r"void Vmodel___024root___{}\(Vmodel___024root\* vlSelf\) \{{\n(.*?)\n\}}"
# Lines of each function that do nothing, and comments.
_IDLE = re.compile(r" *(if \(false && vlSelf\) \{\}.*|Vmodel__Syms\* const .*|VL_DEBUG_IF.*|//.*)")


def has_one_trigger(made: Path) -> bool:
    """Whether the code in the folder `made` waits for the clock and nothing else. Then a clock is one call.

    eval() asks again and again what has changed, which is a tenth of its work. Another version of Verilator
    may write other code, for which this is False.
    """
    root = (made / "Vmodel___024root.h").read_text(encoding="utf-8")
    code = "".join(path.read_text(encoding="utf-8") for path in sorted(made.glob("*.cpp")))
    before = re.search(_OF_ROOT.format("eval_act"), code, re.DOTALL)
    steps = re.search(_OF_ROOT.format("eval_nba"), code, re.DOTALL)
    if before is None or steps is None:
        return False
    return (
        "VlTriggerVec<1> __VnbaTriggered;" in root
        and "__Vico" not in root  # no logic depends directly on an input
        and all(_IDLE.fullmatch(line) for line in before[1].splitlines())
        and re.findall(r"if \((?!false)(.*)\) \{", steps[1]) == ["vlSelf->__VnbaTriggered.at(0U)"]
    )
