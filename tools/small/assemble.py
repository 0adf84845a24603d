# SPDX-License-Identifier: BSD-3-Clause
"""Assemble the program of the small engine (gateware/small/program.asm).

python tools/small/assemble.py            write the VHDL package and the listing
python tools/small/assemble.py --check    write nothing; exit 1 if one of them is stale
"""

from __future__ import annotations

import re
import sys
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from unitylink import protocol

ROOT = Path(__file__).resolve().parents[2]
SOURCE = ROOT / "gateware" / "small" / "program.asm"
PACKAGE = ROOT / "gateware" / "small" / "small_program_pkg.vhd"
LISTING = ROOT / "docs" / "gateware" / "small-program.md"
NOTE = "Generated from gateware/small/program.asm by tools/small/assemble.py; edit there."

PROGRAM_WORDS = 1024
MEMORY_BYTES = 512

# They are the same as in gateware/small/small_instruction_pkg.vhd.
OPERATIONS = (
    "ld",
    "and",
    "or",
    "xor",
    "add",
    "adc",
    "sub",
    "sbc",
    "in",
    "st",
    "ldx",
    "put",
    "out",
    "tell",
    "clr",
    "taken",
)
CONDITIONS = ("jmp", "jz", "jc", "jpiece", "jsending", "jaccess", "jturned")
INVERTED = {"ret": "jmp", "jnz": "jz", "jnc": "jc", "jnturned": "jturned", "jnpiece": "jpiece"}
PORTS = ("data", "check", "status", "x")
ACTIONS = {
    "out": ("shift_data", "shift_address", "read", "write", "time", "crc", "crc_clear", "send", "free"),
    "tell": ("turn_seen", "overrun_seen", "start", "trip", "renew", "arm", "counted", "alive", "check_next"),
}
DIRECT, IMMEDIATE = 0, 1
MODES = {"[x]": 2, "[x+]": 3}

# gateware/small/small_memory_pkg.vhd and framed_small.vhd need these values.
TOLD = (
    "description", "a_bytes", "d_bytes", "window", "window_mask", "post_size", "write_bytes", "reply", "ring",
    "request_max", "reply_max", "credit", "cache_bytes", "window_max",
)  # fmt: skip


class Mistake(ValueError):
    """A line cannot be assembled."""


@dataclass(frozen=True)
class Line:
    """One instruction of the source."""

    number: int  # number of the line
    labels: tuple[str, ...]
    operation: str
    operand: str
    comment: str


@dataclass
class Program:
    """The source, taken apart: its instructions, the labels that they name, and the values of names."""

    lines: list[Line] = field(default_factory=list)
    labels: dict[str, int] = field(default_factory=dict)
    names: dict[str, int] = field(default_factory=dict)
    heads: dict[int, list[str]] = field(
        default_factory=dict
    )  # comments that fill a line, by the next instruction
    words: list[int] = field(default_factory=list)


def constants() -> dict[str, int]:
    """Return the constants of the protocol by their names in Python."""
    return {name: value for name, value in vars(protocol).items() if isinstance(value, int)}


def value_of(text: str, names: Mapping[str, int]) -> int:
    """Return the value of an expression."""
    try:
        return int(eval(text, {"__builtins__": {}}, dict(names)))
    except (NameError, SyntaxError, TypeError) as error:
        raise Mistake(f"{text}: {error}") from error


def within(value: int, most: int, text: str) -> int:
    """Return a value that must be at most `most`."""
    if not 0 <= value < most:
        raise Mistake(f"{text} is {value}, and must be from 0 to {most - 1}")
    return value


def parse(text: str) -> Program:
    """Take the source apart.

    >>> parse(".var there\\nhere: ld there ; why").lines
    [Line(number=2, labels=('here',), operation='ld', operand='there', comment='why')]
    """
    program = Program(names=constants())
    address = 0
    waiting: list[str] = []  # labels of the next instruction
    for number, line in enumerate(text.splitlines(), 1):
        code, _, comment = line.partition(";")
        label = re.match(r"(\w+):", code)
        if label:
            if label[1] in program.labels:
                raise Mistake(f"line {number}: {label[1]} stands twice")
            program.labels[label[1]] = len(program.lines)
            waiting.append(label[1])
            code = code[label.end() :]
        operation, _, operand = code.strip().partition(" ")
        operand = operand.strip()
        if not operation:
            if line.startswith(";"):
                program.heads.setdefault(len(program.lines), []).append(comment.strip())
        elif operation == ".at":
            address = value_of(operand, program.names)
        elif operation == ".let":
            name, _, meaning = operand.partition("=")
            program.names[name.strip()] = value_of(meaning, program.names)
        elif operation == ".var":
            name, *size = operand.split()
            if name in program.names:
                raise Mistake(f"line {number}: {name} stands twice")
            program.names[name] = address
            address = within(address + (int(size[0]) if size else 1), MEMORY_BYTES + 1, name)
        else:
            program.lines.append(Line(number, tuple(waiting), operation, operand, comment.strip()))
            waiting = []
    return program


