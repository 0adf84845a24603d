# SPDX-License-Identifier: BSD-3-Clause
"""The tree of values of a Spec, made at run time.

It is the same as that of generated code, but without a file.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from unitylink.errors import BindingError, DeviceMismatch, shown
from unitylink.interface.wire_hash import wire_hashes
from unitylink.spec.model import Element, Group, Instance, Spec
from unitylink.values import Quantity

from .binding import Tree
from .names import attribute_of, event_lines, python_names
from .node import Node
from .read_value import ReadClearValue, ReadValue
from .value import Value
from .write_value import ClearValue, PulseValue, ReadWriteValue, WriteValue

if TYPE_CHECKING:
    from unitylink.layer2_message import Link


def load_spec_objects(
    spec: Spec,
    link: Link,
    *,
    root: str | None = None,
    links: Mapping[str, Link] | None = None,
) -> Node:
    """Build the objects of a spec's public constructor: `node.j1.cpos.read()`.

    If there are several public constructors, `root` chooses one. Without `root`, each constructor that the
    gateware has becomes a part of the returned node. Paths then start with its name, as in `Spec.walk()`.
    `links` gives the links other than `link` by name: those of CTRL and COMM parameters, and those that the
    spec declares.

    Raises DeviceMismatch if the gateware reports that it was built from another spec (see `Link.check_spec`).

    >>> robot = load_spec_objects(unitylink.spec.load("scara.ul"), link)   # doctest: +SKIP
    >>> robot["j1.cpos"].read()                                            # doctest: +SKIP
    -1204
    """
    if root is not None and not isinstance(root, str):
        raise BindingError(f"{spec.source}: a public constructor is named by text, not {shown(root)}")
    if links is not None and not isinstance(links, Mapping):
        raise BindingError(f"{spec.source}: links are given by name, not as {shown(links)}")
    try:
        roots = spec.roots if root is None else (spec.root(root),)
    except KeyError as error:
        raise BindingError(f"{spec.source}: {error.args[0]}") from None
    known = {parameter for item in roots for parameter in item.parameters}
    known |= {element.link.link for item in roots for element in item.walk()} - {""}
    for name in links or {}:
        if name not in known:
            raise BindingError(
                f"{spec.source}: no parameter {shown(name)}; there are {', '.join(sorted(known)) or 'none'}"
            )
    several = len(roots) > 1
    addresses: dict[str, int] = {}
    names: dict[str, str] = {}
    for item in roots:
        prefix = f"{item.name}." if several else ""
        _tables(item, prefix, addresses, names)
    tree = Tree(link, links, addresses=addresses, names=names)
    if not several:
        _check_gateware(spec, roots[0], tree)
        node = Node(tree, roots[0].name)
        _Builder(spec, roots[0]).fill(node, roots[0], None)
        return node
    there, refused = [], []
    for item in roots:
        try:
            _check_gateware(spec, item, tree)
            there.append(item)
        except DeviceMismatch as error:
            refused.append(error)
    if not there:
        raise refused[0]
    top = Node(tree, spec.name)
    attributes = python_names([item.name for item in there])
    for item in there:
        child = Node(top, item.name)
        _Builder(spec, item).fill(child, item, None)
        setattr(top, attributes[item.name], child)
    return top


def _check_gateware(spec: Spec, root: Instance, tree: Tree) -> None:
    """Raise DeviceMismatch if the gateware behind a link lacks something that `root` reaches through it."""
    for ctrl, comm, declared in {(e.link.ctrl, e.link.comm, e.link.link) for e in root.walk()}:
        for link in {tree.link_of(ctrl, declared), tree.link_of(comm, declared)}:
            link.check_spec(spec.source, wire_hashes(spec, root.name, comm))


def _tables(instance: Instance, prefix: str, addresses: dict[str, int], names: dict[str, str]) -> None:
    for member in instance.members:
        if isinstance(member, Element):
            addresses[prefix + member.path] = member.address
            names[prefix + member.path] = member.display
        elif isinstance(member, Instance):
            names[prefix + member.path] = member.display
            _tables(member, prefix, addresses, names)


class _Builder:
    """It fills the nodes of one public constructor."""

    def __init__(self, spec: Spec, root: Instance) -> None:
        self.lines = event_lines(spec, root)

    def fill(self, node: Node, instance: Instance, above: Instance | None) -> None:
        """Give a node the members of an instance: parts and values first, then the groups that refer to
        them. The members of an array become a tuple under the array's name."""
        link = instance.link
        if above is None or link != above.link:
            node._bind(
                link.kind, base=link.base, ctrl=link.ctrl, comm=link.comm, size=link.size, link=link.link
            )
        attributes = python_names(dict.fromkeys(attribute_of(member) for member in instance.members))
        arrays: dict[str, list[object]] = {}
        for member in instance.members:
            if isinstance(member, Group):
                continue
            made: object
            if isinstance(member, Instance):
                made = child = Node(node, member.name)
                self.fill(child, member, instance)
            else:
                made = self._value(node, member)
            if member.array:
                arrays.setdefault(member.array, []).append(made)
            else:
                setattr(node, attributes[member.name], made)
        for name, parts in arrays.items():
            setattr(node, attributes[name], tuple(parts))
        start = len(instance.path) + 1 if instance.path else 0
        for group in instance.groups:
            paths = [element.path[start:] for element in group.elements]
            setattr(node, attributes[group.name], node._group(group.name, *paths))

    def _value(self, node: Node, element: Element) -> Value[Any]:
        return node._value(
            KINDS_OF_ACCESS[element.access],
            element.name,
            {
                "quantity": Quantity.of(element),
                "words": None if element.type.bus else element.words,
                "checked": element.checked,
                "publish": element.publish,
                "line": self.lines.get(element.path),
            },
        )


KINDS_OF_ACCESS: dict[str, type[Value[Any]]] = {
    "READ": ReadValue,
    "WRITE": WriteValue,
    "READWRITE": ReadWriteValue,
    "READCLEAR": ReadClearValue,
    "W1C": ClearValue,
    "PULSE": PulseValue,
}
