# SPDX-License-Identifier: BSD-3-Clause
"""The engineering side of a value, from properties to numbers: unit, scale, limits, initial and safe."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import lru_cache

from ..report.diagnostics import Reporter
from ..text.syntax import Argument, Property, Text
from ..types import Number, ValueType
from ..units import Unit, unit
from .evaluate import Evaluator, Plain, Quantity, Value

_NOTHING: dict[str, Value] = {}
_OVERFLOWS = ("error", "saturate")
_FLOAT_MAX = {32: Fraction(2) ** 128 - Fraction(2) ** 104, 64: Fraction(2) ** 1024 - Fraction(2) ** 971}
_OF_NUMBERS = ("UNIT", "SCALE", "OFFSET", "MIN", "MAX")
_OF_WRITES = ("OVERFLOW", "INITIAL", "SAFE")
_WITH_FRACTIONS = ("float", "fixed", "ufixed")


@dataclass
class Facts:
    """The properties of a value, as exact numbers in its unit."""

    given: dict[str, Property] = field(default_factory=dict)
    unit: str = ""
    factor: Plain = 1
    shift: Plain = 0
    numbers: dict[str, Plain] = field(default_factory=dict)  # MIN, MAX, INITIAL, SAFE
    overflow: str = "error"

    @property
    def scale(self) -> Number:
        return plain(self.factor)

    @property
    def offset(self) -> Number:
        return plain(self.shift)

    @property
    def minimum(self) -> Number | None:
        return self._number("MIN")

    @property
    def maximum(self) -> Number | None:
        return self._number("MAX")

    @property
    def initial(self) -> Number | None:
        return self._number("INITIAL")

    @property
    def safe(self) -> Number | None:
        return self._number("SAFE")

    def _number(self, key: str) -> Number | None:
        value = self.numbers.get(key)
        return None if value is None else plain(value)


def plain(value: Plain) -> Number:
    """Return a whole number as an int, and any other one as the nearest float."""
    return value if isinstance(value, int) else float(value)


def read_facts(
    properties: Sequence[Property], kind: ValueType, evaluator: Evaluator, names: Mapping[str, Value]
) -> Facts | None:
    """Return the facts that properties give about a value.

    Return None after a diagnostic, or if a name has no value here.
    """
    facts = Facts({one.key: one for one in properties})
    reader = _Reader(facts, kind, evaluator, names)
    return facts if reader.read() else None


class _Reader:
    def __init__(
        self, facts: Facts, kind: ValueType, evaluator: Evaluator, names: Mapping[str, Value]
    ) -> None:
        self.facts = facts
        self.kind = kind
        self.evaluator = evaluator
        self.reporter = evaluator.reporter
        self.names = names
        self.good = True

    def read(self) -> bool:
        given = self.facts.given
        if not self.kind.numeric:
            for key in _OF_NUMBERS:
                if key in given:
                    self._misfit(given[key])
            if not self.good:
                return False
        scale_unit = self._unit()
        if not self.good:
            return False
        if scale_unit is None:
            scale_unit = self._unit_of_scale()
        for key in ("SCALE", "OFFSET"):
            value = self._quantity(key, scale_unit)
            if value is not None and key == "SCALE":
                self.facts.factor = value
            elif value is not None:
                self.facts.shift = value
        if self.facts.factor == 0:
            at = given["SCALE"]
            message = "a SCALE of 0 makes every value the same"
            self._wrong("UL091", at, message, "SCALE is how much one step of the raw value is")
        for key in ("MIN", "MAX", "INITIAL", "SAFE"):
            value = self._symbol(key) if key in ("INITIAL", "SAFE") else self._quantity(key, scale_unit)
            if value is not None:
                self.facts.numbers[key] = value
        self._overflow()
        return self.good

    def _misfit(self, one: Property) -> None:
        message = f"{one.key} is for numbers, but this is `{self.kind.text}`"
        self._wrong("UL092", one, message, "remove it, or choose a type such as u8, i16 or fixed(8,8)")

    def _wrong(self, code: str, one: Property, message: str, hint: str) -> None:
        self.reporter.report(code, one.start, one.argument.end if one.argument else one.end, message, hint)
        self.good = False

    def _unit(self) -> Unit | None:
        one = self.facts.given.get("UNIT")
        if one is None or one.argument is None:
            return None
        text = self.evaluator.text(one.argument, self.names, "UNIT")
        if text is None:
            self.good = False
            return None
        found = unit(text)
        if found is None:
            quoted = isinstance(one.argument.parts[0], Text) and one.argument.literal
            self.evaluator.unknown_unit(text, one.argument.start, one.argument.end, quoted=quoted)
            self.good = False
            return None
        self.facts.unit = text
        return found

    def _unit_of_scale(self) -> Unit | None:
        """Return the unit of a SCALE that has one. Then it is that of the value too."""
        one = self.facts.given.get("SCALE")
        value = self.evaluator.value(one.argument, self.names) if one is not None and one.argument else None
        if not isinstance(value, Quantity) or not value.unit:
            return None
        self.facts.unit = value.unit
        return unit(value.unit)

    def _quantity(self, key: str, wanted: Unit | None) -> Plain | None:
        one = self.facts.given.get(key)
        if one is None or one.argument is None:
            return None
        value = self.evaluator.quantity(one.argument, self.names, key, wanted)
        self.good = self.good and value is not None
        return value

    def _symbol(self, key: str) -> Plain | None:
        """A number, or the name of an enumeration's value."""
        one = self.facts.given.get(key)
        if one is None or one.argument is None:
            return None
        enum = self.kind.enum
        if enum is not None and one.name is not None:
            name = one.name.text
            found = next((value.value for value in enum.values if value.name == name), None)
            if found is None and name not in self.names and name not in self.evaluator.constants:
                known = [value.name for value in enum.values]
                advice = self.reporter.did_you_mean(
                    name, known, "its values are " + ", ".join(known[:8]), (one.name.start, one.name.end)
                )
                message = f"`{enum.name}` has no value `{name}`"
                self.reporter.report("UL090", one.name.start, one.name.end, message, advice)
                self.good = False
            if found is not None or not self.good:
                return found
        return self._quantity(key, unit(self.facts.unit) if self.facts.unit else None)

    def _overflow(self) -> None:
        one = self.facts.given.get("OVERFLOW")
        if one is None or one.argument is None:
            return
        word = one.name.text if one.name else ""
        if word in _OVERFLOWS:
            self.facts.overflow = word
            return
        at = one.argument.start, one.argument.end
        advice = self.reporter.did_you_mean(word, _OVERFLOWS, "there are error and saturate", at)
        self.reporter.report("UL093", *at, f"OVERFLOW={word or '…'} has no meaning", advice)
        self.good = False


