# SPDX-License-Identifier: BSD-3-Clause
"""Assemble the program of the small engine (gateware/small/program.asm).

python tools/small/assemble.py            write the VHDL package, the listing, and the text of each place
python tools/small/assemble.py --check    write nothing; exit 1 if one of them is stale
"""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from unitylink import protocol

ROOT = Path(__file__).resolve().parents[2]
SOURCE = ROOT / "gateware" / "small" / "program.asm"
PACKAGE = ROOT / "gateware" / "small" / "small_program_pkg.vhd"
LISTING = ROOT / "docs" / "gateware" / "small-program.md"
NOTE = "Generated from gateware/small/program.asm by tools/small/assemble.py; edit there."

# Both programs come from the one source. The name of each is what `.if` asks for.
PROGRAM_WORDS = {"plain": 1024, "publishing": 2048}
MEMORY_BYTES = 1024
DIRECT_BYTES = 512  # an instruction reaches the bytes above only by X
PAGE_BYTES = 256

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
    "note",
)
CONDITIONS = ("jmp", "jz", "jc", "jpiece", "jsending", "jaccess", "jalert", "call")
INVERTED = {"ret": "jmp", "jnz": "jz", "jnc": "jc", "jnalert": "jalert", "jnpiece": "jpiece"}
PORTS = ("data", "check", "status", "x", "wants", "place")
GOES_ON = {"data": 1 << 7, "check": 1 << 8}  # these ports go to their next byte
# Instructions that have the code of another one, and a mode that the other one has no use for.
SHARED = {"get": ("in", 3), "give": ("in", 1), "follow": ("clr", 1), "set": ("st", 1)}
ACTIONS = {
    "out": ("shift_data", "shift_address", "read", "write", "time", "crc", "crc_clear", "send", "free"),
    "tell": ("turn_seen", "overrun_seen", "start", "trip", "renew", "arm", "counted", "alive", "check_next"),
    "note": (
        "piece_taken", "strobe_taken", "events_taken", "enabled", "publishing", "due", "hold", "again",
        "publish",
    ),
}  # fmt: skip
DIRECT, IMMEDIATE = 0, 1
MODES = {"[x]": 2, "[x+]": 3}

# gateware/small/small_memory_pkg.vhd and framed_small.vhd need these values.
TOLD = (
    "description", "a_bytes", "d_bytes", "window", "window_mask", "post_size", "write_bytes", "reply", "ring",
    "request_max", "reply_max", "credit", "cache_bytes", "window_max", "groups", "group_bytes", "groups_max",
    "last_group", "address_bytes_max", "rate_bytes",
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
    room: int = PROGRAM_WORDS["plain"]


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


def chosen_lines(text: str, name: str) -> Iterator[tuple[int, str]]:
    """Yield the lines that the program `name` has, with their numbers.

    >>> list(chosen_lines("a\\n.if publishing\\nb\\n.end\\nc", "plain"))
    [(1, 'a'), (5, 'c')]
    """
    inside, left_out = 0, False
    for number, line in enumerate(text.splitlines(), 1):
        word, _, asked = line.partition(";")[0].strip().partition(" ")
        if word == ".if":
            if inside or asked not in PROGRAM_WORDS:
                raise Mistake(
                    f"line {number}: .if {asked}: there is {' and '.join(PROGRAM_WORDS)}, one at a time"
                )
            inside, left_out = number, asked != name
        elif word == ".end":
            if not inside:
                raise Mistake(f"line {number}: .end: there is no .if before it")
            inside, left_out = 0, False
        elif not left_out:
            yield number, line
    if inside:
        raise Mistake(f"line {inside}: .if: there is no .end behind it")


def parse(text: str, name: str = "plain") -> Program:
    """Take the source of a program apart.

    >>> parse(".var there\\nhere: ld there ; why").lines
    [Line(number=2, labels=('here',), operation='ld', operand='there', comment='why')]
    """
    program = Program(names=constants(), room=PROGRAM_WORDS[name])
    address = 0
    waiting: list[str] = []  # labels of the next instruction
    for number, line in chosen_lines(text, name):
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
            given, _, meaning = operand.partition("=")
            program.names[given.strip()] = value_of(meaning, program.names)
        elif operation == ".var":
            given, *size = operand.split()
            if given in program.names:
                raise Mistake(f"line {number}: {given} stands twice")
            program.names[given] = address
            address = within(address + (int(size[0]) if size else 1), MEMORY_BYTES + 1, given)
        else:
            program.lines.append(Line(number, tuple(waiting), operation, operand, comment.strip()))
            waiting = []
    return program


def word_of(line: Line, program: Program) -> int:
    """Return the word of an instruction."""
    name, operand = line.operation, line.operand
    if name in CONDITIONS or name in INVERTED:
        if name != "ret" and operand not in program.labels:
            raise Mistake(f"there is no place {operand}")
        condition = CONDITIONS.index(INVERTED.get(name, name))
        target = 0 if name == "ret" else program.labels[operand]
        return 1 << 15 | condition << 12 | (name in INVERTED) << 11 | target
    if name in ("ldx", "tax"):  # bit 10 is the highest of the address
        most = MEMORY_BYTES if name == "ldx" else MEMORY_BYTES // 256
        address = within(value_of(operand, program.names), most, operand) << (0 if name == "ldx" else 8)
        high, low = divmod(address, DIRECT_BYTES)
        return OPERATIONS.index("ldx") << 11 | high << 10 | (name == "ldx") << 9 | low
    if name in SHARED:
        kin, shared_mode = SHARED[name]
        most = PAGE_BYTES if name == "follow" else DIRECT_BYTES
        address = within(value_of(operand, program.names), most, operand)
        return OPERATIONS.index(kin) << 11 | shared_mode << 9 | address
    if name not in OPERATIONS:
        raise Mistake(f"there is no instruction {name}")
    code = OPERATIONS.index(name) << 11
    if name == "in":
        return code | GOES_ON.get(operand, 0) | PORTS.index(operand)
    *actions, last = operand.split() or [""]
    mode = MODES.get(last, DIRECT) << 9
    if name in ACTIONS:
        chosen = actions if mode else operand.split()
        return code | mode | sum(1 << ACTIONS[name].index(action) for action in chosen)
    if name == "put" and not operand:
        return code | IMMEDIATE << 9
    if mode:
        return code | mode
    if operand.startswith("#"):
        return code | IMMEDIATE << 9 | within(value_of(operand[1:], program.names), 256, operand)
    return code | within(value_of(operand, program.names), DIRECT_BYTES, operand)


def assemble(text: str, name: str = "plain") -> Program:
    """Return the program with its words.

    >>> [f"{word:04X}" for word in assemble("again: ld #7\\n jmp again").words]
    ['0207', '8000']
    """
    program = parse(text, name)
    for line in program.lines:
        try:
            program.words.append(word_of(line, program))
        except (Mistake, ValueError) as error:
            raise Mistake(f"line {line.number}: {line.operation} {line.operand}: {error}") from error
    if len(program.words) > program.room:
        raise Mistake(f"the program has {len(program.words)} instructions, and at most {program.room} fit")
    return program


def assembled(text: str) -> dict[str, Program]:
    """Return each program of the source by its name."""
    return {name: assemble(text, name) for name in PROGRAM_WORDS}


def rows(program: Program) -> Iterator[str]:
    """Yield the words as the lines of a VHDL aggregate."""
    for at in range(0, len(program.words), 12):
        yield "    " + ", ".join(f'x"{word:04X}"' for word in program.words[at : at + 12]) + ","
    yield '    others => x"0000");'


def package(programs: Mapping[str, Program]) -> str:
    """Return small_program_pkg.vhd."""
    names = programs["publishing"].names
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
        *(f"  constant small_{name} : natural := {names[name]};" for name in TOLD),
    ]
    for name, program in programs.items():
        lines += [
            "",
            f"  constant {name}_program : small_program_t(0 to {program.room - 1}) := (",
            *rows(program),
        ]
    lines += ["", "end package;"]
    return "\n".join(lines) + "\n"


