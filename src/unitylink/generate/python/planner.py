# SPDX-License-Identifier: BSD-3-Clause
"""Every decision about the generated module: the template only lays it out."""

from __future__ import annotations

import builtins
import keyword
import re
from collections.abc import Hashable, Iterator, Mapping
from dataclasses import dataclass

from unitylink.interface.wire_hash import wire_hashes
from unitylink.layer4_data.names import (
    ATTRIBUTE_NAMES,
    BINDING_VERSION,
    MODULE_NAMES,
    attribute_of,
    event_lines,
    python_names,
)
from unitylink.spec.model import Element, Group, Instance, LinkBinding, Publish, Spec
from unitylink.spec.model import Member as SpecMember
from unitylink.spec.types import INT32, UINT32
from unitylink.values import Quantity

from ..objects.documentation import places as _places
from ..objects.documentation import shown as _shown
from ..objects.documentation import value_facts
from ..objects.shapes import arrays, camel, relative, shape
from ..quoting import Python, file_name
from ..spec_plan import SpecPlan
from .modules import module_name, variable_name
from .text import WIDTH, Argument, Call, call, docstring, repeated
from .types import TypeClass, Types

# Access in the spec -> class of layer 4, and the method of Node that makes one.
VALUE_CLASSES_OF_ACCESS = {
    "READ": ("ReadValue", "_read"),
    "WRITE": ("WriteValue", "_write"),
    "READWRITE": ("ReadWriteValue", "_read_write"),
    "READCLEAR": ("ReadClearValue", "_read_clear"),
    "W1C": ("ClearValue", "_clear"),
    "PULSE": ("PulseValue", "_pulse"),
}
VALUE_CLASSES = ("ValueGroup", *(name for name, _ in VALUE_CLASSES_OF_ACCESS.values()))


@dataclass(frozen=True)
class Member:
    """An attribute of a class: its type, docstring, and the statement that makes it."""

    attribute: str
    type: Python
    documentation: Python
    statement: Python


@dataclass(frozen=True)
class Class:
    name: str
    documentation: Python
    signature: Python
    start: tuple[Python, ...]  # statements before those of the members
    members: tuple[Member, ...]


@dataclass(frozen=True)
class Table:
    """A module-level dict. Its values are already literals."""

    name: str
    type: Python
    rows: tuple[tuple[Python, str], ...]


@dataclass(frozen=True)
class Module:
    file: str
    source: str
    hash: str
    documentation: Python
    check: Python
    binding_version: int
    imports: Python
    standard: tuple[Python, ...]  # imports of the standard library
    types: tuple[TypeClass, ...]
    tables: tuple[Table, ...]
    classes: tuple[Class, ...]


def plan_module(plan: SpecPlan) -> Module:
    """Plan the module of a spec."""
    return _Planner(plan.spec).module()


