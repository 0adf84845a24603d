# SPDX-License-Identifier: BSD-3-Clause
"""The spec hash.

It tells whether a generated file, a PC program and gateware were made from the same interface.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterator

from .model import Element, Group, Instance, Link, RingOptions
from .types import ValueType

_FORMAT = "unity-link spec 1"  # changes whenever the lines below change their form
_PLAIN_RING = (1, 1, None)
_PLAIN = ("", 1, 0, None, None, "error", None, None)  # the facts of an element without new properties


def fingerprint(roots: tuple[Instance, ...], links: tuple[Link, ...] = ()) -> str:
    """Return 16 hex digits over the interface and everything that reaches the wire, in source order.

    This covers constructor, instance, element and group names, addresses, access, types with their fields and
    values, units, scaling, limits, initial and SAFE values, CRC, publish, declared links, components and
    run-time parameters. Comments, annotations, layout, display names and the spec's own name do not count.
    Additions to the published language count only if they are used. So the hash of a classic spec never
    changes.
    """
    lines = [f"declared {link}" for link in map(_link, links)]
    text = "\n".join([*lines, *(line for root in roots for line in _lines(root))])
    return hashlib.sha256(f"{_FORMAT}\n{text}\n".encode()).hexdigest()[:16]


def _link(link: Link) -> str:
    more = f" {link.physical} {link.send_immediate} {link.node}" if link.physical else ""
    return f"{link.name} {link.data_bits} {link.address_bits} {link.base_hz} {link.baud_hz}{more}"


def _lines(instance: Instance) -> Iterator[str]:
    link = instance.link
    yield f"( {instance.name} {instance.constructor} {','.join(instance.parameters)}"
    more = f" {link.size} {link.link}" if link.size or link.link else ""
    if link.ring != RingOptions():
        more += f" ring {link.ring.node} {link.ring.baud_hz} {link.ring.cycle_hz}"
        options = link.ring.rings, link.ring.check_bytes, link.ring.time
        more += "" if options == _PLAIN_RING else f" {options}"
        more += "" if link.ring.nodes == "inside" else f" nodes {link.ring.nodes}"
    yield f"link {link.kind} {link.base:x} {link.ctrl or ''} {link.comm or ''}{more}"
    part = instance.component
    if part is not None:
        ports = f"{part.generics} {part.pins} {part.events}" + (
            f" {part.connections}" if part.connections else ""
        )
        yield f"component {part.entity} {part.base:x} {part.words:x} {ports}"
        if part.node is not None:
            words = ",".join(f"{one.offset:x}:{one.address:x}" for one in part.carried)
            yield f"node {part.node} {words}"
            yield from (_element(one) for one in part.constants)
    for member in instance.members:
        if isinstance(member, Instance):
            yield from _lines(member)
        elif isinstance(member, Group):
            yield f"group {member.name} {' '.join(element.path for element in member.elements)}"
        else:
            yield _element(member)
    yield ")"


def _element(element: Element) -> str:
    publish = element.publish
    rate = f"{publish.mode}/{publish.divisor}" if publish else ""
    if publish and (publish.trigger != "rate" or publish.group):
        rate += f"/{publish.trigger}/{publish.event}/{publish.group}"
    line = (
        f"{element.access} {element.name} {element.address:x} {element.signed:d} {element.checked:d} {rate}"
    )
    kind = element.type
    facts = (
        element.unit,
        element.scale,
        element.offset,
        element.minimum,
        element.maximum,
        element.overflow,
        element.initial,
        element.safe,
    )
    if not kind.bus or facts != _PLAIN:
        line += f" {_type(kind)} {facts}"
    return line


def _type(kind: ValueType) -> str:
    if kind.enum is not None:
        values = ",".join(f"{one.name}={one.value}" for one in kind.enum.values)
        return f"enum {kind.name} {kind.width} {kind.enum.open:d} {values}"
    if kind.kind != "bits":
        return kind.text
    fields = ";".join(
        f"{one.name} {_type(one.type)} {one.low} "
        f"{one.unit} {one.scale} {one.offset} {one.minimum} {one.maximum}"
        for one in kind.fields
    )
    return f"bits {kind.name} {kind.width} {fields}"
