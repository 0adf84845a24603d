# SPDX-License-Identifier: BSD-3-Clause
"""Every decision about the generated module: the template only lays it out."""

from __future__ import annotations

import builtins
import keyword
import re
from collections.abc import Hashable, Iterator, Mapping
from dataclasses import dataclass

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
from unitylink.wire_hash import wire_hashes

from ..kept import kept
from .said import places as _places
from .said import shown as _shown
from .said import value_facts
from .text import WIDTH, Call, call, docstring, quoted, repeated
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
    type: str
    documentation: str
    statement: str


@dataclass(frozen=True)
class Class:
    name: str
    documentation: str
    signature: str
    start: tuple[str, ...]  # statements before the members'
    members: tuple[Member, ...]


@dataclass(frozen=True)
class Table:
    """A module-level dict; values are already literals."""

    name: str
    type: str
    rows: tuple[tuple[str, str], ...]


@dataclass(frozen=True)
class Module:
    file: str
    source: str
    hash: str
    documentation: str
    check: str
    binding_version: int
    imports: str
    standard: tuple[str, ...]  # imports of the standard library
    types: tuple[TypeClass, ...]
    tables: tuple[Table, ...]
    classes: tuple[Class, ...]


@kept
def plan(spec: Spec) -> Module:
    """Plan the module of a spec."""
    return _Planner(spec).module()