# --- checks -------------------------------------------------------------------------------------------------


@lru_cache(256)  # a spec has few types and scales, however many values it has
def _scaled_range(numbers: tuple[str, int, int, bool], factor: Plain, shift: Plain) -> tuple[Plain, Plain]:
    kind, width, fraction, signed = numbers
    if kind == "float":
        raw: tuple[Plain, Plain] = (-_FLOAT_MAX[width], _FLOAT_MAX[width])
    else:
        raw = -(1 << width - 1) if signed else 0, (1 << width - signed) - 1
        if fraction:
            raw = Fraction(raw[0], 1 << fraction), Fraction(raw[1], 1 << fraction)
    ends = [end * factor + shift for end in raw]
    return min(ends), max(ends)


def check_limits(facts: Facts, kind: ValueType, reporter: Reporter) -> bool:
    """Report limits, initial and safe values that contradict the type or each other."""
    if not facts.numbers:
        return True
    numbers = kind.kind, kind.width, kind.fraction, kind.signed
    low, high = _scaled_range(numbers, facts.factor, facts.shift)
    good = True
    for key, value in facts.numbers.items():
        if not low <= value <= high:
            message = f"{key} is {_shown(value)}, but `{kind.text}` goes from {_shown(low)} to {_shown(high)}"
            scaled = " (scaled)" if facts.factor != 1 or facts.shift else ""
            hint = f"choose a wider type, another SCALE, or a value it can hold{scaled}"
            reporter.report("UL090", *_place(facts, key), message, hint)
            good = False
    minimum, maximum = facts.numbers.get("MIN"), facts.numbers.get("MAX")
    if minimum is not None and maximum is not None and minimum > maximum:
        labels = [(*_place(facts, "MIN"), "the smallest")]
        message = f"MAX {_shown(maximum)} is below MIN {_shown(minimum)}"
        reporter.report("UL089", *_place(facts, "MAX"), message, "exchange them", labels=labels)
        return False
    for key in ("INITIAL", "SAFE"):
        number = facts.numbers.get(key)
        if number is None or not good:
            continue
        whole = kind.kind not in _WITH_FRACTIONS and facts.factor == 1 and facts.shift == 0
        if whole and number != int(number):
            message = f"{key} is {_shown(number)}, but `{kind.text}` has whole numbers only"
            reporter.report("UL090", *_place(facts, key), message, "round it, or choose a SCALE")
            good = False
        for limit, wrong in (
            ("MIN", minimum is not None and number < minimum),
            ("MAX", maximum is not None and number > maximum),
        ):
            if wrong:
                labels = [(*_place(facts, limit), "the limit")]
                beyond = "below MIN" if limit == "MIN" else "above MAX"
                message = f"{key} {_shown(number)} is {beyond} {_shown(facts.numbers[limit])}"
                reporter.report(
                    "UL090", *_place(facts, key), message, "choose one within the limits", labels=labels
                )
                good = False
        enum = kind.enum
        if enum is not None and not enum.open and number not in [one.value for one in enum.values]:
            message = f"`{enum.name}` has no value {_shown(number)}"
            hint = "its values are " + ", ".join(f"{one.name} = {one.value}" for one in enum.values[:8])
            reporter.report("UL090", *_place(facts, key), message, hint)
            good = False
    return good


def check_access(facts: Facts, name: str, access: str, writable: bool, reporter: Reporter) -> bool:
    """Report properties that only make sense for values that the PC writes."""
    good = True
    for key in _OF_WRITES:
        if key in facts.given and (not writable or (access == "PULSE" and key != "OVERFLOW")):
            one = facts.given[key]
            message = f"`{name}` is a {access}: {key} is for values that the PC writes and the gateware keeps"
            end = one.argument.end if one.argument else one.end
            reporter.report("UL092", one.start, end, message, f"remove {key}, or make it a WRITE")
            good = False
    return good


def _place(facts: Facts, key: str) -> tuple[int, int]:
    argument = facts.given[key].argument
    assert isinstance(argument, Argument)  # these keys always have a value
    return argument.start, argument.end


def _shown(value: Plain) -> str:
    if isinstance(value, int) and abs(value) < 10**20:
        return f"{value:,}"
    return f"{float(value):.6g}" if -_FLOAT_MAX[64] <= value <= _FLOAT_MAX[64] else "more than a float holds"