def word_of(line: Line, program: Program) -> int:
    """Return the word of an instruction."""
    name, operand = line.operation, line.operand
    if name == "call" or name in CONDITIONS or name in INVERTED:
        if name != "ret" and operand not in program.labels:
            raise Mistake(f"there is no place {operand}")
        condition = CONDITIONS.index("jmp" if name == "call" else INVERTED.get(name, name))
        target = 0 if name == "ret" else program.labels[operand]
        return 1 << 15 | condition << 12 | (name in INVERTED) << 11 | (name == "call") << 10 | target
    if name == "tax":
        return OPERATIONS.index("ldx") << 11 | within(value_of(operand, program.names), 2, operand) << 8
    if name not in OPERATIONS:
        raise Mistake(f"there is no instruction {name}")
    code = OPERATIONS.index(name) << 11
    if name == "in":
        return code | PORTS.index(operand)
    *actions, last = operand.split() or [""]
    mode = MODES.get(last, DIRECT) << 9
    if name in ACTIONS:
        chosen = actions if mode else operand.split()
        return code | mode | sum(1 << ACTIONS[name].index(action) for action in chosen)
    if name in ("put", "taken") or mode:
        return code | mode
    if operand.startswith("#"):
        return code | IMMEDIATE << 9 | within(value_of(operand[1:], program.names), 256, operand)
    address = within(value_of(operand, program.names), MEMORY_BYTES, operand)
    return code | (IMMEDIATE << 9 if name == "ldx" else 0) | address


def assemble(text: str) -> Program:
    """Return the program with its words.

    >>> [f"{word:04X}" for word in assemble("again: ld #7\\n jmp again").words]
    ['0207', '8000']
    """
    program = parse(text)
    for line in program.lines:
        try:
            program.words.append(word_of(line, program))
        except (Mistake, ValueError) as error:
            raise Mistake(f"line {line.number}: {line.operation} {line.operand}: {error}") from error
    if len(program.words) > PROGRAM_WORDS:
        raise Mistake(f"the program has {len(program.words)} instructions, and at most {PROGRAM_WORDS} fit")
    return program


def package(program: Program) -> str:
    """Return small_program_pkg.vhd."""
    words = program.words + [0] * (PROGRAM_WORDS - len(program.words))
    rows = [", ".join(f'x"{word:04X}"' for word in words[at : at + 8]) for at in range(0, len(words), 8)]
    lines = [
        "-- SPDX-License-Identifier: BSD-3-Clause",
        f"-- The program of the small engine. {NOTE}",
        "",
        "library ieee;",
        "  use ieee.std_logic_1164.all;",
        "",
        "use work.small_instruction_pkg.all;",
        "",
        "package small_program_pkg is",
        "",
        *(f"  constant small_{name} : natural := {program.names[name]};" for name in TOLD),
        "",
        f"  constant small_program : small_program_t(0 to {PROGRAM_WORDS - 1}) := (",
        ",\n".join(f"    {row}" for row in rows) + ");",
        "",
        "end package;",
    ]
    return "\n".join(lines) + "\n"


def listing(program: Program) -> str:
    """Return docs/gateware/small-program.md."""
    lines = [
        f"<!-- {NOTE} -->",
        "# The program of the small engine, as assembled",
        "",
        f"{len(program.words)} of {PROGRAM_WORDS} instructions. Read [framed_small](framed_small.md) first.",
        "Each line has the place and the word in hexadecimal, the label, the instruction and its comment.",
        "",
        "```",
    ]
    for place, (line, word) in enumerate(zip(program.lines, program.words, strict=True)):
        lines += ["", *(f"; {text}" for text in program.heads.get(place, ()) if text)] * bool(
            program.heads.get(place)
        )
        label = f"{line.labels[-1]}:" if line.labels else ""
        text = f"{place:03X} {word:04X}  {label:15}{line.operation} {line.operand}"
        lines.append(f"{text:50}{'; ' + line.comment if line.comment else ''}".rstrip())
    return "\n".join([*lines, "```"]) + "\n"


def main() -> int:
    """Write the stale files. Return 1 if a file is stale and nothing may be written."""
    try:
        program = assemble(SOURCE.read_text(encoding="utf-8"))
    except Mistake as mistake:
        print(f"{SOURCE.name}: {mistake}", file=sys.stderr)
        return 2
    made = {PACKAGE: package(program), LISTING: listing(program)}
    stale = [
        path for path, text in made.items() if not path.exists() or path.read_text(encoding="utf-8") != text
    ]
    for path in stale:
        print(f"{path.relative_to(ROOT)} is stale")
        if "--check" not in sys.argv[1:]:
            path.write_text(made[path], encoding="utf-8")
    return 1 if stale and "--check" in sys.argv[1:] else 0


if __name__ == "__main__":
    raise SystemExit(main())
