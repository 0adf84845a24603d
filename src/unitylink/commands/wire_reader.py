# SPDX-License-Identifier: BSD-3-Clause
"""Messages of a link, with the names of a spec."""

from __future__ import annotations

from unitylink.capture import MessageReader
from unitylink.errors import UnityLinkError
from unitylink.spec.model import Element
from unitylink.values import Codec, Quantity

from .names import Names
from .value_text import shown


def wire_reader(
    names: Names, *, address_bytes: int | None = None, data_bytes: int | None = None
) -> MessageReader:
    """Return a reader that gives words their names, and shows engineering values with their units."""
    elements = {element.address: (name, element) for name, element in names.elements.items()}
    codecs: dict[tuple[int, int], Codec] = {}

    def show(address: int, word: int) -> str:
        _, element = elements.get(address, ("", None))
        if element is None or element.words > 1:  # half a value has no meaning
            return f"0x{word:x}"
        bits = 8 * (reader.data_bytes or 4)
        codec = codecs.get((address, bits)) or codecs.setdefault((address, bits), _codec(element, bits))
        try:
            text = shown(codec.decode(word), codec.quantity)
        except UnityLinkError:  # the number is invalid for its type
            return f"0x{word:x}"
        return f"{text} {element.unit}" if element.unit else text

    by_address = {address: name for address, (name, _) in elements.items()}
    reader = MessageReader(by_address, show, address_bytes=address_bytes, data_bytes=data_bytes)
    return reader


def _codec(element: Element, data_bits: int) -> Codec:
    return Codec(element.path, Quantity.of(element), data_bits)
