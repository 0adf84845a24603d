# SPDX-License-Identifier: BSD-3-Clause
"""Evaluates expressions to exact numbers, numbers with a unit, texts or run-time objects.

Arithmetic is exact, also division: 3/2 is one and a half. If a whole number is needed and the result is not
whole, this is an error. Nothing is rounded silently.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Union

from ..report.diagnostics import Advice, Reporter
from ..report.suggest import nearest
from ..text.syntax import Argument, Expression, Name, Number, Operation, Path, Text
from ..units import NONE as NO_UNIT
from ..units import UNITS, Dimension, Unit, combined, spoken, unit

MAX_STRING = 250  # the most characters of an evaluated string
MAX_BITS = 512  # the most bits of a number during a computation: 64-bit words, scaled exactly
MAX_SHIFT = 64


@dataclass(frozen=True)
class RunTime:
    """The value of a run-time parameter. It is the parameter of the public constructor behind it."""

    name: str


@dataclass(frozen=True)
class Quantity:
    """A number with a unit, in the SI's own units. `unit` is the text of the unit in which it was written."""

    value: Fraction
    dimension: Dimension
    unit: str = field(default="", compare=False)


@dataclass(frozen=True)
class Missing:
    """The value of a parameter that is not given: `none`. A property with it is left out."""


Plain = Union[int, Fraction]


@dataclass(frozen=True)
class Wire:
    """An element of another component, to which a wire leads. As a number it is what one count of it is.

    `component` is the path of its instance, and `port` its port, which is "in" or "out".
    """

    name: str
    component: str
    port: str
    direction: str
    scale: Plain | Quantity
    bits: int


Value = Union[int, Fraction, str, Quantity, RunTime, Missing, Wire]

MISSING = Missing()
NONE = "none"
PI = Fraction("3.14159265358979323846264338327950288")
WORDS: dict[str, Value] = {"true": 1, "false": 0, "pi": PI, NONE: MISSING}


class Stop(Exception):
    """There is no value.

    A diagnostic has been given, or a name is not known here. This never leaves `Evaluator`.
    """


