# SPDX-License-Identifier: BSD-3-Clause
"""The pictures of docs/tosnet.md: a ring of five nodes, its packet, and its cycle, all from its budget."""

from __future__ import annotations

import math

from picture import BOLD, CHECK, DEVICE, FAINT, GRID, INK, PC, PUBLISH, SMALL, Picture

from unitylink import protocol
from unitylink.spec import compile_text
from unitylink.spec.ring import Ring, ring_at

SPEC = """public arm(u) { TOSNET(COMM=u, NODE=1); @power = 0x40: WRITE(); joint[4]: joint() @ (0x80+64*i); }
joint(): @ (position) { @position: i32 READ(); }"""
HEAD = [("K28.5", 1), ("seed", 1), ("A0", 1)]
ASYNCHRONOUS = 14


def example() -> Ring:
    """Return the ring of the pictures: the PC's node and four joints, with a register each."""
    spec = compile_text(SPEC, "arm.ul").spec
    assert spec is not None
    return ring_at(spec, 0)


def ring() -> str:
    """Draw the nodes of a ring, and who writes what."""
    picture = Picture(860, 330, "A TosNet ring: the PC's node is the master, four joints follow")
    nodes = [example().own, *example().nodes]
    centres = [_place(number, len(nodes)) for number in range(len(nodes))]
    for (x1, y1), (x2, y2) in zip(centres, [*centres[1:], centres[0]], strict=True):
        length = math.hypot(x2 - x1, y2 - y1)
        dx, dy = (x2 - x1) / length, (y2 - y1) / length
        start, end = (x1 + 66 * dx, y1 + 34 * dy), (x2 - 66 * dx, y2 - 34 * dy)
        picture.path([start, end], PUBLISH)
        head = [(end[0] - 9 * dx + 4 * s * dy, end[1] - 9 * dy - 4 * s * dx) for s in (1, -1)]
        picture.path([head[0], end, head[1]], PUBLISH)
    for node, (x, y) in zip(nodes, centres, strict=True):
        own = node is nodes[0]
        picture.box(x - 62, y - 26, 124, 52, PC if own else DEVICE)
        name = "node 1, master" if own else f"node {node.id}"
        picture.text(x, y - 4, name, anchor="middle", style=BOLD)
        what = "bus of the PC's link" if own else "encoder, PWM, loop"
        picture.text(x, y + 14, what, anchor="middle", style=SMALL)
    picture.box(30, 139, 110, 52, PC, fill=0.02)
    picture.text(85, 161, "PC", anchor="middle", style=BOLD)
    picture.text(85, 179, "Python, ROS, C++", anchor="middle", style=SMALL)
    picture.line(140, 165, centres[0][0] - 62, 165, INK)
    picture.text((140 + centres[0][0] - 62) / 2, 156, "any link", anchor="middle", colour=FAINT, style=SMALL)
    for row, text in enumerate(
        (
            "one fibre from each node to the next",
            "OUT words: a node writes, all read",
            "IN words: the PC writes, the node obeys",
            "all nodes exchange at one moment",
        )
    ):
        picture.text(850, 130 + 22 * row, text, anchor="end", colour=FAINT, style=SMALL)
    return picture.svg()


def _place(number: int, count: int) -> tuple[float, float]:
    turn = math.pi + 2 * math.pi * number / count
    return 440 + 160 * math.cos(turn), 165 + 122 * math.sin(turn)


def cycle() -> str:
    """Draw the packet of a cycle, and when it passes each node."""
    one = example()
    picture = Picture(860, 330, "The packet of a cycle, and when it passes each of five nodes")
    _packet(picture, one)
    nodes = [one.own, *one.nodes]
    byte_us = protocol.TOSNET_RING_BYTE_BITS / one.baud_hz * 1e6
    long_us, hop_us = one.cycle_bytes * byte_us, one.hop_s * 1e6
    left, scale = 110.0, 700.0 / (one.shortest_s * 1e6)
    for tick in range(0, int(one.shortest_s * 1e6) + 1, 20):
        at = left + tick * scale
        picture.line(at, 120, at, 290, GRID, dash="2 3")
        picture.text(at, 306, f"{tick} us", anchor="middle", colour=FAINT, style=SMALL)
    for place, node in enumerate(nodes):
        y = 128 + 32 * place
        picture.text(12, y + 15, f"node {node.id}", style=BOLD, colour=DEVICE if place else PC)
        start = left + place * hop_us * scale
        picture.box(start, y, long_us * scale, 20, DEVICE if place else PC, fill=0.25)
    strobe = left + one.shortest_s * 1e6 * scale
    picture.line(strobe, 120, strobe, 290, CHECK)
    picture.text(strobe - 4, 116, "strobe: all exchange", anchor="end", colour=CHECK, style=SMALL)
    note = f"when each node sends it: {hop_us:g} us after it hears it; the packet has {one.cycle_bytes} bytes"
    picture.text(left, 324, note, colour=FAINT, style=SMALL)
    return picture.svg()


def _packet(picture: Picture, one: Ring) -> None:
    sections = [
        (f"{node.id} {way}", 16 * len(node.numbers))
        for node in [one.own, *one.nodes]
        for way in ("OUT", "IN")
    ]
    parts = [*HEAD, *sections, ("async", ASYNCHRONOUS), ("CRC", 1)]
    assert sum(size for _, size in parts) == one.cycle_bytes
    least = 27.0  # a byte alone would be too narrow for its name
    small = sum(1 for _, size in parts if size == 1)
    scale = (836 - least * small) / sum(size for _, size in parts if size > 1)
    x = 12.0
    for name, size in parts:
        width = least if size == 1 else size * scale
        colour = (
            CHECK if size == 1 else PUBLISH if name == "async" else DEVICE if name.endswith("OUT") else PC
        )
        picture.box(x, 34, width - 2, 30, colour, fill=0.25)
        picture.text(x + width / 2 - 1, 53, name, anchor="middle", style='font-size="10"')
        picture.text(x + width / 2 - 1, 79, str(size), anchor="middle", colour=FAINT, style=SMALL)
        x += width
    picture.text(12, 22, "the packet, with the bytes of each part", style=BOLD)
    picture.text(12, 98, "OUT and IN: of each enabled register four words", colour=FAINT, style=SMALL)
