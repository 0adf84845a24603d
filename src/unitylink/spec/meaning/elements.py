# SPDX-License-Identifier: BSD-3-Clause
"""Evaluates an element's type and properties. It does so only once if they do not depend on a parameter."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from ..model import WRITES, Link, Publish
from ..text.syntax import ElementNode, Property
from ..types import ValueType
from .declared import Declared
from .evaluate import Value
from .limits import Facts, check_access, check_limits, read_facts
from .rates import read_publish

_NO_FACTS = Facts()
_NOT_FOUND = object()


@dataclass(frozen=True)
class ElementFacts:
    """Everything about an element except its name, address, display name and notes."""

    type: ValueType
    words: int
    checked: bool
    publish: Publish | None
    facts: Facts


class ElementReader:
    """Reads elements of one program."""

    def __init__(self, declared: Declared) -> None:
        self.declared = declared
        self.evaluator = declared.evaluator
        self._bare: dict[tuple[str, int], ValueType] = {}
        self._known: dict[tuple[int, str], ElementFacts | None] = {}

    def read(self, node: ElementNode, names: Mapping[str, Value], link: Link) -> ElementFacts | None:
        """Return the facts of an element.

        Return None after a diagnostic, or if a name has no value in `names`.
        """
        key = (id(node), link.name)
        known = self._known.get(key, _NOT_FOUND)
        if known is not _NOT_FOUND:
            return known  # type: ignore[return-value]
        self.evaluator.used = False
        found = self._read(node, names, link)
        if not self.evaluator.used:  # then they are the same in every expansion of the constructor
            self._known[key] = found
        return found

    def _read(self, node: ElementNode, names: Mapping[str, Value], link: Link) -> ElementFacts | None:
        kind = self._type(node, names, link)
        if kind is None:
            return None
        checked = False
        publish: Publish | None = None
        others = []
        for one in node.properties:
            if self._is_left_out(one, names):
                continue
            if one.key == "CRC":
                checked = True
            elif one.key == "PUBLISH":
                publish = read_publish(node, one, self.evaluator, names, link)
                if publish is None:
                    return None
            elif one.key != "ID":
                others.append(one)
        facts = _NO_FACTS
        if others:
            found = read_facts(others, kind, self.evaluator, names)
            if found is None:
                return None
            facts = found
            reporter = self.evaluator.reporter
            good = check_access(facts, node.name.text, node.access, node.access in WRITES, reporter)
            if not (check_limits(facts, kind, reporter) and good):
                return None
        if node.access == "W1C" and kind.kind not in ("uint", "bits", "bool"):
            message = f"`{node.name.text}` is a W1C, but its type is `{kind.text}`"
            hint = "bits are cleared by writing 1 to them: choose bits, bool or u1 to u64"
            self.evaluator.reporter.report("UL092", node.name.start, node.name.end, message, hint)
            return None
        return ElementFacts(kind, -(-kind.width // link.data_bits), checked, publish, facts)

    def _is_left_out(self, one: Property, names: Mapping[str, Value]) -> bool:
        """Is this a property whose value is a parameter that nobody gave?"""
        rates = one.publish.rates if one.publish else []
        return self.evaluator.is_missing(rates[0] if len(rates) == 1 else one.argument, names)

    def _type(self, node: ElementNode, names: Mapping[str, Value], link: Link) -> ValueType | None:
        if node.type is not None and node.type.name.text != "signed":
            return self.declared.types.resolve(node.type, names)
        key = ("uint" if node.type is None else "int", link.data_bits)
        bare = self._bare.get(key)
        if bare is None:
            bare = self._bare[key] = ValueType(*key, bus=True)
        return bare
