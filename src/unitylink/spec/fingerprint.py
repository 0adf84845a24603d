# SPDX-License-Identifier: BSD-3-Clause
"""The spec hash: whether a generated file, a PC program and gateware were made from the same interface."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator

from .model import Element, Group, Instance

_FORMAT = "unity-link spec 1"  # changes whenever the lines below change their form


def fingerprint(roots: tuple[Instance, ...]) -> str:
    """Return 16 hex digits over what reaches the wire and the interface, in source order.

    That is: constructor, instance, element and group names, addresses, access, sign, CRC, publish, links and
    run-time parameters. Comments, layout, display names and the spec's own name do not count.
    """
    text = "\n".join(line for root in roots for line in _lines(root))
    return hashlib.sha256(f"{_FORMAT}\n{text}\n".encode()).hexdigest()[:16]


def _lines(instance: Instance) -> Iterator[str]:
    link = instance.link
    yield f"( {instance.name} {instance.constructor} {','.join(instance.parameters)}"
    yield f"link {link.kind} {link.base:x} {link.ctrl or ''} {link.comm or ''}"
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
    return (
        f"{element.access} {element.name} {element.address:x} {element.signed:d} {element.checked:d} {rate}"
    )