def listing(programs: Mapping[str, Program]) -> str:
    """Return docs/gateware/small-program.md: the longer program, which has every line of the other."""
    plain, program = programs["plain"], programs["publishing"]
    shared = {line.number for line in plain.lines}
    lines = [
        f"<!-- {NOTE} -->",
        "# The program of the small engine, as assembled",
        "",
        f"The program with publishing has {len(program.words)} of {program.room} instructions: "
        f"{free(program)} % are free.",
        f"The one without publishing has {len(plain.words)} of {plain.room}: {free(plain)} % are free.",
        "It lacks the lines with a `+`, so its places are lower.",
        "",
        "Read [framed_small](framed_small.md) first.",
        "Each line has the place and the word in hexadecimal, the label, the instruction and its comment.",
        "",
        "```",
    ]
    for place, (line, word) in enumerate(zip(program.lines, program.words, strict=True)):
        lines += ["", *(f"; {text}" for text in program.heads.get(place, ()) if text)] * bool(
            program.heads.get(place)
        )
        label = f"{line.labels[-1]}:" if line.labels else ""
        mark = " " if line.number in shared else "+"
        text = f"{place:03X} {word:04X} {mark}{label:15}{line.operation} {line.operand}"
        lines.append(f"{text:50}{'; ' + line.comment if line.comment else ''}".rstrip())
    return "\n".join([*lines, "```"]) + "\n"


def free(program: Program) -> int:
    """Return how many percent of the room of the program are free."""
    return 100 * (program.room - len(program.words)) // program.room


def places(program: Program) -> str:
    """Return the text of each place, as a filter of GTKWave: the place, then what it shows in its stead."""
    lines = [f"# {NOTE}"]
    for place, line in enumerate(program.lines):
        label = f"{line.labels[-1]}:" if line.labels else ""
        text = f"{place:03X} {label:16}{line.operation} {line.operand}"
        lines.append(f"{text:50}{'; ' + line.comment if line.comment else ''}".rstrip())
    return "\n".join(lines) + "\n"


def main() -> int:
    """Write the stale files. Return 1 if a file is stale and nothing may be written."""
    try:
        programs = assembled(SOURCE.read_text(encoding="utf-8"))
    except Mistake as mistake:
        print(f"{SOURCE.name}: {mistake}", file=sys.stderr)
        return 2
    made = {PACKAGE: package(programs), LISTING: listing(programs)}
    made |= {PACKAGE.with_name(f"{name}_program.txt"): places(program) for name, program in programs.items()}
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
