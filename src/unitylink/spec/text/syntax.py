# SPDX-License-Identifier: BSD-3-Clause
"""The syntax tree of the text, before names have a meaning. Offsets count characters from 0."""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction
from typing import Union


@dataclass(slots=True)
class Name:
    """A name at its place in the text."""

    text: str
    start: int
    end: int


@dataclass(slots=True)
class Number:
    """A number at its place in the text, with its unit. A whole value beyond 64 bits is kept as 2**64."""

    value: int | Fraction
    start: int
    end: int
    unit: str = ""


@dataclass(slots=True)
class Text:
    """A string literal. `value` is without quotes and escapes."""

    value: str
    start: int
    end: int


@dataclass(slots=True)
class Operation:
    """`left operator right`. Without `left`, the operator is a sign."""

    operator: str
    left: Expression | None
    right: Expression
    start: int
    end: int


@dataclass(slots=True)
class Argument:
    """A sum of parts: joined strings and parameters, or numbers. `key` is the name in `key=…`."""

    parts: list[Expression]
    start: int
    end: int
    key: Name | None = None

    @property
    def literal(self) -> bool:
        """Is it a single number or string, as most arguments are? Then it contains no names."""
        return len(self.parts) == 1 and type(self.parts[0]) in (Number, Text)


@dataclass(slots=True)
class Path:
    """`wheel.position` or `wheel[0].position`: an element of another member, to which a wire leads."""

    steps: list[Step]
    start: int
    end: int

    @property
    def text(self) -> str:
        return ".".join(f"{step.name.text}[…]" if step.index else step.name.text for step in self.steps)


Expression = Union[Number, Text, Name, Operation, Argument, Path]


@dataclass(slots=True)
class Property:
    """`ID=…`, `CRC`, `PUBLISH(…)`, `CTRL=…`, `UNIT=…`. `key` is COMM also for UART."""

    key: str
    start: int
    end: int
    argument: Argument | None = None  # what stands after the `=`
    publish: PublishNode | None = None

    @property
    def name(self) -> Name | None:
        """The name, if the argument is a single name."""
        part = self.argument.parts[0] if self.argument and len(self.argument.parts) == 1 else None
        return part if isinstance(part, Name) else None


@dataclass(slots=True)
class PublishNode:
    """`PUBLISH(mode, divisor)`, `PUBLISH(100 Hz)` or `PUBLISH(on name)`. Each may also have `GROUP=name`."""

    rates: list[Argument]  # mode and divisor, or a frequency
    event: list[Step]  # `on change`, `on a.b` and `on a[1].b`
    group: Name | None

    @property
    def arguments(self) -> list[Argument]:
        """All expressions: the rates, and the indexes of an event."""
        return [*self.rates, *(step.index for step in self.event if step.index is not None)]


@dataclass(slots=True)
class Binding:
    """`@ (0x1,0x2)`, `@l=(0x1,0x2)`, `@l=0x1` or `@ 0x1` after an expansion."""

    name: Name | None
    numbers: list[Expression]
    start: int
    end: int


@dataclass(slots=True)
class Step:
    """One step of a group's path: a name, `name[2]` of an array, or `ALL(constructor)`."""

    name: Name
    all: bool
    index: Argument | None = None


@dataclass(frozen=True, slots=True)
class Notes:
    """The `///` text and the annotations before a declaration."""

    documentation: str = ""
    annotations: tuple[AnnotationNode, ...] = ()


NO_NOTES = Notes()


@dataclass(slots=True)
class AnnotationNode:
    """`@name(arguments)`"""

    name: Name
    arguments: list[Argument]


@dataclass(slots=True)
class LinkKindNode:
    """`TOSNET(CTRL=…, COMM=…, BASE=…)`, `MEMORY(…)`, `DOUBLE_BUFFER(…)`, `FIFO(…)`"""

    kind: str
    properties: list[Property]
    start: int
    end: int


