# SPDX-License-Identifier: BSD-3-Clause
"""Make the listing of the framed engine's program:  python tools/docs/framed_program.py [--check]

GHDL assembles the program, and the words of the page are those of the VHDL. The same VHDL gives the same
page.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

from made_files import parser_of, write_or_compare

from unitylink.gateware.framed_program import FIELDS, Program, instruction_set, program_of

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "gateware" / "framed-program.md"
WHOLE = "core_settings(protocol => protocol_framed)"
WITHOUT = "publish_mode => 0, lists => false, exchanges => 0, deadman => false"
LEAST = f"core_settings(protocol => protocol_framed, {WITHOUT})"
ROOM = 512


def words() -> Iterator[str]:
    """Yield the table of the words that instructions are made of."""
    for field, what in FIELDS.items():
        yield f"| **{what}** | |"
        for one in instruction_set()[field].values():
            if one.value or field == "action":
                yield f"| `{one.name}` | {one.about} |"


ABOUT = """\
<!-- Generated from gateware/framed by tools/docs/framed_program.py; edit there. -->
# The program of the framed engine

This is the program with all features, at 1 address byte and 4 data bytes. It takes {whole} of {room}
places. The one of a core without publishing, lists, exchange groups and dead-man takes {least} of 256.

Read [frame_application](frame_application.md) first. Each line has the place in hexadecimal, its name,
and what the instruction does. All of it is done in one clock, or in one clock for each of the `times`.
The next line follows, or the place behind `then`. `if` and `unless` name a condition and the place to
which it jumps. A number is what is compared or sent, in hexadecimal, or the word of the memory that is
addressed. `entry_` is where a frame of this kind begins. At `form_` its form is checked, and at `check_`
it is executed. [Watch it run](../rtl-simulation.md#program-steps).
"""


def page(whole: Program, least: Program) -> str:
    """Return docs/gateware/framed-program.md."""
    return "\n".join(
        [
            ABOUT.format(whole=len(whole.words), room=ROOM, least=len(least.words)),
            "```text",
            *(line.rstrip() for line in whole.lines()),
            "```",
            "",
            "## The words",
            "",
            "| word | what it does |",
            "| -- | -- |",
            *words(),
        ]
    )


def main() -> int:
    """Write the page, or compare it."""
    given = parser_of("Make the listing of the framed engine's program.").parse_args()
    from page_format import formatted

    made = formatted(page(program_of(WHOLE), program_of(LEAST)) + "\n")
    return write_or_compare({PAGE: made}, check=given.check)


if __name__ == "__main__":
    sys.exit(main())
