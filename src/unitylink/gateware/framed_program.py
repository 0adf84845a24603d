# SPDX-License-Identifier: BSD-3-Clause
"""The program of the framed engine as text: what each instruction does, in the words of its VHDL."""

from __future__ import annotations

import re
import tempfile
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from unitylink import protocol
from unitylink.errors import ToolError

from .ghdl import Ghdl
from .sources import gateware_folder, gateware_sources

_LISTER = """
library ieee;
  use ieee.std_logic_1164.all;
use std.textio.all;
use work.frame_layout_pkg.all;
use work.frame_assembler_pkg.all;
use work.frame_program_pkg.all;
use work.settings_pkg.all;

entity framed_program_lister is
end entity;

architecture bench of framed_program_lister is
begin
  process is
    constant program : frame_program_t := frame_program_for(frame_settings_of({settings}));
    variable text    : line;
  begin
    for place in program'range loop
      write(text, "word " & to_string(program(place)));
      writeline(output, text);
    end loop;
    report "framed_program_lister: passed";
    wait;
  end process;
end architecture;
"""
# The package tells no labels, and its text is in the digests of the proofs. So a copy of it tells them.
_BEFORE = "    while size < p.free loop\n"
_TELLER = """
    report "free " & integer'image(p.free);
    for place in p.taken'range loop
      assert not p.taken(place) report "table " & integer'image(place) severity note;
    end loop;
    for name in label_t loop
      report "label " & label_t'image(name) & " " & integer'image(p.labels(name));
    end loop;
"""
_PACKAGE = "frame_program_pkg"
_FIELD = re.compile(r"^  subtype (\w+)_f\s+is natural range (\d+) downto (\d+);", re.MULTILINE)
_CONSTANT = re.compile(
    r'^  constant (\w+)\s*: [^;]*?:= (?:"([01]+)"|16#(\w+)#|(\d+));(?: *-- (.*(?:\n +-- .*)*))?', re.MULTILINE
)
# Prefix of the names -> the field of an instruction that has their values.
_FIELD_OF = {"from": "source"} | {name: name for name in ("say", "take", "data", "store", "manage", "times")}
# Conditions that compare `number`.
_COMPARES = ("low", "above", "pointer", "left_not", "not_plain")
_BITS = ("flag", "mark", "shape")
_SENDS = ("say_kind", "say_byte", "say_kept", "say_last")  # not the others: they only end or begin a payload
_TIMES = {"times_size": "`size` times", "times_rest": "8 - `size` times"}
FIELDS = {
    "say": "sends",
    "source": "what it sends",
    "take": "takes a byte of the frame",
    "data": "the new value of `data`",
    "store": "stores in the memory",
    "manage": "asks the subscription manager",
    "special": "does besides",
    "action": "actions of a bit each",
    "times": "is executed several times",
    "condition": "conditions of a jump",
}
"""The fields of an instruction that have names for their values, in the order in which they are said."""
_FIRST_ACTION = 58  # the lowest bit of an instruction that is an action of its own


@dataclass(frozen=True)
class Name:
    """A constant of a package of gateware/framed, with the comment behind it."""

    name: str
    value: int
    about: str


def names_in(package: str) -> list[Name]:
    """Return the numbers and bit patterns that a package of gateware/framed defines.

    >>> next(one for one in names_in("frame_instruction_pkg") if one.name == "take_many")
    Name(name='take_many', value=4, about='nowhere; takes `count` bytes at once')
    """
    text = (gateware_folder() / "framed" / f"{package}.vhd").read_text(encoding="ascii")
    return [
        Name(
            name, int(bits or hexadecimal or decimal, 2 if bits else 16 if hexadecimal else 10), _plain(about)
        )
        for name, bits, hexadecimal, decimal, about in _CONSTANT.findall(text)
    ]


def _plain(comment: str) -> str:
    return " ".join(comment.replace("-- ", " ").split())


@cache
def instruction_set() -> Mapping[str, Mapping[int, Name]]:
    """Return the names of the values of each field. Those of "action" are bits."""
    sets: dict[str, dict[int, Name]] = {}
    for one in names_in("frame_instruction_pkg"):
        prefix = one.name.partition("_")[0]
        if prefix in ("do", "if"):
            field = "action" if one.value >= _FIRST_ACTION else "condition"
        else:
            field = _FIELD_OF.get(prefix, "special")
        if one.name not in ("never", "status_of_data"):
            sets.setdefault(field, {})[one.value] = one
    return sets


@cache
def _field_places() -> Mapping[str, tuple[int, int]]:
    text = (gateware_folder() / "framed" / "frame_instruction_pkg.vhd").read_text(encoding="ascii")
    return {name: (int(low), (2 << int(high) - int(low)) - 1) for name, high, low in _FIELD.findall(text)}


def _field(word: int, name: str) -> int:
    low, mask = _field_places()[name]
    return word >> low & mask


def _said(word: int, field: str) -> str:
    """Return the name of the value that a field has, or "" if there is none."""
    named = instruction_set()[field].get(_field(word, field))
    return named.name if named else ""


def _actions(word: int) -> list[str]:
    return [one.name for bit, one in sorted(instruction_set()["action"].items()) if word >> bit & 1]


@cache
def _operands() -> Mapping[str, Mapping[int, str]]:
    """Return the names of words of the memory, of flags, marks and bits of a shape, by their values."""
    found: dict[str, dict[int, str]] = {"word": {}, "flag": {}, "mark": {}, "shape": {}}
    for one in names_in("frame_layout_pkg"):
        if one.name.partition("_")[0] in found:
            found[one.name.partition("_")[0]].setdefault(one.value, one.name)
    for name in dir(protocol):
        if name.startswith("CONTROL_") and not name.startswith("CONTROL_VALUE_"):
            found["word"].setdefault(getattr(protocol, name), name.lower())
    return found


