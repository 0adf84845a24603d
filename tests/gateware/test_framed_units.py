# SPDX-License-Identifier: BSD-3-Clause
"""The units of the framed side. Receiver and transmitter are compared with the reference."""

from __future__ import annotations

import random
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from reference.framing import Borders, Frame, check_bytes, cobs_encode

from unitylink import protocol as p

REQUEST_MAX = 250
LONGEST = REQUEST_MAX + 7  # bytes between borders: kind, COBS, the longer check
ENTRY = {"unknown": 14, "hello": 16, "open": 17, "check": 18, "long": 19, "session": 20, "kind": 21}
POSTS = (p.REQUEST_KIND_POST, p.REQUEST_KIND_POST_LIST)


@pytest.mark.parametrize(
    "bench", ["framed_tb", "frame_application_tb", "frame_units_tb", "frame_judge_tb", "frame_timing_tb"]
)
def test_bench(ghdl: Any, bench: str) -> None:
    ghdl.run(bench)


@pytest.mark.parametrize(
    ("fault", "message"),
    [
        (1, "jumps or ends the work in one clock"),
        (2, "reads what the one before it stores"),
        (3, "uses a word at once after a jump"),
        (4, "takes a byte at once after many were taken"),
        (5, "rewinds and takes a byte"),
        (6, "reads what the one before it stores"),
    ],
)
def test_a_program_that_comes_too_early_is_refused(ghdl: Any, fault: int, message: str) -> None:
    ghdl.refuse("frame_timing_tb", message, fault=fault)


@pytest.mark.parametrize("count", [1, 3, 16, 17, 60])
def test_dead_man(ghdl: Any, count: int) -> None:
    ghdl.run("dead_man_tb", count=count, seed=count)


@pytest.mark.parametrize("seed", [1, 2])
def test_splitter_and_joiner(ghdl: Any, seed: int) -> None:
    ghdl.run("port_tb", seed=seed)


@pytest.mark.parametrize("window", [2, 8, 128])
def test_reply_cache(ghdl: Any, window: int) -> None:
    ghdl.run("reply_cache_tb", window=window, seed=window)


def test_reply_cache_refuses_a_window_that_is_not_a_power_of_two(ghdl: Any) -> None:
    ghdl.refuse("reply_cache_tb", "window must be a power of two", window=12)


def entry_of(piece: bytes, epoch: int) -> tuple[int, bytes]:
    """Return what the receiver reports about the piece between two borders."""
    outside = piece[0] in (p.REQUEST_KIND_HELLO, p.REQUEST_KIND_OPEN)
    if len(piece) > LONGEST:
        return ENTRY["long"], b""
    if not outside and epoch >> 8 == 0xFF:
        return ENTRY["session"], b""
    frame = Frame.decode(piece, p.FRAME_OPEN_EPOCH if outside else epoch)
    if frame is None:
        return ENTRY["check"], b""
    if outside:
        return ENTRY["open" if frame.kind & 1 else "hello"], frame.payload
    if len(frame.payload) > REQUEST_MAX:
        return ENTRY["long"], b""
    if frame.kind & p.FRAME_DEVICE_BIT or (frame.kind & ~0x30 in POSTS and frame.kind & 0x30):
        return ENTRY["kind"], b""
    operation = frame.kind & 0x0F
    return (ENTRY["unknown"] if operation in (0, 1, 15) else operation), frame.payload


def pieces(draw: random.Random, epoch: int) -> Iterator[bytes]:
    for _ in range(40):
        kind = draw.choice((0x80, 0x81, 0x82, 0x9F, 0xA1, draw.randrange(0x80, 0x100)))
        size = draw.choice((0, 1, 2, 7, 8, 30, 248, 249, 250, 251, 252, 253, 254, 300))
        payload = bytes(draw.choice((0, 1, 0xFF, draw.randrange(256))) for _ in range(size))
        wire = Frame(kind, payload).encode(epoch if kind > 0x81 else p.FRAME_OPEN_EPOCH)
        fate = draw.randrange(6)
        if fate == 0:
            hurt = bytearray(wire)
            hurt[draw.randrange(1, len(hurt))] ^= 1 << draw.randrange(8)
            wire = bytes(hurt)
        elif fate == 1:
            wire = wire[: draw.randrange(1, min(6, len(wire)))]
        elif fate == 2:  # the check is right, but the COBS blocks end elsewhere
            body = bytes([kind]) + cobs_encode(payload[:100])[: draw.randrange(1, 20)] + b"\x05"
            wire = body + check_bytes(body, epoch if kind > 0x81 else p.FRAME_OPEN_EPOCH, False)
        yield from Borders().feed(wire + b"\0")


@pytest.mark.parametrize(("seed", "stalls"), [(1, 0), (2, 30), (3, 0), (4, 60)])
def test_receiver(ghdl: Any, tmp_path: Path, seed: int, stalls: int) -> None:
    draw = random.Random(seed)
    lines = []
    for epoch in (0xFFFF, 0x1234, 0x0000, 0xFEFF):
        lines.append(f"e {epoch}")
        for piece in pieces(draw, epoch):
            if piece[0] < 0x80:  # the splitter's
                continue
            entry, payload = entry_of(piece, epoch)
            lines += [f"s {piece.hex()}00", f"x {entry} {payload.hex()}"]
        lines += ["s 0000", "n"]
    vectors = tmp_path / "vectors.txt"
    vectors.write_text("\n".join(lines) + "\n", encoding="ascii")
    assert {line.split()[1] for line in lines if line[0] == "x"} >= {str(entry) for entry in ENTRY.values()}
    ghdl.run("frame_receiver_tb", vectors_file=str(vectors), stall_percent=stalls)


def test_receiver_keeps_many_and_waits_when_it_is_full(ghdl: Any, tmp_path: Path) -> None:
    wire = [Frame(0x83, bytes(range(1, size))).encode(0x1234) for size in (100, 120, 130, 140)]
    lines = ["e 4660", f"s {b''.join(wire).hex()}"]
    lines += [f"x 3 {bytes(range(1, size)).hex()}" for size in (100, 120, 130, 140)] + ["n"]
    vectors = tmp_path / "vectors.txt"
    vectors.write_text("\n".join(lines) + "\n", encoding="ascii")
    ghdl.run("frame_receiver_tb", vectors_file=str(vectors))


@pytest.mark.parametrize("stalls", [0, 50])
def test_transmitter(ghdl: Any, tmp_path: Path, stalls: int) -> None:
    draw = random.Random(stalls)
    lines = []
    for epoch in (0xFFFF, 0x1234, 0x0000):
        lines.append(f"e {epoch}")
        for _ in range(30):
            kind = draw.choice((0xC0, 0xC7, 0xD0, 0xD1, 0xD2, 0xD3))
            size = draw.choice((0, 1, 2, 8, 40, 253, 254))
            payload = bytes(draw.choice((0, 1, draw.randrange(256))) for _ in range(size))
            start = epoch if kind == 0xD2 or kind < 0xD0 else p.FRAME_OPEN_EPOCH
            lines.append(f"f {kind:02x} {payload.hex() or '-'} {Frame(kind, payload).encode(start).hex()}")
    vectors = tmp_path / "vectors.txt"
    vectors.write_text("\n".join(lines) + "\n", encoding="ascii")
    ghdl.run("frame_transmitter_tb", vectors_file=str(vectors), stall_percent=stalls)
