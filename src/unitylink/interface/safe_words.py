# SPDX-License-Identifier: BSD-3-Clause
"""The words that the gateware writes when its dead-man trips: the SAFE values of a spec."""

from __future__ import annotations

from unitylink.protocol import TOSNET_STATUS
from unitylink.spec.model import LinkBinding, Spec
from unitylink.values import Codec, Quantity


def safe_words(spec: Spec, data_bits: int) -> tuple[tuple[int, int], ...]:
    """Return (address, word) in the order in which they are written. The low words of a value come first.

    The commit of a TosNet or double-buffered memory follows its words. Such a memory swaps and does not copy.
    So after the commit, a word without a SAFE value has its value of two commits before.

    >>> from unitylink.spec import compile_text
    >>> text = "public arm() { @power = 0x10: WRITE(SAFE=7); @limit = 0x20: i64 WRITE(SAFE=-2); }"
    >>> safe_words(compile_text(text, "arm.ul").spec, 32)
    ((16, 7), (32, 4294967294), (33, 4294967295))
    """
    words: list[tuple[int, int]] = []
    committed: dict[LinkBinding, None] = {}
    for path, element in spec.walk():
        if element.safe is None or not element.writable:
            continue
        codec = Codec(path, Quantity.of(element), data_bits)
        # on a bus narrower than the spec's, a value is cut to its words, like its initial value
        words += zip(element.addresses, codec.split(codec.encode(element.safe)), strict=False)
        committed[element.link] = None
    return (*words, *((address, 0) for link in committed if (address := _commit(link)) is not None))


def _commit(link: LinkBinding) -> int | None:
    if link.kind == "tosnet":
        return link.base + TOSNET_STATUS
    return link.base + link.size if link.kind == "double_buffer" else None
