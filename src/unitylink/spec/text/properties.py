# SPDX-License-Identifier: BSD-3-Clause
"""Read properties in brackets: `(ID="x", UNIT="rad", PUBLISH(100 Hz))`. Also read types."""

from __future__ import annotations

from ..units import spoken
from .cursor import Panic
from .expressions import ExpressionReader
from .syntax import Argument, Name, Number, Property, PublishNode, TypeNode

RING_PROPERTIES = ("NODE", "NODES", "BAUD", "CYCLE_RATE", "RINGS", "CHECK_BYTES", "TIME")
LINK_KIND_PROPERTIES = {
    "TOSNET": ("CTRL", "COMM", "UART", "BASE", "LINK", *RING_PROPERTIES),
    "MEMORY": ("CTRL", "COMM", "UART", "BASE", "LINK"),
    "DOUBLE_BUFFER": ("CTRL", "COMM", "UART", "BASE", "LINK", "SIZE"),
    "FIFO": ("CTRL", "COMM", "UART", "BASE", "LINK", "DEPTH"),
}
FIELD_PROPERTIES = ("UNIT", "SCALE", "OFFSET", "MIN", "MAX")
ELEMENT_PROPERTIES = ("ID", "CRC", "PUBLISH", *FIELD_PROPERTIES, "OVERFLOW", "INITIAL", "SAFE")
LINK_PROPERTIES = ("DATA", "ADDRESS", "BASE_RATE", "BAUD", "PHYSICAL", "SEND_IMMEDIATE", "NODE", "ENGINE")

_FORMS = "`PUBLISH(100 Hz)`; `PUBLISH(1, 10)`, a tenth of the base frequency; or `PUBLISH(on change)`"
_EXPECTED = {"ID": "a string or a parameter", "UNIT": 'a unit such as "rad"'}
_NAMED = {
    "CTRL": "a parameter of the constructor",
    "COMM": "a parameter of the constructor",
    "LINK": "the name of a link",
    "OVERFLOW": "error or saturate",
    "PHYSICAL": "a physical layer such as uart",
    "SEND_IMMEDIATE": "never, publishes, replies or both",
    "ENGINE": "fast or small",
    "NODES": "inside or ring",
}


