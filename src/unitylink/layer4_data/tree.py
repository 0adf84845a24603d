# SPDX-License-Identifier: BSD-3-Clause
"""The tree of values of a Spec, made at run time: what generated code makes, without a file."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from unitylink.errors import BindingError
from unitylink.spec.model import Element, Instance, Spec

from .binding import Tree
from .names import python_names
from .node import Node

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

    With several public constructors `root` chooses one; without it each becomes a part of the returned node,
    and paths start with its name, as in `Spec.walk()`. `links` gives CTRL and COMM parameters by name where
    they are not `link`.

    >>> robot = load_spec_objects(unitylink.spec.load("scara.ul"), link)   # doctest: +SKIP
    >>> robot["j1.cpos"].read()                                            # doctest: +SKIP
    -1204
    """
    try:
        roots = spec.roots if root is None else (spec.root(root),)
    except KeyError as error:
        raise BindingError(f"{spec.source}: {error.args[0]}") from None
    known = {parameter for item in roots for parameter in item.parameters}
    for name in links or {}:
        if name not in known:
            raise BindingError(
                f"{spec.source}: no parameter {name!r}; there are {', '.join(sorted(known)) or 'none'}"
            )
    several = len(roots) > 1
    addresses: dict[str, int] = {}
    names: dict[str, str] = {}
    for item in roots:
        prefix = f"{item.name}." if several else ""
        _tables(item, prefix, addresses, names)
    tree = Tree(link, links, addresses=addresses, names=names)
    if not several:
        node = Node(tree, roots[0].name)
        _fill(node, roots[0], None)
        return node
    top = Node(tree, spec.name)
    attributes = python_names([item.name for item in roots])
    for item in roots:
        child = Node(top, item.name)
        _fill(child, item, None)
        setattr(top, attributes[item.name], child)
    return top


def _tables(instance: Instance, prefix: str, addresses: dict[str, int], names: dict[str, str]) -> None:
    for member in instance.members:
        if isinstance(member, Element):
            addresses[prefix + member.path] = member.address
            names[prefix + member.path] = member.display
        elif isinstance(member, Instance):
            names[prefix + member.path] = member.display
            _tables(member, prefix, addresses, names)


def _fill(node: Node, instance: Instance, above: Instance | None) -> None:
    """Give a node the members of an instance: parts and values first, then the groups that refer to them."""
    link = instance.link
    if above is None or link != above.link:
        node._bind(link.kind, base=link.base, ctrl=link.ctrl, comm=link.comm)
    attributes = python_names([member.name for member in instance.members])
    for member in instance.members:
        attribute = attributes[member.name]
        if isinstance(member, Instance):
            child = Node(node, member.name)
            _fill(child, member, instance)
            setattr(node, attribute, child)
        elif isinstance(member, Element):
            if member.access == "READ":
                publish = (member.publish.mode, member.publish.divisor) if member.publish else None
                value = node._read(
                    member.name,
                    signed=member.signed,
                    checked=member.checked,
                    publish=publish,
                    unit=member.unit,
                )
                setattr(node, attribute, value)
            else:
                written = node._write(
                    member.name, signed=member.signed, checked=member.checked, unit=member.unit
                )
                setattr(node, attribute, written)
    start = len(instance.path) + 1 if instance.path else 0
    for group in instance.groups:
        paths = [element.path[start:] for element in group.elements]
        setattr(node, attributes[group.name], node._group(group.name, *paths))
