# SPDX-License-Identifier: BSD-3-Clause
"""Section III.B of the paper: how many lines one has to write for the 18-DOF walker."""

from __future__ import annotations

from unitylink.generate import generate_python, generate_vhdl
from unitylink.resources import resource_folder
from unitylink.spec import load

SPECS = ("walker18.ul", "walker18_si.ul")
# The paper's counts. For the microcontroller (MCU) it gives lines of C, and lines of C and assembly.
PAPER = {
    "specification": 23,
    "VHDL, configured": 14,
    "VHDL, copied": 32,
    "MCU, communication": 58,
    "MCU, hardware": 82,
}


def code_lines(text: str, comment: str) -> int:
    """Count the lines that are neither empty nor only a comment.

    >>> code_lines("a\\n\\n// b\\nc // d\\n", "//")
    2
    """
    lines = (line.strip() for line in text.splitlines())
    return sum(bool(line) and not line.startswith(comment) for line in lines)


def simplicity() -> list[dict[str, object]]:
    """Count, for each spec of the walker, the lines written and those generated from it."""
    folder = resource_folder("examples") / "walker18"
    rows: list[dict[str, object]] = []
    for name in SPECS:
        path = folder / name
        spec = load(path)
        rows.append(
            {
                "file": f"examples/walker18/{name}",
                "written": code_lines(path.read_text(encoding="utf-8"), "//"),
                "python": sum(code_lines(text, "#") for text in generate_python(spec).values()),
                "vhdl": sum(
                    code_lines(text, "--")
                    for file, text in generate_vhdl(spec).items()
                    if file.endswith(".vhd")
                ),
            }
        )
    return rows