class PropertyReader(ExpressionReader):
    """A cursor that reads properties and types."""

    def properties(self, known: tuple[str, ...]) -> list[Property]:
        """Read properties in brackets, each at most once."""
        if self.kinds[self.i] != "(":
            word, end = self.texts[self.i - 1], self.tokens.ends[self.i - 1]
            bare = self.kinds[self.i] == ";"
            raise self.unexpected("`(`", self.replace(f"write `{word}()`", end, end, "()") if bare else "")
        self.i += 1
        found: list[Property] = []
        if self.accept(")"):
            return found
        while True:
            start = self.i
            one = self._property(known)
            if one is not None:
                earlier = next((other for other in found if other.key == one.key), None)
                if earlier is not None:
                    labels = [(earlier.start, earlier.end, "first given here")]
                    where = self.place(start)
                    message = f"{one.key} is given twice"
                    self.reporter.report("UL016", *where, message, "remove one of the two", labels=labels)
                else:
                    found.append(one)
            if self.accept(")"):
                return found
            self.expect(",", "`,` or `)`")

    def _property(self, known: tuple[str, ...]) -> Property | None:
        key = self.texts[self.i]
        if self.kinds[self.i] not in ("name", "keyword"):
            raise self.unexpected("a property: " + ", ".join(known))
        start, end = self.place(self.i)
        if key not in known:
            otherwise = "there are " + ", ".join(known)
            advice = self.reporter.did_you_mean(key, known, otherwise, (start, end))
            self.report("UL015", self.i, f"there is no property `{key}` here", advice)
            self._skip_property()
            return None
        self.i += 1
        one = Property("COMM" if key == "UART" else key, start, end)
        if key == "PUBLISH":
            one.publish = self._publish()
        elif key != "CRC":
            self.expect("=", f"`=` after {key}")
            if one.key in _NAMED:
                name = self.name(_NAMED[one.key])
                one.argument = Argument([name], name.start, name.end)
            else:
                one.argument = self.argument(_EXPECTED.get(one.key, "a number"))
                if key == "UNIT" and self.kinds[self.i] == "name":
                    raise self._unquoted(one.argument.start)
        return one

    def _unquoted(self, start: int) -> Panic:
        """Report `UNIT=N m`. Without an operator between its parts, this is not an expression."""
        i = self.i
        while self.kinds[i] in ("name", "*", "/"):
            i += 1
        end = self.tokens.ends[i - 1]
        text = self.reporter.sources.text(start, end)
        written = spoken(text) or text
        advice = self.replace(f'a unit stands in quotes: `"{written}"`', start, end, f'"{written}"')
        return self.unexpected("`,` or `)`", advice)

    def _skip_property(self) -> None:
        depth = 0
        while (kind := self.kinds[self.i]) not in ("end", ";", "{", "}"):
            if depth == 0 and kind in (",", ")"):
                return
            depth += (kind == "(") - (kind == ")")
            self.i += 1

    def _publish(self) -> PublishNode:
        self.expect("(", "`(` after PUBLISH: `(mode, divisor)`, `(100 Hz)` or `(on …)`")
        if self.kinds[self.i] == ")":
            raise self.unexpected("how it is published", _FORMS)
        node = PublishNode([], [], None)
        if self.kinds[self.i] == "name" and self.texts[self.i] == "on" and self.kinds[self.i + 1] == "name":
            self.i += 1
            self.operations = 0
            node.event = self._element_path(self.name("change, or the name of an event")).steps
        else:
            first = self.argument("the mode: 1 hardware, 2 software; or a rate such as 100 Hz")
            node.rates.append(first)
            grouped = self.kinds[self.i] == "," and self.texts[self.i + 1] == "GROUP"
            if not (grouped or (self.kinds[self.i] == ")" and _has_unit(first))):
                if self.kinds[self.i] == ")" and isinstance(number := first.parts[0], Number):
                    raise self._bare(number)
                self.expect(",", "`,` and the divisor of the base publish frequency")
                node.rates.append(self.argument("the divisor of the base publish frequency"))
        if self.accept(","):
            if self.texts[self.i] != "GROUP":
                raise self.unexpected("GROUP=name")
            self.i += 1
            self.expect("=", "`=` after GROUP")
            node.group = self.name("the name of a snapshot group")
        self.expect(")", "`)`")
        return node

    def _bare(self, number: Number) -> Panic:
        """Report `PUBLISH(100)`. It is a mode without its divisor, or a rate without its unit."""
        if self.touched():  # `100Hz`, which has been reported
            return Panic()
        if number.value in (1, 2):
            return self.unexpected("`,` and the divisor of the base publish frequency", _FORMS)
        text = self.texts[self.i - 1]
        hint = f"a rate has a unit: `PUBLISH({text} Hz)`"
        self.reporter.report(
            "UL010",
            number.start,
            number.end,
            f"expected a rate with its unit, or a mode and a divisor, but found `{text}`",
            self.replace(hint, number.end, number.end, " Hz"),
        )
        return Panic()

    # --- types ----------------------------------------------------------------------------------------------

    def type(self) -> TypeNode:
        """Read `u8`, `fixed(8,8)` or the name of a type."""
        name = self.name("a type such as u8")
        arguments = self.arguments(name) if self.kinds[self.i] == "(" else []
        return TypeNode(name, arguments, self.tokens.ends[self.i - 1])

    def arguments(self, callee: Name) -> list[Argument]:
        """Read arguments in brackets, with or without a name."""
        self.expect("(", f"`(` and the arguments of `{callee.text}`")
        found: list[Argument] = []
        if self.accept(")"):
            return found
        found.append(self._one_argument(callee))
        while not self.accept(")"):
            self.expect(",", "`,` or `)`")
            found.append(self._one_argument(callee))
        return found

    def _one_argument(self, callee: Name) -> Argument:
        what = "a string or a parameter"
        kind = self.kinds[self.i]
        if kind in ("name", "keyword") and self.kinds[self.i + 1] == "=":
            if kind == "keyword" and callee.text.upper() in ("READ", "WRITE"):
                upper = callee.text.upper()
                hint = f"keywords are written in capitals: `{upper}`"
                raise self.unexpected(what, self.replace(hint, callee.start, callee.end, upper))
            key = self.name("a parameter")
            self.i += 1
            return self.argument(what, key)
        return self.argument(what)


def _has_unit(argument: Argument) -> bool:
    """Is this a number with a unit, or a name that may stand for one?"""
    part = argument.parts[0]
    return not isinstance(part, Name) if len(argument.parts) > 1 else getattr(part, "unit", "x") != ""
