# SPDX-License-Identifier: BSD-3-Clause
"""Read expressions: numbers with units, strings, names, `+ - * / % << >> & |` and brackets."""

from __future__ import annotations

from fractions import Fraction

from .cursor import Cursor, Panic
from .lexer import unescape
from .syntax import Argument, Expression, Name, Number, Operation, Path, Step, Text

MAX_OPERATIONS = 200  # most levels of one expression; all terms of a sum count as one level
MAX_EXPONENT = 60  # the largest exponent of a decimal number: 1e60

# How strongly operators bind. A sum is read separately, because it may be as long as the text.
_LOOSER = {"|": 1, "&": 2, "<<": 3, ">>": 3}
_PRODUCT = ("*", "/", "%")
_ENDS = frozenset((")", ",", ";", ":", "]"))


class ExpressionReader(Cursor):
    """A cursor that reads expressions."""

    operations = 0  # operators in the current expression

    def argument(self, what: str, key: Name | None = None) -> Argument:
        """Read an expression. The parts of a sum are joined later, when their values are known."""
        self.operations = 0
        # most expressions are one word
        if self.kinds[self.i + 1 if self.kinds[self.i] != "end" else self.i] in _ENDS:
            one = self._operand(what)
            return Argument([one], one.start, one.end, key)
        return self._argument(what, 1, key)

    def _argument(self, what: str, tightness: int, key: Name | None = None) -> Argument:
        left = self._sum(what, key)
        while (operator := self.kinds[self.i]) in _LOOSER and _LOOSER[operator] >= tightness:
            self._operator()
            right = self._argument("a number", _LOOSER[operator] + 1)
            whole = Operation(operator, left, right, left.start, right.end)
            left = Argument([whole], left.start, right.end, key)
        return left

    def _sum(self, what: str, key: Name | None) -> Argument:
        parts = [self._product(what)]
        while (operator := self.kinds[self.i]) in ("+", "-"):
            start = self.tokens.starts[self.i]
            self.i += 1
            part = self._product("a number" if operator == "-" else "a string or a parameter")
            parts.append(Operation("-", None, part, start, part.end) if operator == "-" else part)
        return Argument(parts, parts[0].start, parts[-1].end, key)

    def _product(self, what: str) -> Expression:
        left = self._operand(what)
        while (operator := self.kinds[self.i]) in _PRODUCT:
            self._operator()
            right = self._operand("a number")
            left = Operation(operator, left, right, left.start, right.end)
        return left

    def _operand(self, what: str) -> Expression:
        kind = self.kinds[self.i]
        start = self.tokens.starts[self.i]
        if kind == "number":
            return self.number(what)
        if kind == "string":
            self.i += 1
            return Text(unescape(self.texts[self.i - 1]), start, self.tokens.ends[self.i - 1])
        if kind == "-":
            self._operator()
            right = self._operand("a number")
            return Operation("-", None, right, start, right.end)
        if kind == "(":
            self._operator()
            inner = self._argument(what, 1)
            self.expect(")", "`)`")
            return Argument(inner.parts, start, self.tokens.ends[self.i - 1])
        if kind == "name" or (kind == "keyword" and self.kinds[self.i + 1] != "="):
            name = self.name(what)
            return self._element_path(name) if self.kinds[self.i] in (".", "[") else name
        raise self.unexpected(what)

    def _element_path(self, first: Name) -> Path:
        steps: list[Step] = []
        name = first
        while True:
            index: Argument | None = None
            if self.kinds[self.i] == "[":
                self._operator()
                index = self._argument("the index", 1, None)
                self.expect("]", "`]`")
            steps.append(Step(name, False, index))
            if self.kinds[self.i] != ".":
                return Path(steps, first.start, self.tokens.ends[self.i - 1])
            self._operator()
            name = self.name("a member")

    def _operator(self) -> None:
        """Move past an operator or an opening bracket, unless there are too many of them."""
        self.operations += 1
        if self.operations > MAX_OPERATIONS:
            message = f"more than {MAX_OPERATIONS} operators in one expression"
            self.report("UL045", self.i, message, "divide it: give parts of it a name by `const`")
            raise Panic
        self.i += 1

    def number(self, what: str) -> Number:
        """Read a number and the unit after it: `0x80`, `0.5`, `30 deg`, `3 "rad/s"`."""
        if self.kinds[self.i] != "number":
            raise self.unexpected(what)
        text = self.texts[self.i]
        start, end = self.place(self.i)
        self.i += 1
        value = self._value(text)
        unit = ""
        if self.kinds[self.i] == "name" and not self.on_new_line():
            unit, end = self.texts[self.i], self.tokens.ends[self.i]
            self.i += 1
        elif self.kinds[self.i] in ("string", "%") and self._ends_behind(self.i):
            unit, end = self.texts[self.i].strip("\"'"), self.tokens.ends[self.i]
            self.i += 1
        return Number(value, start, end, unit)

    def _ends_behind(self, i: int) -> bool:
        """Does the expression end after token `i`? Then a `%` there is a unit and not an operator."""
        return self.kinds[i] == "string" or self.kinds[i + 1] in (")", ",", ";", "]")

    def _value(self, text: str) -> int | Fraction:
        try:
            # most numbers are; isdecimal, because int() accepts other digits too
            if text.isdecimal() and len(text) <= 20:
                return int(text)
            prefix = text[:2].lower()
            if prefix in ("0x", "0b"):
                digits = text[2:].lstrip("0") or "0"
                base, most = (16, 20) if prefix == "0x" else (2, 80)
                return int(digits, base) if len(digits) <= most else 1 << 64  # int() is slow for a long text
            if text.isdigit():
                digits = text.lstrip("0") or "0"
                return int(digits) if len(digits) <= 20 else 1 << 64
            exponent = text.lower().partition("e")[2]
            if len(text) > 60 or (exponent and abs(int(exponent)) > MAX_EXPONENT):
                self.report("UL045", self.i - 1, "this number has too many digits", "60 are enough")
                self.broken = True
                return 0
            value = Fraction(text)
            return value if value.denominator > 1 else value.numerator
        except ValueError:  # malformed, and already reported as UL008
            self.broken = True
            return 0