class _Planner:
    """Names every class first, in source order, then plans each from its first expansion."""

    def __init__(self, spec: Spec) -> None:
        self.spec = spec
        self.taken: set[str] = set(MODULE_NAMES)
        self.types = Types(spec, self._claim, _camel)
        self.lines = {root.name: event_lines(spec, root) for root in spec.roots}
        self.root_class = {root.name: self._claim(_camel(root.name)) for root in spec.roots}
        self.table_names = {root.name: self._claim_tables(self.root_class[root.name]) for root in spec.roots}
        self.class_table = self._claim("_CLASSES")
        self.shape_class: dict[Hashable, str] = {}
        self.expansions: dict[str, list[tuple[Instance, LinkBinding]]] = {}  # class -> (where, link above)
        for root in spec.roots:
            self._collect(root)

    def _claim(self, name: str) -> str:
        """Take a module-level name: unchanged where it is free, else numbered."""
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
            shape = _shape(part, instance.link)
            if shape not in self.shape_class:
                self.shape_class[shape] = self._claim(_camel(part.constructor))
            self.expansions.setdefault(self.shape_class[shape], []).append((part, instance.link))
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
        standard = ["from dataclasses import dataclass"] if spec.bits else []
        package = f"{spec.package}." if spec.package else ""
        publics = ", ".join(f"`{name}`" for name in self.root_class.values())
        check = [
            "__file__",
            f"source={quoted(spec.source)}",
            "spec_hash=SPEC_HASH",
            f"binding_version={BINDING_VERSION}",
        ]
        return Module(
            file=f"{_module_name(spec.name)}.py",
            source=_one_line(spec.source),
            hash=spec.hash,
            documentation=docstring(
                0, f"What the spec `{package}{spec.name}` describes; start with {publics}."
            ),
            check=call(0, "binding.check", check),
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
        where = tuple((quoted(e.path), f"0x{e.address:0{digits}X}") for e in root.walk())
        shown = tuple((quoted(i.path), quoted(i.display)) for i in _named(root) if i.display != i.path)
        return (
            Table(addresses, "dict[str, int]", where),
            Table(names, "dict[str, str]", shown),
            Table(gateware, "dict[str, tuple[int, ...]]", self._gateware(root)),
        )

    def _class_table(self) -> tuple[Table, ...]:
        names = self.types.names
        rows = tuple((quoted(name), python) for name, python in names.items())
        return (Table(self.class_table, "dict[str, type]", rows),) if rows else ()

    def _gateware(self, root: Instance) -> tuple[tuple[str, str], ...]:
        """Return what hashes the gateware behind each link may have."""
        hashes: dict[str, dict[int, None]] = {}
        for ctrl, comm in dict.fromkeys((e.link.ctrl, e.link.comm) for e in root.walk()):
            for name in (ctrl, comm):
                hashes.setdefault(name or "", {}).update(
                    dict.fromkeys(wire_hashes(self.spec, root.name, comm))
                )
        return tuple(
            (quoted(name), Call("", [f"0x{h:016X}" for h in told]).flat()) for name, told in hashes.items()
        )

    def _links(self, root: Instance, attributes: Mapping[str, str]) -> str:
        """Return arguments that connect a public constructor to virtual boards, one behind each link."""
        boards = {device.link.name: device.comm for device in self.spec.devices if device.root == root.name}
        if len(boards) > 1:
            chosen = [(link, f"{attributes[comm]}=" if comm else "") for link, comm in boards.items()]
        else:
            chosen = [(root.name if len(self.spec.boards) > 1 else "", "")]
        urls = [(f"sim:{self.spec.source}{f'?root={part}' if part else ''}", to) for part, to in chosen]
        return ", ".join(f"{to}unitylink.connect({quoted(url)})" for url, to in urls)

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
            f">>> {_module_name(root.name)} = {name}({self._links(root, attributes)})",
        )
        given = ", ".join(f"{quoted(p)}: {attributes[p]}" for p in root.parameters)
        tree = call(
            8,
            "tree = Tree",
            [
                "link",
                f"{{{given}}}",
                f"source={quoted(self.spec.source)}",
                f"gateware={gateware}",
                f"addresses={addresses}",
                f"names={names}",
                *([f"classes={self.class_table}"] if self.types.names else []),
            ],
        )
        signature = call(
            4,
            "def __init__",
            ["self", "link: Link", *(f"{p}: Link | None = None" for p in parameters)],
            tail=" -> None:",
        )
        start = [tree, call(8, "super().__init__", ["tree", quoted(root.name)]), self._bind(root.link)]
        return Class(name, documentation, signature, tuple(start), self._members([(root, root.link)]))

    def _part(self, name: str, places: list[tuple[Instance, LinkBinding]]) -> Class:
        instance, above = places[0]
        where = _places([f"`{place.path}`" for place, _ in places])
        start = ["super().__init__(parent, name)"]
        if instance.link != above:
            start.append(self._bind(instance.link))
        return Class(
            name,
            docstring(4, f"The constructor `{instance.constructor}`, expanded as {where}."),
            "def __init__(self, parent: Node, name: str) -> None:",
            tuple(start),
            self._members(places),
        )

    @staticmethod
    def _bind(link: LinkBinding) -> str:
        arguments = [quoted(link.kind)]
        if link.base:
            arguments.append(f"base=0x{link.base:X}")
        arguments += [f"ctrl={quoted(link.ctrl)}"] if link.ctrl is not None else []
        arguments += [f"comm={quoted(link.comm)}"] if link.comm is not None else []
        arguments += [f"size={link.size}"] if link.size else []
        arguments += [f"link={quoted(link.link)}"] if link.link else []
        return call(8, "self._bind", arguments)

    def _members(self, places: list[tuple[Instance, LinkBinding]]) -> tuple[Member, ...]:
        """Plan the members of a class: parts and values in source order, then the groups of them."""
        instance = places[0][0]
        names = dict.fromkeys(attribute_of(member) for member in instance.members)
        attributes = python_names(names, ATTRIBUTE_NAMES | self.taken)
        members = []
        for name, positions in _arrays(instance).items():
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
        kinds = [self.shape_class[_shape(part, instance.link)] for part in own]
        text = docstring(4, parts[0].documentation, f"{_places([_shown(part) for part in parts])}.")
        if not own[0].array:
            statement = call(8, f"self.{attribute} = {kinds[0]}", ["self", quoted(own[0].name)])
            return Member(attribute, kinds[0], text, statement)
        if len(set(kinds)) == 1:
            made = Call(kinds[0], ["self", f'f"{own[0].array}[{{i}}]"'])
            statement = repeated(8, f"self.{attribute} = tuple", made, len(own))
            return Member(attribute, f"tuple[{kinds[0]}, ...]", text, statement)
        each = [Call(kind, ["self", quoted(part.name)]) for kind, part in zip(kinds, own, strict=True)]
        return Member(attribute, f"tuple[{', '.join(kinds)}]", text, call(8, f"self.{attribute} = ", each))

    def _value(self, attribute: str, element: Element, count: int, here: list[SpecMember]) -> Member:
        elements = [item for item in here if isinstance(item, Element)]
        quantity = Quantity.of(element)
        cls, maker = VALUE_CLASSES_OF_ACCESS[element.access]
        kind = f"{cls}[{self.types.python(quantity)}]"
        arguments: list[str | Call] = [quoted(element.name)]
        if element.array:
            arguments = [f'f"{element.array}[{{i}}]"']
        if quantity == Quantity(INT32):
            arguments.append("signed=True")
        elif quantity != Quantity(UINT32):
            arguments.append(self.types.quantity(quantity))
        if element.words > 1:
            arguments.append(f"words={element.words}")
        if element.checked:
            arguments.append("checked=True")
        if element.publish is not None and element.readable:
            arguments.append(_publish(element.publish))
            line = next((lines[element.path] for lines in self.lines.values() if element.path in lines), None)
            if line is not None and element.publish.trigger != "rate":
                arguments.append(f"line={line}")
        documentation = docstring(4, element.documentation, value_facts(element, quantity, elements))
        if not element.array:
            statement = call(8, f"self.{attribute} = self.{maker}", arguments)
            return Member(attribute, kind, documentation, statement)
        statement = repeated(8, f"self.{attribute} = tuple", Call(f"self.{maker}", arguments), count)
        return Member(attribute, f"tuple[{kind}, ...]", documentation, statement)