class _Planner:
    """First names every class, in source order. Then plans each one from its first expansion."""

    def __init__(self, spec: Spec) -> None:
        self.spec = spec
        self.taken: set[str] = set(MODULE_NAMES)
        self.types = Types(spec, self._claim, camel)
        self.lines = {root.name: event_lines(spec, root) for root in spec.roots}
        self.root_class = {root.name: self._claim(camel(root.name)) for root in spec.roots}
        self.table_names = {root.name: self._claim_tables(self.root_class[root.name]) for root in spec.roots}
        self.class_table = self._claim("_CLASSES")
        self.shape_class: dict[Hashable, str] = {}
        # class -> (instance, link above it)
        self.expansions: dict[str, list[tuple[Instance, LinkBinding]]] = {}
        for root in spec.roots:
            self._collect(root)

    def _claim(self, name: str) -> str:
        """Take a module-level name: unchanged if it is free, else numbered."""
        name = f"{name}_" if keyword.iskeyword(name) else name
        free, number = name, 1
        while free in self.taken or hasattr(builtins, free):  # a spec may have a constructor `warning`
            number += 1
            free = f"{name}{number}"
        self.taken.add(free)
        return free

    def _claim_tables(self, name: str) -> tuple[str, str, str]:
        prefix = f"_{re.sub(r'(?<=[a-z0-9])(?=[A-Z])', '_', name).upper()}"
        return (
            self._claim(f"{prefix}_ADDRESSES"),
            self._claim(f"{prefix}_NAMES"),
            self._claim(f"{prefix}_GATEWARE"),
        )

    def _collect(self, instance: Instance) -> None:
        for part in instance.instances:
            found = shape(part, instance.link)
            if found not in self.shape_class:
                self.shape_class[found] = self._claim(camel(part.constructor))
            self.expansions.setdefault(self.shape_class[found], []).append((part, instance.link))
            self._collect(part)

    def module(self) -> Module:
        spec = self.spec
        roots = [self._root(root) for root in spec.roots]
        parts = [self._part(name, places) for name, places in self.expansions.items()]
        classes = (*roots, *parts)
        kinds = {member.type for item in classes for member in item.members}
        used = {name for name in VALUE_CLASSES for kind in kinds if re.search(rf"\b{name}\b", kind)}
        imports = {"Node", "Tree", "binding"} | used
        statements = [member.statement for item in classes for member in item.members]
        if self.types.classes or any("facts." in statement for statement in statements):
            imports.add("facts")
        standard = [Python("from dataclasses import dataclass")] if spec.bits else []
        package = f"{spec.package}." if spec.package else ""
        publics = ", ".join(f"`{name}`" for name in self.root_class.values())
        check = [
            "__file__",
            Python.of("source={}", Python.text(spec.source)),
            Python("spec_hash=SPEC_HASH"),
            Python.of("binding_version={}", BINDING_VERSION),
        ]
        return Module(
            file=f"{module_name(spec.name)}.py",
            source=file_name(spec.source),
            hash=spec.hash,
            documentation=docstring(
                0, f"What the spec `{package}{spec.name}` describes; start with {publics}."
            ),
            check=call(0, Python("binding.check"), check),
            binding_version=BINDING_VERSION,
            imports=_imports(sorted(imports, key=lambda name: (name.islower(), name))),
            standard=tuple(standard),
            types=tuple(self.types.classes),
            tables=tuple(table for root in spec.roots for table in self._tables(root)) + self._class_table(),
            classes=classes,
        )

    def _tables(self, root: Instance) -> tuple[Table, ...]:
        addresses, names, gateware = self.table_names[root.name]
        digits = max([3, *(len(f"{element.address:X}") for element in root.walk())])
        where = tuple((Python.text(e.path), f"0x{e.address:0{digits}X}") for e in root.walk())
        named = [item for item in _named(root) if item.display != item.path]
        shown = tuple((Python.text(item.path), Python.text(item.display)) for item in named)
        return (
            Table(addresses, Python("dict[str, int]"), where),
            Table(names, Python("dict[str, str]"), shown),
            Table(gateware, Python("dict[str, tuple[int, ...]]"), self._gateware(root)),
        )

    def _class_table(self) -> tuple[Table, ...]:
        names = self.types.names
        rows = tuple((Python.text(name), python) for name, python in names.items())
        return (Table(self.class_table, Python("dict[str, type]"), rows),) if rows else ()

    def _gateware(self, root: Instance) -> tuple[tuple[Python, str], ...]:
        """Return the hashes that the gateware behind each link may have."""
        hashes: dict[str, dict[int, None]] = {}
        for ctrl, comm in dict.fromkeys((e.link.ctrl, e.link.comm) for e in root.walk()):
            for name in (ctrl, comm):
                hashes.setdefault(name or "", {}).update(
                    dict.fromkeys(wire_hashes(self.spec, root.name, comm))
                )
        return tuple(
            (Python.text(name), Call("", [f"0x{h:016X}" for h in told]).flat())
            for name, told in hashes.items()
        )

    def _links(self, root: Instance, attributes: Mapping[str, str]) -> Python:
        """Return arguments that connect a public constructor to virtual boards, with one behind each link."""
        boards = {device.link.name: device.comm for device in self.spec.devices if device.root == root.name}
        if len(boards) > 1:
            chosen = [(link, attributes[comm] if comm else "") for link, comm in boards.items()]
        else:
            chosen = [(root.name if len(self.spec.boards) > 1 else "", "")]
        urls = [(f"sim:{self.spec.source}{f'?root={part}' if part else ''}", to) for part, to in chosen]
        connect = Python("unitylink.connect")
        return Python(", ").join(Call(connect, [Python.text(url)], to).flat() for url, to in urls)

    def _root(self, root: Instance) -> Class:
        name = self.root_class[root.name]
        addresses, names, gateware = self.table_names[root.name]
        attributes = python_names(root.parameters, {"self", "link", "tree", "super", *self.taken})
        parameters = [attributes[p] for p in root.parameters]
        words = sum(element.words for element in root.walk())
        links = " and ".join(f"`{p}`" for p in parameters)
        documentation = docstring(
            4,
            f"The public interface `{root.name}`: {words} words.",
            f"{links} default{'s' if len(parameters) == 1 else ''} to `link`." if parameters else "",
            f">>> {variable_name(root.name)} = {name}({self._links(root, attributes)})",
        )
        given = [Python.of("{}: {}", Python.text(p), attributes[p]) for p in root.parameters]
        tree = call(
            8,
            Python("tree = Tree"),
            [
                "link",
                Python.of("{{{}}}", Python(", ").join(given)),
                Python.of("source={}", Python.text(self.spec.source)),
                Python.of("gateware={}", gateware),
                Python.of("addresses={}", addresses),
                Python.of("names={}", names),
                *([Python.of("classes={}", self.class_table)] if self.types.names else []),
            ],
        )
        signature = call(
            4,
            Python("def __init__"),
            ["self", Python("link: Link"), *(Python.of("{}: Link | None = None", p) for p in parameters)],
            tail=Python(" -> None:"),
        )
        called = call(8, Python("super().__init__"), ["tree", Python.text(root.name)])
        start = [tree, called, self._bind(root.link)]
        return Class(name, documentation, signature, tuple(start), self._members([(root, root.link)]))

    def _part(self, name: str, places: list[tuple[Instance, LinkBinding]]) -> Class:
        instance, above = places[0]
        where = _places([f"`{place.path}`" for place, _ in places])
        start = [Python("super().__init__(parent, name)")]
        if instance.link != above:
            start.append(self._bind(instance.link))
        return Class(
            name,
            docstring(4, f"The constructor `{instance.constructor}`, expanded as {where}."),
            Python("def __init__(self, parent: Node, name: str) -> None:"),
            tuple(start),
            self._members(places),
        )

    @staticmethod
    def _bind(link: LinkBinding) -> Python:
        arguments = [Python.text(link.kind)]
        if link.base:
            arguments.append(Python.of("base=0x{:X}", link.base))
        arguments += [Python.of("ctrl={}", Python.text(link.ctrl))] if link.ctrl is not None else []
        arguments += [Python.of("comm={}", Python.text(link.comm))] if link.comm is not None else []
        arguments += [Python.of("size={}", link.size)] if link.size else []
        arguments += [Python.of("link={}", Python.text(link.link))] if link.link else []
        return call(8, Python("self._bind"), arguments)

    def _members(self, places: list[tuple[Instance, LinkBinding]]) -> tuple[Member, ...]:
        """Plan the members of a class: parts and values in source order, then the groups of them."""
        instance = places[0][0]
        names = dict.fromkeys(attribute_of(member) for member in instance.members)
        attributes = python_names(names, ATTRIBUTE_NAMES | self.taken)
        members = []
        for name, positions in arrays(instance).items():
            first = instance.members[positions[0]]
            here = [place.members[position] for place, _ in places for position in positions]
            attribute = attributes[name]
            if isinstance(first, Instance):
                members.append(self._instances(attribute, instance, positions, here))
            elif isinstance(first, Element):
                members.append(self._value(attribute, first, len(positions), here))
        for group in instance.groups:
            members.append(_group(attributes[group.name], group, instance))
        return tuple(members)

    def _instances(
        self, attribute: str, instance: Instance, positions: list[int], here: list[SpecMember]
    ) -> Member:
        parts = [item for item in here if isinstance(item, Instance)]
        own = [m for m in (instance.members[p] for p in positions) if isinstance(m, Instance)]
        kinds = [self.shape_class[shape(part, instance.link)] for part in own]
        text = docstring(4, parts[0].documentation, f"{_places([_shown(part) for part in parts])}.")
        if not own[0].array:
            head = Python.of("self.{} = {}", attribute, kinds[0])
            statement = call(8, head, ["self", Python.text(own[0].name)])
            return Member(attribute, Python.of("{}", kinds[0]), text, statement)
        if len(set(kinds)) == 1:
            made = Call(kinds[0], ["self", _item_of(own[0].array)])
            statement = repeated(8, Python.of("self.{} = tuple", attribute), made, len(own))
            return Member(attribute, Python.of("tuple[{}, ...]", kinds[0]), text, statement)
        each = [Call(kind, ["self", Python.text(part.name)]) for kind, part in zip(kinds, own, strict=True)]
        statement = call(8, Python.of("self.{} = ", attribute), each)
        return Member(attribute, Python.of("tuple[{}]", Python(", ").join(kinds)), text, statement)

    def _value(self, attribute: str, element: Element, count: int, here: list[SpecMember]) -> Member:
        elements = [item for item in here if isinstance(item, Element)]
        quantity = Quantity.of(element)
        cls, maker = VALUE_CLASSES_OF_ACCESS[element.access]
        kind = Python.of("{}[{}]", cls, self.types.python(quantity))
        name = _item_of(element.array) if element.array else Python.text(element.name)
        arguments: list[Argument] = [name]
        if quantity == Quantity(INT32):
            arguments.append(Python("signed=True"))
        elif quantity != Quantity(UINT32):
            arguments.append(self.types.quantity(quantity))
        if element.words > 1:
            arguments.append(Python.of("words={}", element.words))
        if element.checked:
            arguments.append(Python("checked=True"))
        if element.publish is not None and element.readable:
            arguments.append(_publish(element.publish))
            line = next((lines[element.path] for lines in self.lines.values() if element.path in lines), None)
            if line is not None and element.publish.trigger != "rate":
                arguments.append(Python.of("line={}", line))
        documentation = docstring(4, element.documentation, value_facts(element, quantity, elements))
        if not element.array:
            statement = call(8, Python.of("self.{} = self.{}", attribute, maker), arguments)
            return Member(attribute, kind, documentation, statement)
        made = Call(Python.of("self.{}", maker), arguments)
        statement = repeated(8, Python.of("self.{} = tuple", attribute), made, count)
        return Member(attribute, Python.of("tuple[{}, ...]", kind), documentation, statement)