class Evaluator:
    """Evaluates expressions. Each method returns None after a diagnostic, or if a name has no value here."""

    def __init__(self, reporter: Reporter, constants: Mapping[str, Value]) -> None:
        self.reporter = reporter
        self.constants = constants
        self.used = False  # true if a name was looked up that is not a constant

    def value(self, expression: Expression, names: Mapping[str, Value]) -> Value | None:
        """Return the value of an expression."""
        try:
            return self._value(expression, names)
        except Stop:
            return None

    def is_missing(self, expression: Expression | None, names: Mapping[str, Value]) -> bool:
        """Is this `none`, or one name that stands for it?"""
        part = expression
        while isinstance(part, Argument) and len(part.parts) == 1:
            part = part.parts[0]
        if not isinstance(part, Name):
            return False
        self.used = self.used or part.text in names
        return names.get(part.text, self.constants.get(part.text, WORDS.get(part.text))) is MISSING

    def wire(self, expression: Expression, names: Mapping[str, Value]) -> Wire | None:
        """Return the wire for which a name stands, or None if it stands for something else."""
        part = expression
        while isinstance(part, Argument) and len(part.parts) == 1:
            part = part.parts[0]
        found = names.get(part.text) if isinstance(part, Name) else None
        self.used = self.used or found is not None
        return found if isinstance(found, Wire) else None

    def text(self, expression: Expression, names: Mapping[str, Value], what: str) -> str | None:
        """Return the value of an expression that must be a string."""
        value = self.value(expression, names)
        if value is None or isinstance(value, str):
            return value
        self._wrong_kind(expression, f"{what} is a string", value)
        return None

    def integer(
        self, expression: Expression, names: Mapping[str, Value], what: str, low: int, high: int
    ) -> int | None:
        """Return the value of an expression that must be a whole number from `low` to `high`."""
        value = self.value(expression, names)
        if value is None:
            return None
        if isinstance(value, (str, RunTime, Quantity, Missing, Wire)):
            self._wrong_kind(expression, f"{what} is a number", value)
            return None
        if isinstance(value, Fraction):
            self._not_whole(expression, what, value)
            return None
        if low <= value <= high:
            return value
        message = f"{what} is {value:,}"
        hint = f"it is a number from {low:,} to {high:,}"
        self.reporter.report("UL049", expression.start, expression.end, message, hint)
        return None

    def quantity(
        self, expression: Expression, names: Mapping[str, Value], what: str, wanted: Unit | None
    ) -> Plain | None:
        """Return a number in the unit `wanted`. A number without a unit is already in this unit."""
        value = self.value(expression, names)
        if value is None:
            return None
        if isinstance(value, (str, RunTime, Missing, Wire)):
            self._wrong_kind(expression, f"{what} is a number", value)
            return None
        if not isinstance(value, Quantity):
            return value
        if wanted is not None and value.dimension == wanted.dimension:
            return _simple((value.value - wanted.offset) / wanted.factor)
        if wanted is None:
            message = f"{what} is given with a unit, but there is no UNIT"
            hint = 'say what the value is in, such as UNIT="rad", or leave the unit out'
        else:
            message = f"{what} is in `{wanted.text}`, and this does not measure the same"
            hint = f"write it in `{wanted.text}` or in a unit which that can be converted from"
        self.reporter.report("UL088", expression.start, expression.end, message, hint)
        return None

    # --- parts ----------------------------------------------------------------------------------------------

    def _value(self, node: Expression, names: Mapping[str, Value]) -> Value:
        if isinstance(node, Argument):
            if len(node.parts) == 1:
                return self._value(node.parts[0], names)
            return self._sum(node, names)
        if isinstance(node, Text):
            return node.value
        if isinstance(node, Number):
            return self._with_unit(node) if node.unit else node.value
        if isinstance(node, Name):
            return self._named(node, names)
        if isinstance(node, Path):
            message = f"`{node.text}` is an element, and no number is known of it here"
            hint = "only a parameter of the type `wire` takes an element"
            self.reporter.report("UL047", node.start, node.end, message, hint)
            raise Stop
        return self._operation(node, names)

    def _named(self, node: Name, names: Mapping[str, Value]) -> Value:
        found = names.get(node.text)
        if found is not None:
            self.used = True
            return found.scale if isinstance(found, Wire) else found
        found = self.constants.get(node.text)
        if found is None:
            found = WORDS.get(node.text)
        if found is None:
            self.used = True
            raise Stop
        return found

    def _with_unit(self, node: Number) -> Quantity:
        found = unit(node.unit)
        if found is None:
            self.unknown_unit(node.unit, node.start, node.end, quoted=False)
            raise Stop
        return Quantity(node.value * found.factor + found.offset, found.dimension, node.unit)

    def unknown_unit(self, text: str, start: int, end: int, *, quoted: bool) -> None:
        """Report that there is no such unit. `quoted` says that only a string may be at this place."""
        near = spoken(text) or nearest(text, UNITS)
        advice = Advice("units are such as rad, deg, m, s, A, V, N m, rad/s, degC, Hz, count")
        if near:
            advice = Advice(f"did you mean `{near}`?", ((start, end, f'"{near}"'),) if quoted else ())
        self.reporter.report("UL087", start, end, f"there is no unit `{text[:40]}`", advice)

    def _sum(self, node: Argument, names: Mapping[str, Value]) -> Value:
        values = [self._value(part, names) for part in node.parts]
        if not any(isinstance(value, str) for value in values):
            total = values[0]
            for value, part in zip(values[1:], node.parts[1:], strict=True):
                total = self._add(total, value, part)
            return total
        texts: list[str] = []
        length = 0
        for value, part in zip(values, node.parts, strict=True):
            if isinstance(value, (RunTime, Quantity, Missing, Wire)) or (
                isinstance(part, Operation) and part.left is None
            ):
                self._wrong_kind(part, "this sum is a string", value)
                raise Stop
            text = (
                value
                if isinstance(value, str)
                else f"{value}"
                if isinstance(value, int)
                else f"{float(value):g}"
            )
            texts.append(text)
            length += len(text)
            if length > MAX_STRING:
                message = f"this string is longer than {MAX_STRING} characters"
                self.reporter.report("UL040", node.start, node.end, message, "shorten it")
                raise Stop
        return "".join(texts)

    def _add(self, left: Value, right: Value, node: Expression) -> Value:
        if isinstance(left, Quantity) or isinstance(right, Quantity):
            if not (isinstance(left, Quantity) and isinstance(right, Quantity)):
                self._mixed(node)
            elif left.dimension != right.dimension:
                message = "these do not measure the same: they cannot be added"
                self.reporter.report("UL088", node.start, node.end, message, "give both in units of one kind")
            else:
                return Quantity(left.value + right.value, left.dimension, left.unit)
            raise Stop
        return self._bounded(self._plain(left, node) + self._plain(right, node), node)

    def _mixed(self, node: Expression) -> None:
        message = "one of these has a unit and the other has none"
        self.reporter.report("UL088", node.start, node.end, message, "give both a unit, or none")

    def _operation(self, node: Operation, names: Mapping[str, Value]) -> Value:
        right = self._value(node.right, names)
        if node.left is None:
            if isinstance(right, Quantity):
                return Quantity(-right.value, right.dimension, right.unit)
            return -self._plain(right, node.right)
        left = self._value(node.left, names)
        if node.operator in ("*", "/") and (isinstance(left, Quantity) or isinstance(right, Quantity)):
            return self._scaled(node, left, right)
        a, b = self._plain(left, node.left), self._plain(right, node.right)
        if node.operator == "*":
            return self._bounded(a * b, node)
        if node.operator == "/":
            return self._bounded(_simple(Fraction(a) / self._divisor(b, node)), node)
        return self._bounded(
            self._whole_operation(node, self._whole(a, node.left), self._whole(b, node.right)), node
        )

    def _scaled(self, node: Operation, left: Value, right: Value) -> Value:
        """Multiply or divide, where one or both have a unit. So has the result.

        Divided by a number of the same quantity, it becomes a plain number.
        """
        plain_left = not isinstance(left, Quantity)
        if plain_left and node.operator == "/" and isinstance(node.right, Number):
            return self._quotient(node, left, node.right)
        a, b = self._factor(left, node.left or node), self._factor(right, node.right)
        divided = node.operator == "/"
        value = a.value / self._divisor(b.value, node) if divided else a.value * b.value
        value = Fraction(self._bounded(value, node))
        sign = -1 if divided else 1
        x, y = a.dimension, b.dimension
        powers = [one + sign * other for one, other in zip(x, y, strict=True)]
        if not any(powers) and (a.unit and b.unit):
            return _simple(value)
        text = combined(a.unit, b.unit, divided=divided)
        if text is None:
            message = f"there is no unit for {'a quotient' if divided else 'a product'} of these"
            self.reporter.report("UL088", node.start, node.end, message, "leave one of the units out")
            raise Stop
        length, mass, time, current, temperature, angle, things = powers
        return Quantity(value, (length, mass, time, current, temperature, angle, things), text)

    def _factor(self, value: Value, node: Expression) -> Quantity:
        """A factor of a product. A plain number has the unit ""."""
        return (
            value
            if isinstance(value, Quantity)
            else Quantity(Fraction(self._plain(value, node)), NO_UNIT, "")
        )

    def _quotient(self, node: Operation, left: Value, right: Number) -> Quantity:
        """A unit behind a quotient is that of the whole: `2*pi/4096 rad` is so many radians."""
        value = Fraction(self._plain(left, node.left or node)) / self._divisor(right.value, node)
        self._bounded(value, node)
        return self._with_unit(Number(value, right.start, right.end, right.unit))

    def _whole_operation(self, node: Operation, a: int, b: int) -> int:
        if node.operator == "%":
            return a % int(self._divisor(b, node))
        if node.operator == "&":
            return a & b
        if node.operator == "|":
            return a | b
        if not 0 <= b <= MAX_SHIFT:
            message = f"a shift by {b:,}"
            self.reporter.report("UL048", node.start, node.end, message, f"shift by 0 to {MAX_SHIFT}")
            raise Stop
        return a << b if node.operator == "<<" else a >> b

    def _divisor(self, value: Plain, node: Operation) -> Plain:
        if value == 0:
            self.reporter.report(
                "UL048", node.start, node.end, "a division by zero", "give a divisor that is not 0"
            )
            raise Stop
        return value

    def _plain(self, value: Value, node: Expression) -> Plain:
        if isinstance(value, (int, Fraction)):
            return value
        self._wrong_kind(node, "a number is needed here", value)
        raise Stop

    def _whole(self, value: Plain, node: Expression) -> int:
        if isinstance(value, int):
            return value
        self._not_whole(node, "this", value)
        raise Stop

    def _bounded(self, value: Plain, node: Expression) -> Plain:
        bits = value.numerator.bit_length() + value.denominator.bit_length()
        if bits <= MAX_BITS:
            return _simple(value) if isinstance(value, Fraction) else value
        self.reporter.report(
            "UL045", node.start, node.end, "this number has too many digits", "compute with smaller ones"
        )
        raise Stop

    # --- diagnostics ----------------------------------------------------------------------------------------

    def _not_whole(self, node: Expression, what: str, value: Fraction) -> None:
        message = f"{what} is {float(value):g}, not a whole number"
        hint = "division is exact: take the rest off first, `(a - a % b) / b`, or shift, `a >> 1`"
        self.reporter.report("UL046", node.start, node.end, message, hint)

    def _wrong_kind(self, node: Expression, needed: str, value: Value) -> None:
        given, hint = "a string", "write the number without quotes"
        code = "UL047"
        if isinstance(value, RunTime):
            code = "UL037"
            given = f"`{value.name}` is a run-time parameter"
            hint = "a parameter that reaches CTRL or COMM is a controller or connection given at run time"
        elif isinstance(value, Missing):
            given, hint = "this is `none`", "give it a value where the constructor is used"
        elif isinstance(value, Quantity):
            given, hint = "this has a unit", "write the number without its unit"
        elif not isinstance(value, str):
            given, hint = (
                "this is a number",
                "put it into quotes, or declare the parameter as `int` or `real`",
            )
        else:
            given = "this is a string"
        self.reporter.report(code, node.start, node.end, f"{needed}, but {given}", hint)


def _simple(value: Fraction) -> Plain:
    """Return a fraction that is whole as an int."""
    return value.numerator if value.denominator == 1 else value
