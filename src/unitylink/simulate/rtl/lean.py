# SPDX-License-Identifier: BSD-3-Clause
"""Make a netlist cheaper to simulate, without changing what it does.

GHDL divides records and vectors into bits and joins them again. On an FPGA these are only wires. In compiled
code, each step costs instructions in every clock.
"""

from __future__ import annotations

import re
from typing import Union

_ASSIGN = re.compile(r"^  assign (\w+) = (.+?);(.*)$", re.MULTILINE)
# What GHDL prints for a signal of a generate statement that an instance drives.
_ITSELF = re.compile(r"^  assign (\w+) = \1;.*\n", re.MULTILINE)
_CONSTANT = re.compile(r"^  localparam \[(\d+):0\] (\w+) = (.+?);", re.MULTILINE)
_SAME = re.compile(r"^  always @\*\n    (\w+) = (\w+); // \(isignal\)$", re.MULTILINE)
_REGISTER = re.compile(r"^  always @\((posedge \w+)\)\n    (\w+) <= (\w+);", re.MULTILINE)
# A memory is none of these. It has a second range after its name.
_WIDTH = re.compile(r"^[ (]*(?:input|output|wire|reg) +(?:\[(\d+):0\] +)?(\w+)(?=[;,)])", re.MULTILINE)
_NAME = re.compile(r"(?<![\w'$])[A-Za-z_]\w*")
_LITERAL = re.compile(r"\d+'b([01Xx]+)")
_PART = re.compile(r"(\w+)\[(\d+)(?::(\d+))?\]")
_JOINED = re.compile(r"\{([\w', ]+)\}")
_CHOICE = re.compile(r"(\w+) \? ([\w']+) : ([\w']+)")
_PAIR = re.compile(r"([\w']+) ([&|^]) ([\w']+)")
_NOT = re.compile(r"~(\w+)")
_NUMBER_BITS = 64
_WORTH = 4  # from so many bits on, one operation for all of them is less work
_CHOICES_MOST = 8  # the most nested choices of what a register takes

Bit = tuple[str, int]  # (wire, index of its bit)
Term = tuple[str, Union[int, None], bool]  # (wire, index of its bit or None, value of the bit)
Bits = tuple[str, ...]  # wires of one bit, and constants, with the lowest first


def lean(netlist: str) -> str:
    """Return a netlist that does the same as `netlist` in every clock, with fewer operations."""
    end = "endmodule"
    return end.join(_Module(text).lean() for text in netlist.split(end))


