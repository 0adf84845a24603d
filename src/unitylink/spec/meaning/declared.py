# SPDX-License-Identifier: BSD-3-Clause
"""The meaning of what a spec declares beside constructors: constants, enumerations, packed bits, links."""

from __future__ import annotations

from ..model import Link
from ..report.diagnostics import Advice, Reporter
from ..text.syntax import (
    BitsNode,
    ConstantNode,
    DeclarationNode,
    EnumNode,
    Expression,
    FieldNode,
    LinkNode,
    Name,
    Program,
    TypeNode,
)
from ..types import EnumType, EnumValue, Field, ValueType
from .evaluate import Evaluator, Value
from .limits import check_limits, read_facts
from .link_reader import LinkReader
from .notes import annotations_of
from .type_names import TypeNames, names_of

_WHAT: dict[type[DeclarationNode], str] = {
    ConstantNode: "constant",
    EnumNode: "type",
    BitsNode: "type",
    LinkNode: "link",
}
_NOTHING: dict[str, Value] = {}


class Declared:
    """The declarations of a program by name. A wrong one is missing here, and its name is in `lost`."""

    def __init__(self, program: Program, reporter: Reporter) -> None:
        self.reporter = reporter
        self.constants: dict[str, Value] = {}
        self.enums: dict[str, EnumType] = {}
        self.bits: dict[str, ValueType] = {}
        self.lost = set(program.lost)
        self.used: set[str] = set()  # names of types and constants that are used
        self.evaluator = Evaluator(reporter, self.constants)
        self.types = TypeNames(self.evaluator, self.enums, self.bits, self.lost)
        self._first: dict[tuple[str, str], Name] = {}
        self.nodes = [node for node in program.declarations if self._once(node)]
        for node in self.nodes:
            if isinstance(node, ConstantNode):
                self._constant(node)
        for node in self.nodes:
            if isinstance(node, EnumNode):
                self._enum(node)
        for node in self.nodes:
            if isinstance(node, BitsNode):
                self._bits(node)
        reader = LinkReader(self.evaluator, self.known)
        self.links: dict[str, Link] = {
            node.name.text: reader.read(node) for node in self.nodes if isinstance(node, LinkNode)
        }

    def _once(self, node: DeclarationNode) -> bool:
        what = _WHAT[type(node)]
        name = node.name
        if what == "type" and not self.types.may_be_declared(name):
            self.lost.add(name.text)
            return False
        first = self._first.setdefault((what, name.text), name)
        if first is name:
            return True
        message = f"{what} `{name.text}` is declared twice"
        labels = [(first.start, first.end, "first declared here")]
        self.reporter.report(
            "UL082", name.start, name.end, message, "give one of them another name", labels=labels
        )
        return False

    def known(self, node: Expression) -> bool:
        """In an expression outside of constructors: is every name a constant that was declared before?"""
        good = True
        for name in names_of(node):
            if name.text in self.constants or name.text in ("true", "false"):
                self.used.add(name.text)
            elif name.text in self.lost:
                good = False
            else:
                good = False
                message = f"there is no constant `{name.text}` before this"
                otherwise = f"declare it: `const {name.text} = …;`"
                at = (name.start, name.end)
                advice = self.reporter.did_you_mean(name.text, self.constants, otherwise, at)
                self.reporter.report("UL097", *at, message, advice)
        return good

    def integer(self, node: Expression, what: str, low: int, high: int) -> int | None:
        """Return a whole number from outside of constructors."""
        return self.evaluator.integer(node, _NOTHING, what, low, high) if self.known(node) else None

    def type(self, node: TypeNode) -> ValueType | None:
        """Return a type from outside of constructors."""
        known = [self.known(argument) for argument in node.arguments]
        self.used.add(node.name.text)
        return self.types.resolve(node, _NOTHING) if all(known) else None

    # --- constants and types --------------------------------------------------------------------------------

    def _constant(self, node: ConstantNode) -> None:
        value = self.evaluator.value(node.value, _NOTHING) if self.known(node.value) else None
        if value is None:
            self.lost.add(node.name.text)
        else:
            self.constants[node.name.text] = value

    def _enum(self, node: EnumNode) -> None:
        kind = self.type(node.type)
        name = node.name.text
        if kind is None or not self._is_word(node.type, kind):
            self.lost.add(name)
            return
        values: dict[str, EnumValue] = {}
        places: dict[str | int, Name] = {}
        for item in node.values:
            label = item.name
            number = self.integer(
                item.value, f"`{label.text}` of `{name}: {kind.text}`", 0, (1 << kind.width) - 1
            )
            if number is None:
                continue
            earlier = places.setdefault(label.text, label)
            if earlier is not label:
                message = f"`{label.text}` is in `{name}` twice"
                labels = [(earlier.start, earlier.end, "first declared here")]
                self.reporter.report(
                    "UL082", label.start, label.end, message, "give one another name", labels=labels
                )
                continue
            earlier = places.setdefault(number, label)
            if earlier is not label:
                message = f"`{label.text}` has the number {number}, which `{earlier.text}` has"
                labels = [(earlier.start, earlier.end, "first used here")]
                hint = "every value of an enumeration has a number of its own"
                self.reporter.report("UL083", item.value.start, item.value.end, message, hint, labels=labels)
                continue
            values[label.text] = EnumValue(label.text, number, item.notes.documentation)
        if not node.values:
            hint = "give at least one: `{ idle = 0; run = 1 }`"
            self.reporter.report("UL084", node.name.start, node.name.end, f"`{name}` has no values", hint)
        notes = annotations_of(node.notes, self.evaluator, _NOTHING)
        self.enums[name] = EnumType(
            name, kind.width, tuple(values.values()), node.open, node.notes.documentation, notes
        )

    def _is_word(self, node: TypeNode, kind: ValueType) -> bool:
        if kind.kind == "uint":
            return True
        message = f"`{kind.text}` is not what an enumeration or packed bits are made of"
        hint = "they lie in u1 to u64"
        self.reporter.report("UL081", node.name.start, node.end, message, hint)
        return False

    def _bits(self, node: BitsNode) -> None:
        kind = self.type(node.type)
        name = node.name.text
        if kind is None or not self._is_word(node.type, kind):
            self.lost.add(name)
            return
        fields: dict[str, Field] = {}
        owners: dict[int, FieldNode] = {}
        for item in node.fields:
            field = self._field(item, kind, name)
            if field is None:
                continue
            first = next((one for one in node.fields if one.name.text == field.name), item)
            if first is not item:
                message = f"`{field.name}` is in `{name}` twice"
                labels = [(first.name.start, first.name.end, "first declared here")]
                at = item.name.start, item.name.end
                self.reporter.report("UL082", *at, message, "give one of them another name", labels=labels)
                continue
            taken = next((owners[bit] for bit in range(field.low, field.high + 1) if bit in owners), None)
            if taken is not None:
                message = f"bits {field.high}..{field.low} overlap those of `{taken.name.text}`"
                end = (item.low or item.high).end
                labels = [(taken.high.start, (taken.low or taken.high).end, f"`{taken.name.text}` is here")]
                hint = "every field has bits of its own"
                self.reporter.report("UL085", item.high.start, end, message, hint, labels=labels)
                continue
            owners.update(dict.fromkeys(range(field.low, field.high + 1), item))
            fields[field.name] = field
        if not node.fields:
            hint = "give at least one: `{ ready: bool @ 0 }`"
            self.reporter.report("UL084", node.name.start, node.name.end, f"`{name}` has no fields", hint)
        ordered = tuple(fields.values())
        notes = annotations_of(node.notes, self.evaluator, _NOTHING)
        self.bits[name] = ValueType(
            "bits", kind.width, 0, None, ordered, name, node.notes.documentation, notes
        )

    def _field(self, node: FieldNode, word: ValueType, owner: str) -> Field | None:
        kind = self.type(node.type)
        what = f"a bit of `{owner}: {word.text}`"
        high = self.integer(node.high, what, 0, word.width - 1)
        low = high if node.low is None else self.integer(node.low, what, 0, word.width - 1)
        known = [self.known(one.argument) for one in node.properties if one.argument]
        if kind is None or high is None or low is None or not all(known):
            return None
        end = (node.low or node.high).end
        if low > high:
            message = f"bits {high}..{low} run backwards"
            advice = Advice(f"write `{low}..{high}`", ((node.high.start, end, f"{low}..{high}"),))
            self.reporter.report("UL086", node.high.start, end, message, advice)
            return None
        if kind.width != high - low + 1:
            message = f"`{node.name.text}: {kind.text}` has {kind.width} bits but is given {high - low + 1}"
            upper = low + kind.width - 1
            hint = f"give it bits `{upper}..{low}`" if kind.width > 1 else f"give it bit `{low}`"
            self.reporter.report("UL086", node.high.start, end, message, hint)
            return None
        facts = read_facts(node.properties, kind, self.evaluator, _NOTHING)
        if facts is None or not check_limits(facts, kind, self.reporter):
            return None
        return Field(
            node.name.text,
            kind,
            low,
            high,
            node.notes.documentation,
            facts.unit,
            facts.scale,
            facts.offset,
            facts.minimum,
            facts.maximum,
        )
