# SPDX-License-Identifier: BSD-3-Clause
"""The hash by which a program and gateware find out whether they were made from the same interface."""

from __future__ import annotations

import hashlib

from unitylink.safe_words import safe_words
from unitylink.spec.model import Spec

_FORMAT = "unity-link wire 1"  # changes whenever the lines below change their form


def wire_hash(spec: Spec, data_bits: int = 32) -> int:
    """Return 64 bits over all of `spec` that reaches the wire, and nothing else.

    That is: addresses, widths, access, publish groups, the hardware behind addresses and safe values. Names,
    comments, units, limits and the order in the file do not count. Never 0, which a device says that knows
    no spec.

    >>> spec = unitylink.spec.load("scara.ul")  # doctest: +SKIP
    >>> f"{wire_hash(spec):016x}"  # doctest: +SKIP
    '3f0c…'
    """
    data_bits = -(-data_bits // 8) * 8  # as the protocol tells it
    lines = {f"data {data_bits}"}
    for _, element in spec.walk():
        binding = element.link
        addresses = " ".join(f"{address:x}" for address in element.addresses)
        lines.add(f"element {addresses} {element.access} {element.type.width}")
        lines.add(f"hardware {binding.kind} {binding.base:x} {binding.size}")
    for device in spec.devices:
        for group in device.groups:
            words = " ".join(f"{address:x}" for element in group.elements for address in element.addresses)
            lines.add(f"group {group.number} {group.trigger} {group.divisor} {words}")
    text = "\n".join([*sorted(lines), *(f"safe {at:x} {word:x}" for at, word in safe_words(spec, data_bits))])
    return int(hashlib.sha256(f"{_FORMAT}\n{text}\n".encode()).hexdigest()[:16], 16) or 1


def is_built_from(spec: Spec, told: int, data_bits: int = 32) -> bool:
    """Was gateware with the hash `told` built from `spec`, or from a part of it that can be a board?

    Each public constructor can be one, and what is behind each link: two arms, each with a link of its own.
    """
    parts = (spec, *spec.boards, *(spec.only(root.name) for root in spec.roots))
    return any(wire_hash(part, data_bits) == told for part in parts)
