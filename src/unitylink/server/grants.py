# SPDX-License-Identifier: BSD-3-Clause
"""From the rights of a user to the addresses that the native server lets him use."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

from unitylink.protocol import TOSNET_STATUS
from unitylink.spec.model import Element, LinkBinding, Spec

from .scopes import Rights
from .subtree import WHOLE, contains

Ranges = list[tuple[int, int]]  # first and last addresses, rising and apart
EVERYTHING: Ranges = [(0, 0xFFFFFFFF)]


@dataclass(frozen=True)
class Grant:
    """Addresses that a client may read and write, and whether it may arm the outputs after a stop.

    `leased` are those of `writes` whose write lease it has.
    """

    reads: Ranges
    writes: Ranges
    leased: Ranges
    arm: bool


def grant(spec: Spec, rights: Rights, leases: Iterable[str] = ()) -> Grant:
    """Return what `rights` and write leases of parts mean on the board of `spec`.

    Who may use the whole robot may use every address, also those that the spec does not name. Who may use a
    part may use the words of its items, and the words that commit them.

    >>> from unitylink.spec import compile_text
    >>> text = "public arm() { @power = 0x10: WRITE(); @limit = 0x12: i64 READWRITE(); }"
    >>> grant(compile_text(text, "arm.ul").spec, Rights.of(["read", "write limit"]), ["limit"])
    Grant(reads=[(0, 4294967295)], writes=[(18, 19)], leased=[(18, 19)], arm=False)
    """
    held = tuple(leases)
    return Grant(
        words_of(spec, lambda part: rights.allow("read", part)),
        words_of(spec, lambda part: rights.allow("write", part)),
        words_of(spec, lambda part: any(contains(lease, part) for lease in held)),
        rights.allow("arm"),
    )


def words_of(spec: Spec, wanted: Callable[[str], bool]) -> Ranges:
    """Return the addresses of the `wanted` items. If the whole robot is wanted, these are all addresses."""
    if wanted(WHOLE):
        return EVERYTHING
    mine = [element for path, element in spec.walk() if wanted(path)]
    words = {address for element in mine for address in element.addresses}
    return joined(words | set(_commits(mine)))


def paths_of(spec: Spec) -> dict[int, str]:
    """Return the path of the writable item behind each address.

    >>> from unitylink.spec import compile_text
    >>> text = "public arm() { @power = 0x10: WRITE(); @limit = 0x12: i64 READWRITE(); }"
    >>> paths_of(compile_text(text, "arm.ul").spec)
    {16: 'power', 18: 'limit', 19: 'limit'}
    """
    return {
        address: path for path, element in spec.walk() if element.writable for address in element.addresses
    }


def plain_words(spec: Spec) -> Ranges:
    """Return the words that may be read once for several clients, because a read has no side effect.

    >>> from unitylink.spec import compile_text
    >>> text = "public arm() { @angle = 0x10: READ(); @errors = 0x11: READCLEAR(); }"
    >>> plain_words(compile_text(text, "arm.ul").spec)
    [(16, 16)]
    """
    items = [element for _, element in spec.walk() if element.link.kind != "fifo"]
    return joined(address for one in items if one.pollable for address in one.addresses)


def _commits(elements: Iterable[Element]) -> Iterable[int]:
    """Yield the words that tell the state of a committed memory, and commit what was written to it."""
    for link in {element.link for element in elements}:
        if (word := commit_of(link)) is not None:
            yield word


def commit_of(link: LinkBinding) -> int | None:
    """Return the word that tells the state of a committed memory, and commits what was written to it."""
    if link.kind == "tosnet":
        return link.base + TOSNET_STATUS
    return link.base + link.size if link.kind == "double_buffer" else None


def joined(words: Iterable[int]) -> Ranges:
    """Return the ranges that have exactly these words.

    >>> joined([5, 3, 4, 9])
    [(3, 5), (9, 9)]
    """
    ranges: Ranges = []
    for word in sorted(words):
        if ranges and ranges[-1][1] == word - 1:
            ranges[-1] = (ranges[-1][0], word)
        else:
            ranges.append((word, word))
    return ranges
