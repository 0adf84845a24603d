# SPDX-License-Identifier: BSD-3-Clause
"""Every decision about the generated module: the template only lays it out."""

from __future__ import annotations

import builtins
import keyword
import re
from collections.abc import Hashable, Iterator
from dataclasses import dataclass

from unitylink import protocol
from unitylink.layer4_data.binding import BINDING_VERSION
from unitylink.layer4_data.names import ATTRIBUTE_NAMES, MODULE_NAMES, python_names
from unitylink.spec.model import Element, Group, Instance, LinkBinding, Spec

from .text import WIDTH, call, docstring, quoted

PLACES_SHOWN = 6  # expansions named in a docstring; the address table has them all


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
    tables: tuple[Table, ...]
    classes: tuple[Class, ...]


def plan(spec: Spec) -> Module:
    """Plan the module of a spec."""
    return _Planner(spec).module()


class _Planner:
    """Names every class first, in source order, then plans each from its first expansion."""

    def __init__(self, spec: Spec) -> None:
        self.spec = spec
        self.taken: set[str] = set(MODULE_NAMES)
        self.root_class = {root.name: self._claim(_camel(root.name)) for root in spec.roots}
        self.table_names = {root.name: self._claim_tables(self.root_class[root.name]) for root in spec.roots}
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

    def _claim_tables(self, name: str) -> tuple[str, str]:
        prefix = f"_{re.sub(r'(?<=[a-z0-9])(?=[A-Z])', '_', name).upper()}"
        return self._claim(f"{prefix}_ADDRESSES"), self._claim(f"{prefix}_NAMES")

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
        used = {member.type for item in classes for member in item.members}
        imports = {"Node", "Tree", "binding"} | (used & {"ReadValue", "WriteValue", "ValueGroup"})
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
            tables=tuple(table for root in spec.roots for table in self._tables(root)),
            classes=classes,
        )

    def _tables(self, root: Instance) -> tuple[Table, Table]:
        addresses, names = self.table_names[root.name]
        digits = max([3, *(len(f"{element.address:X}") for element in root.walk())])
        where = tuple((quoted(e.path), f"0x{e.address:0{digits}X}") for e in root.walk())
        shown = tuple((quoted(i.path), quoted(i.display)) for i in _named(root) if i.display != i.path)
        return Table(addresses, "dict[str, int]", where), Table(names, "dict[str, str]", shown)

    def _root(self, root: Instance) -> Class:
        name = self.root_class[root.name]
        addresses, names = self.table_names[root.name]
        attributes = python_names(root.parameters, {"self", "link", "tree", "super", *self.taken})
        parameters = [attributes[p] for p in root.parameters]
        words = sum(1 for _ in root.walk())
        links = " and ".join(f"`{p}`" for p in parameters)
        documentation = docstring(
            4,
            f"The public interface `{root.name}`: {words} words.",
            f"{links} default{'s' if len(parameters) == 1 else ''} to `link`." if parameters else "",
            f">>> {_module_name(root.name)} = {name}(unitylink.connect({quoted('sim:' + self.spec.source)}))",
        )
        given = ", ".join(f"{quoted(p)}: {attributes[p]}" for p in root.parameters)
        tree = call(
            8,
            "tree = Tree",
            ["link", f"{{{given}}}", f"addresses={addresses}", f"names={names}"],
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
        return call(8, "self._bind", arguments)

    def _members(self, places: list[tuple[Instance, LinkBinding]]) -> tuple[Member, ...]:
        """Plan the members of a class: parts and values in source order, then the groups of them."""
        instance = places[0][0]
        attributes = python_names([m.name for m in instance.members], ATTRIBUTE_NAMES | self.taken)
        members = []
        for index, member in enumerate(instance.members):
            attribute = attributes[member.name]
            here = [place.members[index] for place, _ in places]
            if isinstance(member, Instance):
                kind = self.shape_class[_shape(member, instance.link)]
                text = _places([_shown(item) for item in here if isinstance(item, Instance)])
                statement = call(8, f"self.{attribute} = {kind}", ["self", quoted(member.name)])
                members.append(Member(attribute, kind, docstring(4, f"{text}."), statement))
            elif isinstance(member, Element):
                elements = [item for item in here if isinstance(item, Element)]
                members.append(_value(attribute, member, elements))
        for group in instance.groups:
            members.append(_group(attributes[group.name], group, instance))
        return tuple(members)


def _value(attribute: str, element: Element, here: list[Element]) -> Member:
    arguments = [quoted(element.name)]
    facts = [element.access, "signed" if element.signed else "unsigned"]
    if element.signed:
        arguments.append("signed=True")
    if element.checked:
        arguments.append("checked=True")
        facts.append("checksummed")
    if element.unit:
        arguments.append(f"unit={quoted(element.unit)}")
        facts.append(f"in {element.unit}")
    if element.publish is not None:
        if element.access == "READ":
            arguments.append(f"publish=({element.publish.mode}, {element.publish.divisor})")
        who = "by the gateware" if element.publish.mode == 1 else "by polling"
        rate = protocol.BASE_HZ_DEFAULT / element.publish.divisor
        base = f"the base rate / {element.publish.divisor} ({rate:g} Hz of {protocol.BASE_HZ_DEFAULT} Hz)"
        facts.append(f"published {who} at {base}")
    where = _places([f"{e.path} at 0x{e.address:03X}{_called(e)}" for e in here])
    kind, maker = ("ReadValue", "_read") if element.access == "READ" else ("WriteValue", "_write")
    documentation = docstring(4, element.documentation, f"{', '.join(facts)}: {where}.")
    return Member(attribute, kind, documentation, call(8, f"self.{attribute} = self.{maker}", arguments))


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
            members.append((member.name, _shape(member, instance.link)))
        elif isinstance(member, Element):
            publish = (member.publish.mode, member.publish.divisor) if member.publish else None
            facts = (member.access, member.signed, member.checked, publish, member.unit, member.documentation)
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


def _places(texts: list[str]) -> str:
    more = len(texts) - PLACES_SHOWN
    shown = texts if more <= 1 else [*texts[:PLACES_SHOWN], f"... ({len(texts)} in all)"]
    return ", ".join(shown)


def _shown(instance: Instance) -> str:
    return f"`{instance.path}`{_called(instance)}"


def _called(item: Instance | Element) -> str:
    return f" ({item.display})" if item.display != item.path else ""


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
