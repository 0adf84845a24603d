# SPDX-License-Identifier: BSD-3-Clause
"""Check that each block of addresses holds all of its own elements, and no others."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence

from ..expand.allocate import Block
from ..expand.resolve import Placed
from ..report.diagnostics import Reporter


def check_blocks(blocks: Sequence[Block], placed: Sequence[Placed], reporter: Reporter) -> None:
    """Report elements outside of their constructor's block or in another one's, and blocks that overlap."""
    if not blocks:
        return
    own = {(block.root, block.path): block for block in blocks}
    outer = {device: _outermost(device, blocks, reporter) for device in {block.device for block in blocks}}
    for one in placed:
        element = one.element
        block = _innermost(own, one.root, element.path)
        last = element.addresses[-1]
        at = one.address.start, one.address.end
        if block is not None and block.first is not None:
            if not block.first <= element.address <= last < block.first + block.words:
                where = f"0x{element.address:X}, outside the {block.words} words of `{block.path}`"
                end = block.first + block.words - 1
                message = f"`{element.path}` lies at {where}"
                hint = f"they are 0x{block.first:X} to 0x{end:X}: make the block larger"
                reporter.report("UL055", *at, message, hint)
            continue
        for block in _around(outer.get((one.root, element.link.comm), []), element.addresses):
            message = f"`{element.path}` lies at 0x{element.address:X}, among the words of `{block.path}`"
            labels = [
                (
                    block.start,
                    block.end,
                    f"`{block.path}` takes {block.words} words from 0x{block.first or 0:X} on",
                )
            ]
            reporter.report("UL057", *at, message, "give one of them another address", labels=labels)


def check_windows(placed: Sequence[Placed], reporter: Reporter) -> None:
    """Report FIFOs and double buffers that overlap, and other elements among their words."""
    windows: dict[tuple[object, ...], Block] = {}
    for one in placed:
        if one.element.link.kind in ("fifo", "double_buffer"):
            windows.setdefault(_window_of(one), _window(one))
    blocks = list(windows.values())
    outer = {device: _outermost(device, blocks, reporter) for device in {block.device for block in blocks}}
    apart = {id(block) for ranges in outer.values() for _, block in ranges}
    for one in placed if blocks else ():
        element, own = one.element, windows.get(_window_of(one))
        if own is not None and id(own) not in apart:
            continue  # already reported as a whole
        for block in _around(outer.get((one.root, element.link.comm), []), element.addresses):
            if block is not own:
                message = f"`{element.path}` lies at 0x{element.address:X}, among the words of `{block.path}`"
                labels = [(block.start, block.end, f"{block.words} words from 0x{block.first or 0:X} on")]
                at = one.address.start, one.address.end
                reporter.report("UL057", *at, message, "give one of them another address", labels=labels)


def _window_of(one: Placed) -> tuple[object, ...]:
    link = one.element.link
    return one.root, link.comm, link.kind, link.base, link.words


def _window(one: Placed) -> Block:
    """Return the words of the FIFO or double buffer in which an element is."""
    link, path = one.element.link, one.element.path.rpartition(".")[0]
    at = one.address
    return Block(one.root, link.comm, path, link.base, link.words, 0, 0, at.start, at.end, component=False)


def _innermost(own: dict[tuple[str, str], Block], root: str, path: str) -> Block | None:
    while "." in path:
        path = path.rpartition(".")[0]
        if (root, path) in own:
            return own[root, path]
    return None


def _outermost(
    device: tuple[str, str | None], blocks: Sequence[Block], reporter: Reporter
) -> list[tuple[int, Block]]:
    """Return the blocks of a device that are inside no other, by their first address. Report overlaps."""
    found: list[tuple[int, Block]] = []
    mine = [(b.first, b) for b in blocks if b.device == device and b.first is not None]
    for first, block in sorted(mine, key=lambda one: (one[0], -one[1].words)):
        if found and first < found[-1][0] + found[-1][1].words:
            outer = found[-1][1]
            if not block.path.startswith(f"{outer.path}."):
                message = f"the words of `{block.path}` overlap those of `{outer.path}`"
                labels = [(outer.start, outer.end, f"{outer.words} words from 0x{found[-1][0]:X} on")]
                if outer.start == block.start:
                    labels = []
                hint = "give one of them another address, or none: the compiler finds room"
                reporter.report("UL057", block.start, block.end, message, hint, labels=labels)
            continue
        found.append((first, block))
    return found


def _around(outer: list[tuple[int, Block]], addresses: tuple[int, ...]) -> list[Block]:
    position = bisect_right([first for first, _ in outer], addresses[-1]) - 1
    if position < 0:
        return []
    first, block = outer[position]
    return [block] if addresses[-1] < first + block.words or addresses[0] <= first <= addresses[-1] else []
