# SPDX-License-Identifier: BSD-3-Clause
"""Enumerations and packed values as Python classes, and their description for the codec."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field

from unitylink.spec.model import Spec
from unitylink.spec.types import EnumType, Field, ValueType
from unitylink.values import Quantity, field_names, member_names

from ..quoting import Part, Python
from .text import Argument, Call, call, docstring


@dataclass(frozen=True)
class TypeMember:
    """A line of an enumeration (`run = 1`) or of a record (`mode: Mode`), with its documentation."""

    text: Python
    documentation: Python


@dataclass(frozen=True)
class TypeClass:
    """A class of the generated module that is not a Node."""

    name: str
    head: Python  # decorators and the class line
    documentation: Python
    members: tuple[TypeMember, ...]
    constant: Python  # the statement that describes it to the codec


@dataclass
class Types:
    """The types of a spec, with their names in the module. `claim` reserves a free name."""

    spec: Spec
    claim: Callable[[str], str]
    camel: Callable[[str], str]
    classes: list[TypeClass] = field(default_factory=list)
    names: dict[str, str] = field(default_factory=dict)  # type in the spec -> class
    constants: dict[str, str] = field(default_factory=dict)  # type in the spec -> constant

    def __post_init__(self) -> None:
        for enum in self.spec.enums:
            self._name(enum.name)
            self.classes.append(self._enum(enum))
        for bits in self.spec.bits:
            self._name(bits.name)
            self.classes.append(self._bits(bits))

    def _name(self, name: str) -> None:
        self.names[name] = self.claim(self.camel(name))
        self.constants[name] = self.claim(f"_{name.upper().lstrip('_')}_TYPE")

    def python(self, quantity: Quantity) -> Python:
        """Return the Python type of a value."""
        kind = quantity.type
        if kind.kind == "enum" and kind.enum is not None:
            name = self.names[kind.enum.name]
            return Python.of("{} | int" if kind.enum.open else "{}", name)
        if kind.kind == "bits":
            return Python.of("{}", self.names[kind.name])
        if kind.kind == "bool":
            return Python("bool")
        return Python("float") if quantity.scaled or kind.kind == "float" else Python("int")

    def expression(self, kind: ValueType) -> Argument:
        """Return the code of the type in the generated module."""
        if kind.kind == "enum" and kind.enum is not None:
            return self.constants[kind.enum.name]
        if kind.kind == "bits":
            return self.constants[kind.name]
        if kind.bus:
            return "facts.INT32" if kind.signed else "facts.UINT32"
        fraction = [Python.of("fraction={}", kind.fraction)] if kind.fraction else []
        return Call("facts.ValueType", [Python.text(kind.kind), str(kind.width), *fraction])

    def quantity(self, quantity: Quantity, keyword: str = "quantity") -> Call:
        """Return the code of a quantity in the generated module."""
        names = ("scale", "offset", "unit", "minimum", "maximum", "overflow", "initial", "safe")
        arguments = [self.expression(quantity.type), *_given(quantity, Quantity(), names)]
        return Call("facts.Quantity", arguments, keyword)

    def _enum(self, enum: EnumType) -> TypeClass:
        names = member_names(enum)
        name, constant = self.names[enum.name], self.constants[enum.name]
        members = [
            TypeMember(Python.of("{} = {}", names[item.name], item.value), _said(item.documentation))
            for item in enum.values
        ]
        values = [
            Call("facts.EnumValue", [Python.text(item.name), Python.of("{}", item.value)])
            for item in enum.values
        ]
        described: list[Argument] = [Python.text(enum.name), str(enum.width), Call("", values)]
        described += [Python("open=True")] if enum.open else []
        arguments: list[Argument] = [
            Python.text("enum"),
            str(enum.width),
            Call("facts.EnumType", described, "enum"),
            Python.of("name={}", Python.text(enum.name)),
        ]
        other = "; other numbers stay numbers" if enum.open else ""
        return TypeClass(
            name,
            Python.of("class {}(facts.Enumeration):", name),
            docstring(4, enum.documentation, f"The enumeration `{enum.name}` of {enum.width} bits{other}."),
            tuple(members),
            call(0, Python.of("{} = facts.ValueType", constant), arguments),
        )

    def _bits(self, bits: ValueType) -> TypeClass:
        names = field_names(bits)
        name, constant = self.names[bits.name], self.constants[bits.name]
        members = [
            TypeMember(
                Python.of("{}: {}", names[one.name], self.python(Quantity.of(one))),
                _said(one.documentation, f"Bits {one.high} to {one.low}{_in_unit(one)}."),
            )
            for one in bits.fields
        ]
        fields = [self._field(one) for one in bits.fields]
        arguments: list[Argument] = [
            Python.text("bits"),
            str(bits.width),
            Call("", fields, "fields"),
            Python.of("name={}", Python.text(bits.name)),
        ]
        return TypeClass(
            name,
            Python.of("@dataclass(frozen=True)\nclass {}:", name),
            docstring(4, bits.documentation, f"The packed value `{bits.name}` of {bits.width} bits."),
            tuple(members),
            call(0, Python.of("{} = facts.ValueType", constant), arguments),
        )

    def _field(self, one: Field) -> Call:
        place = [Python.text(one.name), self.expression(one.type), str(one.low), str(one.high)]
        names = ("unit", "scale", "offset", "minimum", "maximum")
        return Call("facts.Field", [*place, *_given(one, Field("", one.type, 0, 0), names)])


def _given(thing: object, standard: object, names: Iterable[str]) -> Iterator[Python]:
    """Yield `name=value` for everything that differs from the default."""
    for name in names:
        value: Part = getattr(thing, name)
        if value != getattr(standard, name):
            yield Python.of("{}={}", name, Python.text(value) if isinstance(value, str) else value)


def _said(*paragraphs: str) -> Python:
    return docstring(4, *paragraphs) if any(paragraphs) else Python("")


def _in_unit(one: Field) -> str:
    return f", in {one.unit}" if one.unit else ""
