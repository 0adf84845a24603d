# SPDX-License-Identifier: BSD-3-Clause
"""A host with one session: the bytes that it sends, and the frames that it finds in the answers."""

from __future__ import annotations

from reference.framing import Borders, Frame, field
from unitylink import protocol as p

EPOCH = 0x1234


def without_clock(answer: bytes) -> list[bytes | Frame]:
    """Return the frames, but without the time at which a session was opened."""
    shown: list[bytes | Frame] = []
    for piece in Borders().feed(answer):
        frame = Frame.decode(piece, p.FRAME_OPEN_EPOCH)
        opened = frame is not None and frame.kind == p.DEVICE_KIND_OPEN
        shown.append(Frame(frame.kind, frame.payload[:2]) if frame is not None and opened else piece)
    return shown


def opening(nonce: int = 1, epoch: int = EPOCH) -> bytes:
    hello = Frame(p.REQUEST_KIND_HELLO, b"\1\1").encode()
    return b"\0" + hello + Frame(p.REQUEST_KIND_OPEN, field((nonce, 2), (epoch, 2), (0, 1))).encode()


def ask(kind: int, *fields: tuple[int, int]) -> bytes:
    return Frame(kind, field(*fields)).encode(EPOCH)


def frames_of(answer: bytes, epoch: int = EPOCH) -> list[Frame]:
    frames = [Frame.decode(piece, epoch) for piece in Borders().feed(answer)]
    return [frame for frame in frames if frame is not None]
