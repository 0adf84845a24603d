# SPDX-License-Identifier: BSD-3-Clause
"""What is proven about the small engine of the framed protocol. The addresses are those of its program."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path
from types import ModuleType

from block import Block, Mutant
from small_facts import table

_ASSEMBLER = Path(__file__).resolve().parents[1] / "small" / "assemble.py"


def _assembler() -> ModuleType:
    """Return tools/small/assemble.py, which is no package."""
    spec = importlib.util.spec_from_file_location("small_assemble", _ASSEMBLER)
    assert spec and spec.loader
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


_assemble = _assembler()
PLAIN = _assemble.assemble(_assemble.SOURCE.read_text(encoding="utf-8"), "plain")

# Places of the program, and bytes of its memory, that the property file names.
_LABELS = (
    "now", "take_address", "write_word", "open_new",
    "listen", "decode_end", "is_long", "no_session", "is_wrong", "judged", "judged_kind",
    "drop", "done", "judge", "distance", "not_new", "put_reply", "remember", "slot", "fails", "post",
    "finish", "write", "open", "session", "session_place", "bump", "clear",
)  # fmt: skip
_VARIABLES = (
    "kind", "id_h", "id_l", "record", "status", "count", "repeated", "scratch", "found", "low", "high",
    "head", "look", "after", "outside", "posts_h", "posts_l", "places",
)  # fmt: skip
_ADDRESSES = {f"at_{name}": PLAIN.labels[name] for name in _LABELS} | {
    f"byte_{name}": PLAIN.names[name] for name in _VARIABLES
}
_SEEN = (
    "executing",
    "read_address",
    "write_address",
    "written",
    "writes",
    "store",
    "put",
    "acts",
    "tells",
    "notes",
)
_PROCESSOR = (
    "position", "caller", "caller_before", "instruction", "a", "x", "carry", "loads", "loads_carry", "points",
    "goes_on", "moves", "follows",
)  # fmt: skip

SMALL_BLOCKS = (
    Block(
        "small_engine",
        "`small/framed_small` with its program, and any one of its places",
        depth=0,
        deep=6,
        induction=3,
        generics={"facts": table(PLAIN), **_ADDRESSES},
        given={"dut.looked": "looked"},
        seen={name: f"dut.{name}" for name in _SEEN} | {name: f"dut.processor.{name}" for name in _PROCESSOR},
        by_abc=True,
        guided={"guided": 1, "watched": 1},
        reach=1120,
        not_proven="that the ring keeps the kind of a checked frame; that a frame with a wrong check is not "
        "executed; publishing; other windows than 8",
        mutants=(
            # A READ is executed without a look at its id.
            Mutant(
                "small_program_pkg.vhd",
                'x"F1F7", x"F05E", x"6004"',
                'x"00CC", x"F05E", x"6004"',
            ),
            Mutant("small_program_pkg.vhd", 'x"F243", x"F2E5"', 'x"00DD", x"F2E5"'),  # nothing is remembered
            Mutant("small_program_pkg.vhd", 'x"99DF"', 'x"0201"'),  # any POST is the next one
            Mutant(
                "byte_processor.vhd",
                "carry_in   <= carry when operation(0) = '1' else operation(1);",
                "carry_in   <= operation(1);",
            ),
            Mutant("byte_processor.vhd", "caller_before <= caller;", "null;"),
            Mutant(
                "framed_small.vhd",
                "write_address <= '0' & reply_page & reply_place;",
                'write_address <= "001" & reply_place;',
            ),
        ),
    ),
)
