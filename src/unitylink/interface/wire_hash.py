# SPDX-License-Identifier: BSD-3-Clause
"""The hash that tells whether a program and its gateware were made from the same interface."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Sequence
from typing import Protocol

from unitylink.spec.model import Element, Spec
from unitylink.spec.types import ValueType

_FORMAT = "unity-link wire 2"  # changes whenever the lines below change their form


def wire_hash(spec: Spec) -> int:
    """Return a 64-bit hash over every part of `spec` whose difference could move the wrong joint.

    For every value, the hash covers its name with the names of the parts around it, addresses, access, type
    with fields and members, unit, scale, limits, initial and SAFE values, the hardware behind it, and the
    event line that publishes it. Harmless parts do not count: comments, annotations, display names, names of
    types and constructors, the order in the file, and publish rates (the program asks for its own). The width
    of the bus does not count either, because the device tells it. The hash is never 0, because 0 means that a
    device knows no spec.

    >>> spec = unitylink.spec.load("scara.ul")  # doctest: +SKIP
    >>> f"{wire_hash(spec):016x}"  # doctest: +SKIP
    '3f0c…'
    """
    lines = {_element(f"{root.name}.{e.path}", e) for root in spec.roots for e in root.walk()}
    for device in spec.devices:
        for group in device.groups:
            if group.trigger != "rate":
                names = " ".join(f"{device.root}.{element.path}" for element in group.elements)
                lines.add(f"event {group.number} {group.trigger} {group.event} {names}")
    text = "\n".join(sorted(lines))
    return int(hashlib.sha256(f"{_FORMAT}\n{text}\n".encode()).hexdigest()[:16], 16) or 1


def wire_hashes(spec: Spec, root: str, *comms: str | None) -> tuple[int, ...]:
    """Return the hashes of gateware for everything that the public constructor `root` reaches through
    `comms`.

    Without `comms` this is the whole constructor. Gateware may be built from the whole spec, from the
    constructor alone, or from the part behind one link. For example, two arms are two boards, each behind a
    link of its own.
    """
    wanted = {(d.root, d.comm) for d in spec.devices if d.root == root and (not comms or d.comm in comms)}
    there = (part for part in _parts(spec) if wanted <= {(d.root, d.comm) for d in part.devices})
    return tuple(dict.fromkeys(wire_hash(part) for part in (spec, *there)))


def part_behind(link: Asked, spec: Spec) -> Spec:
    """Return the part of `spec` from which the gateware behind `link` was built.

    Return all of it if the gateware cannot tell.

    Raises DeviceMismatch if it was built from another spec.
    """
    parts = {wire_hash(part): part for part in reversed(_parts(spec))}
    link.check_spec(spec.source, tuple(reversed(parts)))
    return parts.get(link.description.spec_hash, spec) if link.description is not None else spec


class Told(Protocol):
    """The description of a device."""

    @property
    def spec_hash(self) -> int: ...


class Asked(Protocol):
    """A link, as far as this module needs it."""

    @property
    def description(self) -> Told | None: ...
    def check_spec(self, spec: str, hashes: Sequence[int]) -> None: ...


def _parts(spec: Spec) -> list[Spec]:
    """Return the specs from which gateware may be built, with the whole one first."""
    roots = [spec.only(root.name) for root in spec.roots] if len(spec.roots) > 1 else []
    boards = spec.boards if len(spec.boards) > 1 else ()
    return [spec, *boards, *roots]


def _element(name: str, element: Element) -> str:
    link = element.link
    addresses = " ".join(f"{address:x}" for address in element.addresses)
    facts = _facts(element.unit, element.scale, element.offset, element.minimum, element.maximum)
    more = f"{element.overflow} {_facts('', element.initial, element.safe)}"
    hardware = f"{link.kind} {link.base:x} {link.size}"
    return f"value {name} {addresses} {element.access} {_type(element.type)} {facts} {more} on {hardware}"


def _type(kind: ValueType) -> str:
    """Return everything about a type except its name."""
    if kind.bus:
        return "signed" if kind.signed else "unsigned"
    if kind.enum is not None:
        values = sorted(f"{one.name}={one.value}" for one in kind.enum.values)
        return f"enum {kind.width} {kind.enum.open:d} {','.join(values)}"
    fields = sorted(
        f"{one.name} {one.high} {one.low} {_type(one.type)} "
        + _facts(one.unit, one.scale, one.offset, one.minimum, one.maximum)
        for one in kind.fields
    )
    return f"{kind.kind} {kind.width} {kind.fraction} {';'.join(fields)}"


def _facts(unit: str, *numbers: float | bool | None) -> str:
    """Return numbers in a form in which 1 and 1.0 are equal, and whole numbers of 64 bits keep all digits."""
    return " ".join([repr(unit), *_texts(numbers)])


def _texts(numbers: Iterable[float | bool | None]) -> list[str]:
    return [
        "-" if n is None else str(int(n)) if isinstance(n, int) or n.is_integer() else repr(n)
        for n in numbers
    ]