def _item_of(array: str) -> Python:
    """Return the name of item `i` of an array, as an expression."""
    return Python.of('f"{}[{{i}}]"', array)


def _publish(publish: Publish) -> Argument:
    if publish.trigger == "rate" and not publish.group:
        return Python.of("publish=({}, {})", publish.mode, publish.divisor)
    facts = [Python.of("{}", publish.mode), Python.of("{}", publish.divisor)]
    facts += [Python.of("trigger={}", Python.text(publish.trigger))] if publish.trigger != "rate" else []
    facts += [Python.of("event={}", Python.text(publish.event))] if publish.event else []
    facts += [Python.of("group={}", Python.text(publish.group))] if publish.group else []
    return Call("facts.Publish", facts, "publish")


def _group(attribute: str, group: Group, instance: Instance) -> Member:
    paths = relative(group, instance)
    arguments = [Python.text(text) for text in (group.name, *paths)]
    documentation = docstring(4, f"{len(paths)} words together: {_places(list(paths))}.")
    statement = call(8, Python.of("self.{} = self._group", attribute), arguments)
    return Member(attribute, Python("ValueGroup"), documentation, statement)


def _named(instance: Instance) -> Iterator[Instance | Element]:
    for member in instance.members:
        if isinstance(member, Element):
            yield member
        elif isinstance(member, Instance):
            yield member
            yield from _named(member)


def _imports(names: list[str]) -> Python:
    line = Python.of("from unitylink.layer4_data import {}", Python(", ").join(names))
    if len(line) <= WIDTH:
        return line
    rows = Python("").join(Python.of("    {},\n", name) for name in names)
    return Python.of("from unitylink.layer4_data import (\n{})", rows)
