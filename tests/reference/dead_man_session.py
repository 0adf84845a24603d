# SPDX-License-Identifier: BSD-3-Clause
"""A session in which the dead-man trips, for both engines: its steps, and what the device must answer."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from reference.framing import field
from reference.host import ask, frames_of, opening
from unitylink import protocol as p

SAFE = ((0x10, 1), (0x11, 0xFFFFFFFF))  # of replay_tb


def steps(tick: int, limit: int) -> list[Any]:
    """Return the steps for replay_tb: a frame comes within `limit` ticks of `tick` clocks, and then none."""
    ticks, arm = p.CONTROL_DEADMAN_TICKS, p.CONTROL_ARM
    return [
        opening(),
        ask(p.REQUEST_KIND_WRITE, (0, 2), (0x11, 2), (9, 4)),
        ask(p.REQUEST_KIND_WRITE_CONTROL, (1, 2), (ticks, 2), (limit, 4)),
        ("wait", 2 * tick),
        ask(p.REQUEST_KIND_READ_CONTROL, (2, 2), (arm, 2), (1, 1)),
        ("wait", (limit + 1) * tick),
        ask(p.REQUEST_KIND_READ_CONTROL, (3, 2), (ticks, 2), (2, 1)),
        ask(p.REQUEST_KIND_READ, (4, 2), (0x10, 2)) + ask(p.REQUEST_KIND_READ, (5, 2), (0x11, 2)),
        ask(p.REQUEST_KIND_WRITE, (6, 2), (0x11, 2), (9, 4)),
        ask(p.REQUEST_KIND_POST, (0, 2), (0x11, 2), (9, 4)) + ask(p.REQUEST_KIND_SYNC, (7, 2)),
        ask(p.REQUEST_KIND_WRITE_CONTROL, (8, 2), (arm, 2), (1, 4)),
        ask(p.REQUEST_KIND_WRITE_CONTROL, (9, 2), (ticks, 2), (limit, 4)),
        opening(2),
        ask(p.REQUEST_KIND_WRITE_CONTROL, (0, 2), (arm, 2), (1, 4)),
        ask(p.REQUEST_KIND_WRITE, (1, 2), (0x11, 2), (9, 4)),
        ask(p.REQUEST_KIND_READ_CONTROL, (2, 2), (p.CONTROL_REFUSED, 2), (2, 1)),
    ]


def judge(
    answers: Sequence[bytes], times: Sequence[tuple[str, int, int]], *, tick: int, limit: int, late: int
) -> None:
    """Compare the answers to the steps, and the trip with the last frame. A sign of life may be `late`
    clocks late."""
    shown = [[(f.kind - 0xC0, f.payload[4:].hex()) for f in frames_of(answer)] for answer in answers]
    denied = (p.REPLY_STATUS_DENIED, "")
    assert shown[1] == shown[2] == [(0, "")]
    assert shown[4] == [(0, "00000002")], "a frame within its time"
    assert shown[6] == [(0, "0000000000000001")], "tripped"
    assert shown[7] == [(0, "00000001"), (0, "ffffffff")], "the safe values"
    assert shown[8] == [denied]
    assert shown[9] == [(0, field((1, 2), (1, 2), (0, 2), (p.REPLY_STATUS_DENIED, 1)).hex())]
    assert shown[10] == shown[11] == [denied], "not in the session in which it tripped"
    assert shown[13] == shown[14] == [(0, "")]
    assert shown[15] == [(0, "0000000400000001")], "refused, trips"
    strobe = next(at for kind, at, address in times if kind == "t" and address == SAFE[0][0])
    heard = [at for kind, at, _ in times if kind == "i" and at < strobe][-1]
    assert (limit - 1) * tick < strobe - heard <= limit * tick + late, "so long behind the last frame"