class _Module:
    """A module as GHDL prints it. Each wire has a name, and a definition with one operation."""

    def __init__(self, text: str) -> None:
        self._text = text = _ITSELF.sub("", text)
        self._width = {name: int(high or 0) + 1 for high, name in _WIDTH.findall(text)}
        self._is: dict[str, str] = {name: definition for name, definition, _ in _ASSIGN.findall(text)}
        self._is |= dict(_SAME.findall(text))
        for high, name, value in _CONSTANT.findall(text):
            self._width[name], self._is[name] = int(high) + 1, value
        self._name_once()
        self._parts: dict[tuple[str, int, int], str] = {}
        self._wholes: dict[Bits, str | None] = {}
        self._choices: list[tuple[str, str]] = []  # new wires: (declaration, definition)

    def lean(self) -> str:
        text = _ASSIGN.sub(lambda one: f"  assign {one[1]} = {self._less(one[1])};{one[3]}", self._text)
        text = _REGISTER.sub(self._held, text)
        if self._choices:
            head, found, rest = text.partition(");\n")
            declared = "".join(f"  wire {name};\n" for name, _ in self._choices)
            defined = "".join(f"  assign {choice};\n" for _, choice in self._choices)
            text = f"{head}{found}{declared}{rest}{defined}"
        return text

    def _less(self, name: str) -> str:
        definition = self._is[name]
        try:
            if part := _PART.fullmatch(definition):
                return self._part(part[1], int(part[2]), int(part[3] or part[2]))
            if joined := _JOINED.fullmatch(definition):
                bits = tuple(reversed(joined[1].split(", ")))
                if _WORTH <= len(bits) == self._width.get(name):
                    return self._whole(bits) or definition
        except RecursionError:  # there are hundreds of nested choices; unchanged, the module is also correct
            pass
        return definition

    def _name_once(self) -> None:
        """If wires are made in the same way, let them all be names of one of them."""
        named = True
        while named:
            first: dict[tuple[str, int], str] = {}
            named = False
            for name, definition in self._is.items():
                if definition in self._width or name not in self._width:
                    continue
                made = _NAME.sub(lambda one: self._origin(one[0]), definition)
                other = first.setdefault((made, self._width[name]), name)
                if other != name:
                    self._is[name], named = other, True

    def _origin(self, name: str) -> str:
        """Return the wire of which `name` is only another name."""
        while (same := self._is.get(name)) and same in self._width:
            name = same
        return name

    # A part of joined bits, like a field of a record, is one of the parts that were joined.

    def _part(self, name: str, high: int, low: int) -> str:
        key = (name, high, low)
        if key not in self._parts:
            self._parts[key] = _sliced(*key)  # the result for a loop that leads back here
            self._parts[key] = self._new_part(name, high, low)
        return self._parts[key]

    def _new_part(self, name: str, high: int, low: int) -> str:
        name = self._origin(name)
        definition = self._is.get(name, name)
        if literal := _LITERAL.fullmatch(definition):
            digits = literal[1][::-1][low : high + 1][::-1]
            return f"{len(digits)}'b{digits}"
        if (low, high + 1) == (0, self._width.get(name)):
            return name
        if (part := _PART.fullmatch(definition)) and part[1] in self._width:
            below = int(part[3] or part[2])
            return self._part(part[1], high + below, low + below)
        if (joined := _JOINED.fullmatch(definition)) and name in self._width:
            return self._part_of_joined(joined[1].split(", "), high, low)
        if (choice := _CHOICE.fullmatch(definition)) and self._width.get(name, 0) > _NUMBER_BITS:
            fresh = f"{name}__{high}_{low}"  # such a name cannot exist in VHDL
            self._width[fresh] = high + 1 - low
            either, other = self._part(choice[2], high, low), self._part(choice[3], high, low)
            self._is[fresh] = f"{choice[1]} ? {either} : {other}"
            self._choices.append((f"[{high - low}:0] {fresh}", f"{fresh} = {self._is[fresh]}"))
            return fresh
        return _sliced(name, high, low)

    def _part_of_joined(self, joined: list[str], high: int, low: int) -> str:
        found: list[str] = []
        below = 0
        for name in reversed(joined):
            literal = _LITERAL.fullmatch(name)
            above = below + (len(literal[1]) if literal else self._width[name])
            if below <= high and low < above:
                found.append(self._part(name, min(high, above - 1) - below, max(low, below) - below))
            below = above
        return found[0] if len(found) == 1 else "{" + ", ".join(reversed(found)) + "}"

    # The same operation on each bit is one operation on vectors.

    def _whole(self, bits: Bits) -> str | None:
        """Return an expression for all of `bits` together, or None if they are not made in the same way."""
        if bits not in self._wholes:
            self._wholes[bits] = None  # the result for a loop that leads back here
            self._wholes[bits] = self._runs(bits) or self._operation(bits)
        return self._wholes[bits]

    def _bit(self, name: str) -> Bit | None:
        part = _PART.fullmatch(self._is.get(self._origin(name), ""))
        return (self._origin(part[1]), int(part[2])) if part and part[3] is None else None

    def _runs(self, bits: Bits) -> str | None:
        """Return `bits` as a few pieces: parts of vectors, a repeated wire, or constants."""
        pieces: list[str] = []
        at = 0
        while at < len(bits):
            first, count = bits[at], 1
            rest = bits[at + 1 :]
            if literal := _LITERAL.fullmatch(first):
                digits = literal[1]
                for name in rest:
                    if (literal := _LITERAL.fullmatch(name)) is None:
                        break
                    digits = literal[1] + digits
                count = len(digits)
                pieces.append(f"{count}'b{digits}")
            elif rest[:1] == (first,):
                count += next((i for i, name in enumerate(rest) if name != first), len(rest))
                pieces.append("{" + f"{count}{{{first}}}" + "}")
            elif (place := self._bit(first)) is not None:
                name, low = place
                while at + count < len(bits) and self._bit(bits[at + count]) == (name, low + count):
                    count += 1
                pieces.append(self._part(name, low + count - 1, low))
            else:
                return None
            if len(pieces) > max(1, len(bits) // _WORTH):
                return None
            at += count
        return pieces[0] if len(pieces) == 1 else "{" + ", ".join(reversed(pieces)) + "}"

    def _operation(self, bits: Bits) -> str | None:
        """Return the operation that makes each of `bits`, as one operation on vectors."""
        made = [self._is.get(self._origin(name), "") for name in bits]
        if of_one := _taken_apart(_NOT, made):
            whole = self._whole(of_one[0])
            return whole and f"(~{whole})"
        if of_two := _taken_apart(_PAIR, made):
            left, signs, right = of_two
            if place := self._place(bits):
                return place
            whole, other = self._whole(left), self._whole(right)
            return f"({whole} {signs[0]} {other})" if whole and other and len(set(signs)) == 1 else None
        if of_three := _taken_apart(_CHOICE, made):
            return self._choice(*of_three)
        return None

    def _choice(self, conditions: Bits, chosen: Bits, otherwise: Bits) -> str | None:
        condition, whole, other = conditions[0], self._whole(chosen), self._whole(otherwise)
        if whole is None or other is None:
            return None
        if len(set(conditions)) == 1:
            return f"({condition} ? {whole} : {other})"
        if (each := self._whole(conditions)) is None:
            return None
        if set(chosen) == {"1'b1"}:
            return f"({each} | {other})"
        if set(chosen) == {"1'b0"}:
            return f"(~{each} & {other})"
        return f"({each} & {whole} | ~{each} & {other})"

    def _place(self, bits: Bits) -> str | None:
        """Return a shift of one bit, if each of `bits` is set exactly when a number equals its place."""
        terms = [self._terms(name) for name in bits]
        common = frozenset.intersection(*terms)
        numbers = {name for name, _, _ in terms[0] - common}
        count = (len(bits) - 1).bit_length()
        if len(numbers) != 1:
            return None
        number = numbers.pop()
        for at, found in enumerate(terms):
            if found - common != {(number, bit, bool(at >> bit & 1)) for bit in range(count)}:
                return None
        moved = f"({len(bits)}'b1 << {self._part(number, count - 1, 0)})"
        conditions = " & ".join(
            f"{'' if high else '~'}{name if bit is None else self._part(name, bit, bit)}"
            for name, bit, high in sorted(common, key=str)
        )
        return f"({conditions} ? {moved} : {len(bits)}'b0)" if common else moved

    def _terms(self, name: str) -> frozenset[Term]:
        """Return the conditions that must all hold for `name` to be 1."""
        name = self._origin(name)
        definition = self._is.get(name, "")
        if (pair := _PAIR.fullmatch(definition)) and pair[2] == "&":
            return self._terms(pair[1]) | self._terms(pair[3])
        if opposite := _NOT.fullmatch(definition):
            terms = self._terms(opposite[1])
            if len(terms) == 1:
                ((name, bit, high),) = terms
                return frozenset({(name, bit, not high)})
        place = self._bit(name)
        return frozenset({(*place, True) if place else (name, None, True)})

    # A wide register that keeps its value is left alone. It does not take its own value.

    def _held(self, register: re.Match[str]) -> str:
        edge, name, value = register.groups()
        if self._width.get(name, 0) <= _NUMBER_BITS:
            return register[0]
        return f"  always @({edge})\n    {self._taking(name, value, _CHOICES_MOST) or ';'}"

    def _taking(self, register: str, value: str, choices: int) -> str:
        """Return the statement with which `register` takes `value`.

        Return "" if the register keeps its value.
        """
        value = self._origin(value)
        if value == register:
            return ""
        choice = _CHOICE.fullmatch(self._is.get(value, ""))
        if choice is None or choices == 0:
            return f"{register} <= {value};"
        chosen = self._taking(register, choice[2], choices - 1)
        other = self._taking(register, choice[3], choices - 1)
        if not chosen:
            return other and f"if (!{choice[1]}) begin {other} end"
        return f"if ({choice[1]}) begin {chosen} end" + (f" else begin {other} end" if other else "")


def _taken_apart(pattern: re.Pattern[str], definitions: list[str]) -> list[Bits] | None:
    """Match `pattern` against all `definitions`. Return the matches of each of its groups.

    Return None if a definition has another form.
    """
    matches = [match for text in definitions if (match := pattern.fullmatch(text))]
    if len(matches) < len(definitions):
        return None
    return [tuple(match[group] for match in matches) for group in range(1, pattern.groups + 1)]


def _sliced(name: str, high: int, low: int) -> str:
    return f"{name}[{high}:{low}]" if high > low else f"{name}[{high}]"
