# SPDX-License-Identifier: BSD-3-Clause
"""Which words a design has, and which side drives each."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

from unitylink.board_configuration import BoardConfiguration
from unitylink.protocol import (
    TOSNET_ADDRESS_BITS,
    TOSNET_IN_BIT,
    TOSNET_MEMORY_WORDS,
    TOSNET_NODE_SHIFT,
)
from unitylink.spec.model import Element, Spec


@dataclass(frozen=True)
class WordMap:
    """The words of a design, {address: index} in rising order: where each is in the ports of `NAME_design`.

    Word i of `read` is bits 32*i+31 to 32*i of `read_words`, and so for `write` and `write_words`. A word
    that one element reads and another writes is in both. A TosNet word is in one, whatever the spec does with
    it: the PC writes IN words and the OUT words of its own node, the user's logic is the other nodes.

    >>> from unitylink.spec import compile_text
    >>> spec = compile_text("public lamp() { @led = 0x10: WRITE(); @key = 0x08: READ(); }", "lamp.ul").spec
    >>> word_map(spec)
    WordMap(read=mappingproxy({8: 0}), write=mappingproxy({16: 0}))
    """

    read: Mapping[int, int]  # what the PC reads: the user's logic drives it
    write: Mapping[int, int]  # what the PC wrote

    def drives(self, element: Element) -> bool:
        """Say whether the user's logic drives this element's word for the PC to read."""
        return element.access == "READ" and element.address in self.read

    def sees(self, element: Element) -> bool:
        """Say whether the user's logic sees what the PC writes to this element."""
        return element.access == "WRITE" and element.address in self.write


def word_map(spec: Spec, configuration: BoardConfiguration | None = None) -> WordMap:
    """Return the words of the design that `generate_vhdl(spec, configuration)` makes."""
    configuration = configuration or BoardConfiguration.for_spec(spec)
    driven = {(element.address, _pc_drives(element, configuration)) for _, element in spec.walk()}
    return WordMap(
        read=_indices(address for address, by_pc in driven if by_pc is False),
        write=_indices(address for address, by_pc in driven if by_pc),
    )


def tosnet_range(configuration: BoardConfiguration) -> range:
    """Return the addresses at which TosNet's slave answers."""
    if configuration.tosnet is None:
        return range(0)
    return range(configuration.tosnet.base, configuration.tosnet.base + (1 << TOSNET_ADDRESS_BITS))


def _pc_drives(element: Element, configuration: BoardConfiguration) -> bool | None:
    """Say whether the PC drives the element's word; None where nobody here does, for it is one of TosNet's
    own registers, or a write that TosNet refuses."""
    writes = element.access == "WRITE"
    if configuration.tosnet is None or element.address not in tosnet_range(configuration):
        return writes
    word = element.address - configuration.tosnet.base
    if word >= TOSNET_MEMORY_WORDS:
        return None
    own = word >> TOSNET_NODE_SHIFT == configuration.tosnet.master_id
    return True if own or word >> TOSNET_IN_BIT & 1 else None if writes else False


def _indices(addresses: Iterable[int]) -> Mapping[int, int]:
    return MappingProxyType({address: index for index, address in enumerate(sorted(addresses))})
