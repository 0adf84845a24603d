# SPDX-License-Identifier: BSD-3-Clause
"""The properties of a declared link: `link arm (DATA=16, BAUD=3 MHz, PHYSICAL=rs485, NODE=3);`."""

from __future__ import annotations

from collections.abc import Callable

from unitylink.protocol import ADDRESS_BITS_MAX, DATA_BITS_MAX, DATA_BITS_MIN, RS485_NODES_MAX

from ..model import ENGINES, LINES, PHYSICAL_LAYERS, SEND_IMMEDIATE, Link
from ..text.syntax import Expression, LinkNode, Property
from ..units import UNITS
from .evaluate import Evaluator

_FREQUENCY_MAX_HZ = 100_000_000
_NUMBERS = {
    "DATA": ("DATA (in bits)", DATA_BITS_MIN, DATA_BITS_MAX),
    "ADDRESS": ("ADDRESS (in bits)", 1, ADDRESS_BITS_MAX),
    "NODE": ("NODE (on the pair)", 1, RS485_NODES_MAX),
}
_WORDS = {"PHYSICAL": PHYSICAL_LAYERS, "SEND_IMMEDIATE": SEND_IMMEDIATE, "ENGINE": ENGINES}
# property -> (the physical layers that have it, what these have in common)
_BELONGS = {
    "BAUD": (LINES, "a line"),
    "SEND_IMMEDIATE": (("ft245_async", "ft245_sync"), "an FT245"),
    "NODE": (("rs485",), "an RS-485 pair"),
}


class LinkReader:
    """Gives the declared links their meaning. `known` tells whether the names of an expression are known."""

    def __init__(self, evaluator: Evaluator, known: Callable[[Expression], bool]) -> None:
        self.evaluator = evaluator
        self.reporter = evaluator.reporter
        self.known = known

    def read(self, node: LinkNode) -> Link:
        """Return the link. A wrong property is reported and keeps its default."""
        words = {one.key: self._word(one) for one in node.properties if one.key in _WORDS}
        numbers = {one.key: self._number(one) for one in node.properties if one.key not in _WORDS}
        given = {key: value for key, value in numbers.items() if value is not None}
        self._check(node, words.get("PHYSICAL"))
        default = Link(node.name.text)
        return Link(
            node.name.text,
            given.get("DATA", default.data_bits),
            given.get("ADDRESS", default.address_bits),
            given.get("BASE_RATE", default.base_hz),
            given.get("BAUD", default.baud_hz),
            tuple(one.key for one in node.properties if one.key in given or words.get(one.key)),
            node.notes.documentation,
            words.get("PHYSICAL"),
            words.get("SEND_IMMEDIATE"),
            given.get("NODE"),
            words.get("ENGINE"),
        )

    def _number(self, one: Property) -> int | None:
        assert one.argument is not None  # all of them have a value
        if not self.known(one.argument):
            return None
        if one.key in _NUMBERS:
            return self.evaluator.integer(one.argument, {}, *_NUMBERS[one.key])
        return self._frequency(one.argument, one.key)

    def _word(self, one: Property) -> str | None:
        assert one.argument is not None
        word, choices = one.name.text if one.name else "", _WORDS[one.key]
        if word in choices:
            return word
        at = one.argument.start, one.argument.end
        advice = self.reporter.did_you_mean(word, choices, "there are " + ", ".join(choices), at)
        self.reporter.report("UL093", *at, f"{one.key}={word or '…'} has no meaning", advice)
        return None

    def _check(self, node: LinkNode, physical: str | None) -> None:
        """Report properties that the physical layer does not have. The default layer is a serial line."""
        given = {one.key: one for one in node.properties}
        if "PHYSICAL" in given and physical is None:
            return  # it has been reported, and without it nothing tells which properties belong to it
        for key, (layers, what) in _BELONGS.items():
            if key in given and (physical or LINES[0]) not in layers:
                one = given[key]
                message = f"{key} belongs to {what}, but link `{node.name.text}` is not one"
                hint = f"remove {key}, or write PHYSICAL={' or '.join(layers)}"
                self.reporter.report("UL092", one.start, one.end, message, hint)
        if physical == "rs485" and "NODE" not in given:
            one = given["PHYSICAL"]
            message = f"which node on the pair is link `{node.name.text}`?"
            hint = f"write NODE=1, up to {RS485_NODES_MAX}: each on the pair has a number of its own"
            self.reporter.report("UL092", one.start, one.end, message, hint)

    def _frequency(self, node: Expression, what: str) -> int | None:
        value = self.evaluator.quantity(node, {}, what, UNITS["Hz"])
        if value is None:
            return None
        if isinstance(value, int) and 1 <= value <= _FREQUENCY_MAX_HZ:
            return value
        message = f"{what} is {float(value):g} Hz"
        hint = f"it is a whole number of Hz from 1 to {_FREQUENCY_MAX_HZ:,}"
        self.reporter.report("UL049", node.start, node.end, message, hint)
        return None