def _arrays(instance: Instance) -> dict[str, list[int]]:
    """Return the positions of the members by attribute: several for the parts of an array."""
    found: dict[str, list[int]] = {}
    for position, member in enumerate(instance.members):
        if not isinstance(member, Group):
            found.setdefault(attribute_of(member), []).append(position)
    return found


def _publish(publish: Publish) -> str | Call:
    if publish.trigger == "rate" and not publish.group:
        return f"publish=({publish.mode}, {publish.divisor})"
    facts = [str(publish.mode), str(publish.divisor)]
    facts += [f"trigger={quoted(publish.trigger)}"] if publish.trigger != "rate" else []
    facts += [f"event={quoted(publish.event)}"] if publish.event else []
    facts += [f"group={quoted(publish.group)}"] if publish.group else []
    return Call("facts.Publish", facts, "publish=")


def _group(attribute: str, group: Group, instance: Instance) -> Member:
    paths = _relative(group, instance)
    arguments = [quoted(group.name), *(quoted(path) for path in paths)]
    documentation = docstring(4, f"{len(paths)} words together: {_places(list(paths))}.")
    return Member(
        attribute, "ValueGroup", documentation, call(8, f"self.{attribute} = self._group", arguments)
    )


def _shape(instance: Instance, above: LinkBinding) -> Hashable:
    """Return what decides about the class: two expansions with the same shape share one."""
    members: list[Hashable] = []
    for member in instance.members:
        if isinstance(member, Instance):
            members.append((member.name, member.array, member.documentation, _shape(member, instance.link)))
        elif isinstance(member, Element):
            facts = (
                member.access,
                Quantity.of(member),
                member.words,
                member.checked,
                member.publish,
                member.documentation,
                member.array,
            )
            members.append((member.name, facts))
        else:
            members.append((member.name, _relative(member, instance)))
    own = instance.link if instance.link != above else None
    return (instance.constructor, own, tuple(members))


def _relative(group: Group, instance: Instance) -> tuple[str, ...]:
    start = len(instance.path) + 1 if instance.path else 0
    return tuple(element.path[start:] for element in group.elements)


def _named(instance: Instance) -> Iterator[Instance | Element]:
    for member in instance.members:
        if isinstance(member, Element):
            yield member
        elif isinstance(member, Instance):
            yield member
            yield from _named(member)


def _one_line(text: str) -> str:
    return "".join(c if c.isprintable() else "?" for c in text)


def _camel(name: str) -> str:
    """Return a class name: `servo_left` -> ServoLeft, `_2nd` -> N2nd."""
    joined = "".join(step[:1].upper() + step[1:] for step in name.split("_"))
    return joined if joined.isidentifier() else f"N{joined}"


def _module_name(name: str) -> str:
    plain = re.sub(r"\W", "_", name, flags=re.ASCII)
    plain = plain if plain.isidentifier() else f"n{plain}"
    return f"{plain}_" if keyword.iskeyword(plain) else plain


def _imports(names: list[str]) -> str:
    line = f"from unitylink.layer4_data import {', '.join(names)}"
    if len(line) <= WIDTH:
        return line
    return "from unitylink.layer4_data import (\n" + "".join(f"    {name},\n" for name in names) + ")"