def _condition(word: int) -> str:
    """Return the condition of a jump: flags, marks or bits of a shape, or its name and a number."""
    condition, number = _said(word, "condition").removeprefix("if_"), _field(word, "number")
    if condition in _BITS:
        return _bits(condition, number)
    return f"{condition} {number:02X}" if condition in _COMPARES else condition


def _operand(word: int) -> str:
    """Return the number with which an instruction does what it does: it sends it, or it is an address."""
    number = _field(word, "number")
    special, actions = _said(word, "special"), _actions(word)
    if found := next((kind for kind in _BITS if special in (f"set_{kind}s", f"clear_{kind}s")), ""):
        return _bits(found, number)
    if _said(word, "say") in _SENDS and _said(word, "source") in ("from_number", "from_other"):
        return f"{number:02X}"
    if "do_place" in actions:
        return f"{number:02X}"
    compares = _said(word, "condition").removeprefix("if_") in (*_BITS, *_COMPARES)
    if "do_pointer" in actions or compares or not (number or _field(word, "store")):
        return ""
    return _operands()["word"].get(number, f"{number:02X}")


def _bits(kind: str, number: int) -> str:
    return " + ".join(name for bit, name in _operands()[kind].items() if number & bit)


def _times(word: int) -> str:
    times = _field(word, "times")
    return _TIMES.get(_said(word, "times"), f"{times + 1} times" if times else "")


def _deed(word: int) -> str:
    """Return what an instruction does in its clock, without where it leads."""
    says = _said(word, "say") if _field(word, "say") else ""
    source = _said(word, "source") if _field(word, "source") else ""
    parts = [f"{says} {source}".strip()]
    parts += [
        _said(word, field) for field in ("take", "data", "store", "manage", "special") if _field(word, field)
    ]
    parts += [name for name in _actions(word) if name not in ("if_not", "do_call")]
    text = ", ".join(filter(None, parts))
    if "do_point" in _actions(word):
        text += f" {_field(word, 'far') << 9 | _field(word, 'target'):03X}"
    return ", ".join(filter(None, (f"{text} {_operand(word)}".strip(), _times(word))))


@dataclass(frozen=True)
class Program:
    """The words of a program, and the names of its places."""

    words: tuple[int, ...]
    labels: Mapping[int, str]

    def text_of(self, place: int) -> str:
        """Return what the instruction at a place does, and where it leads if not to the next place."""
        word = self.words[place]
        actions, condition = _actions(word), _condition(word)
        target, following = _field(word, "target"), _field(word, "following")
        parts = [_deed(word)]
        if condition:
            unless = "unless" if "if_not" in actions else "if"
            parts.append(f"{unless} {condition}: {self._named(target)}")
        if "do_call" in actions:
            parts.append(f"do_call {self._named(following)}")
            following = target
        if following != place + 1 and not {"do_begin", "do_dispatch", "do_return"} & set(actions):
            parts.append(f"then {self._named(following)}")
        return "; ".join(filter(None, parts))

    def lines(self) -> list[str]:
        """Return a line for each place: the place, its name, and its instruction."""
        return [
            f"{place:03X} {f'{self.labels[place]}:' if place in self.labels else '':23}{self.text_of(place)}"
            for place in range(len(self.words))
        ]

    def _named(self, place: int) -> str:
        return self.labels.get(place, f"{place:03X}")


def program_of(settings: str) -> Program:
    """Return the program that a core has with `settings`, which are VHDL, as GHDL assembles it.

    Raises ToolError.

        program_of("core_settings(groups => 4)").lines()
    """
    with tempfile.TemporaryDirectory(prefix="unitylink-program-") as folder:
        lister, copy = (Path(folder) / f"{name}.vhd" for name in ("framed_program_lister", _PACKAGE))
        lister.write_text(_LISTER.format(settings=settings), encoding="ascii")
        text = (gateware_folder() / "framed" / f"{_PACKAGE}.vhd").read_text(encoding="ascii")
        if _BEFORE not in text:
            raise ToolError(f"{_PACKAGE}.vhd tells no labels: its end is not what framed_program.py expects")
        copy.write_text(text.replace(_BEFORE, _TELLER + _BEFORE), encoding="ascii")
        others = [path for path in gateware_sources() if path.stem != _PACKAGE]
        said = Ghdl(Path(folder), [*others, copy, lister]).run("framed_program_lister")
    words = [int(bits, 2) for bits in re.findall(r"^word ([01]+)$", said, re.MULTILINE)]
    labels = {int(place): name for name, place in re.findall(r"label (\w+) ([1-9]\d*)$", said, re.MULTILINE)}
    tables = {int(place) for place in re.findall(r"table (\d+)$", said, re.MULTILINE)}
    free = int(re.findall(r"free (\d+)$", said, re.MULTILINE)[0])
    named = labels | {place: name for place, name in _tables() if place in tables}
    return Program(tuple(words[:free]), named)


def _tables() -> Iterator[tuple[int, str]]:
    """Yield the place and the name of each entry of the tables at which a frame is dispatched."""
    first = {
        one.name: one.value for one in names_in("frame_assembler_pkg") if one.name.startswith("first_of_")
    }
    for one in names_in("frame_pkg"):
        yield first["first_of_entries"] + one.value, one.name
    for name in dir(protocol):
        if name.startswith("REQUEST_KIND_"):
            kind, number = name.removeprefix("REQUEST_KIND_").lower(), getattr(protocol, name) % 16
            yield first["first_of_entries"] + number, f"entry_{kind}"
            yield first["first_of_forms"] + number, f"form_{kind}"
            yield first["first_of_checks"] + number, f"check_{kind}"