@dataclass(slots=True)
class ExpansionNode:
    """`name[count]: constructor(arguments) bindings`.

    It `forwards` if it is `@name: constructor(arguments)`.
    """

    name: Name
    callee: Name
    arguments: list[Argument]
    bindings: list[Binding]
    forwards: bool
    count: Argument | None = None
    notes: Notes = NO_NOTES


@dataclass(slots=True)
class TypeNode:
    """`u8`, `fixed(8,8)`, the name of an enumeration or of packed bits."""

    name: Name
    arguments: list[Argument]
    end: int


@dataclass(slots=True)
class ElementNode:
    """`@name[count] = address: type ACCESS(properties)`.

    `fixed` is the address, and `type` is None if there is none.
    """

    name: Name
    fixed: Expression | None
    type: TypeNode | None
    access: str
    properties: list[Property]
    count: Argument | None = None
    notes: Notes = NO_NOTES


@dataclass(slots=True)
class GroupNode:
    """`name = path, path`"""

    name: Name
    paths: list[list[Step]]
    notes: Notes = NO_NOTES


@dataclass(slots=True)
class BrokenNode:
    """A member with a syntax error.

    Its name stays known, so its uses are not reported as further mistakes.
    """

    name: Name


MemberNode = Union[LinkKindNode, ExpansionNode, ElementNode, GroupNode, BrokenNode]


@dataclass(slots=True)
class Parameter(Name):
    """`name`, `name: int` or `name: string = "left"`. Without a type, it is a string or a run-time object."""

    type: Name | None = None
    default: Argument | None = None


@dataclass(slots=True)
class ConstructorNode:
    """A constructor.

    It is `broken` if its head has a syntax error, so that its parameters are unknown. It is `incomplete` if
    members may be missing.
    """

    public: bool
    name: Name
    parameters: list[Parameter] = field(default_factory=list)
    addresses: list[Name] = field(default_factory=list)
    tuple_form: bool = False  # `@ (a,b)` divides one vector; otherwise each address is a vector
    block: Argument | None = None  # `@ name[words]`: the only address is the first of so many words
    members: list[MemberNode] = field(default_factory=list)
    broken: bool = False
    incomplete: bool = False
    notes: Notes = NO_NOTES


@dataclass(slots=True)
class ImportNode:
    """`import "file.ul";`"""

    file: Text


@dataclass(slots=True)
class ConstantNode:
    """`const NAME = expression;`"""

    name: Name
    value: Argument
    notes: Notes = NO_NOTES


@dataclass(slots=True)
class EnumValueNode:
    """`name = number` of an enumeration."""

    name: Name
    value: Argument
    notes: Notes = NO_NOTES


@dataclass(slots=True)
class EnumNode:
    """`open enum NAME: u2 { values }`"""

    name: Name
    open: bool
    type: TypeNode
    values: list[EnumValueNode]
    notes: Notes = NO_NOTES


@dataclass(slots=True)
class FieldNode:
    """`name: type @ high..low (properties)` of packed bits. `low` is None for a single bit."""

    name: Name
    type: TypeNode
    high: Argument
    low: Argument | None
    properties: list[Property]
    notes: Notes = NO_NOTES


@dataclass(slots=True)
class BitsNode:
    """`bits NAME: u8 { fields }`"""

    name: Name
    type: TypeNode
    fields: list[FieldNode]
    notes: Notes = NO_NOTES


@dataclass(slots=True)
class LinkNode:
    """`link NAME (properties);`"""

    name: Name
    properties: list[Property]
    notes: Notes = NO_NOTES


DeclarationNode = Union[ConstantNode, EnumNode, BitsNode, LinkNode]


@dataclass(slots=True)
class Program:
    """A whole file. It is `damaged` if part of it could not be read. Then names may be missing."""

    package: str = ""
    name: str = ""
    constructors: list[ConstructorNode] = field(default_factory=list)
    imports: list[ImportNode] = field(default_factory=list)
    declarations: list[DeclarationNode] = field(default_factory=list)
    lost: set[str] = field(default_factory=set)  # names of declarations with a mistake
    damaged: bool = False
