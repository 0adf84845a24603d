# SPDX-License-Identifier: BSD-3-Clause
"""After a reset at any clock of any kind of message, the core answers as after power-up."""

from __future__ import annotations

from typing import Any

import pytest
from gateware.small_core import play as small
from gateware.test_framed import play as framed
from reference.host import ask, frames_of, opening
from reference.settings import Settings

from unitylink import protocol as p

MESSAGES = {
    "read": "#R:12\n",
    "write": "#W:20DEADBEEF\n",
    "write checked": "$W:20DEADBEEF*99\n",
    "read-many": "#RM:03101112\n",
    "configuration": "#RLC\n",
    "group": "#WSA:00021112\n#RSI:00\n#WSR:000005\n",
    "mask": "#WIC:0003\n#RIC\n",
    "publish": "#WSA:00021112\n#WSR:000001\n#EPS\n#RSI:00\n",
    "publish checked": "#WSA:00021112\n#WSR:000001\n#WSA:010113\n#WSR:010001\n#EPC\n",
    "errors": "#R:F5\n#R:zz\n%",
}


def as_bytes(text: str) -> bytes:
    """Return the same requests for a core without a datalink, where data are bytes."""
    lines = [line.partition(":") for line in text.splitlines()]
    return b"".join(f"{head}{colon}".encode() + bytes.fromhex(data) + b"\n" for head, colon, data in lines)


@pytest.mark.parametrize("message", MESSAGES)
def test_reset_at_every_clock(ghdl: Any, message: str) -> None:
    ghdl.run("reset_tb", message=MESSAGES[message].encode().hex())


@pytest.mark.parametrize("message", ["write", "read-many", "group", "mask", "publish", "errors"])
def test_reset_at_every_clock_without_checks(ghdl: Any, message: str) -> None:
    ghdl.run("reset_tb", message=MESSAGES[message].encode().hex(), datalink="lite")


@pytest.mark.parametrize("message", ["read", "write", "read-many", "group", "mask", "publish"])
def test_reset_at_every_clock_with_data_as_bytes(ghdl: Any, message: str) -> None:
    ghdl.run("reset_tb", message=as_bytes(MESSAGES[message]).hex(), datalink="none")


# Frames that take more than one access, or leave something behind. The session has used the ids 0 to 3.
WORDS = [(0x10 + n, 2) for n in range(4)]
VALUES = [part for n in range(4) for part in ((0x20 + n, 2), (0x5A5A0000 + n, 4))]
FRAMES = {
    "write": ask(p.REQUEST_KIND_WRITE, (4, 2), (0x20, 2), (7, 4)),
    "list": ask(
        p.REQUEST_KIND_LIST,
        *((4, 2), (0, 1), (p.LIST_OPERATION_WRITE, 1), (4, 1), *VALUES),
        *((p.LIST_OPERATION_READ, 1), (4, 1), *WORDS),
    ),
    "publish": ask(p.REQUEST_KIND_DEFINE_GROUP, (4, 2), (0, 1), (1, 4), (0, 1), (4, 1), *WORDS)
    + ask(p.REQUEST_KIND_WRITE_CONTROL, (5, 2), (p.CONTROL_PUBLISH, 2), (1, 4)),
    "dead-man": ask(p.REQUEST_KIND_WRITE_CONTROL, (4, 2), (p.CONTROL_DEADMAN_TICKS, 2), (1, 4)),
}
TICK = {"fast": 500, "small": 3500}  # clocks between two strobes
STEP = {"fast": 29, "small": 301}  # clocks between two moments of a reset


def session(nonce: int) -> bytes:
    """Return a new session, which reads all counters, the dead-man, `publish`, and a word."""
    counters = [(p.CONTROL_FRAMES, 9), (p.CONTROL_FRAMES + 9, 9), (p.CONTROL_DEADMAN_TICKS, 3)]
    reads = [
        ask(p.REQUEST_KIND_READ_CONTROL, (n, 2), (first, 2), (count, 1))
        for n, (first, count) in enumerate(counters)
    ]
    return opening(nonce) + b"".join(reads) + ask(p.REQUEST_KIND_READ, (3, 2), (0x30, 2))


def shown(answer: bytes) -> list[tuple[int, bytes]]:
    """Return kinds and payloads, but without the nonce and the time of the opening."""
    opened = [(frame.kind, b"") for frame in frames_of(answer, p.FRAME_OPEN_EPOCH)]
    return opened + [(frame.kind, frame.payload) for frame in frames_of(answer)]


@pytest.mark.parametrize("engine", TICK)
@pytest.mark.parametrize("frame", FRAMES)
def test_a_reset_within_a_frame_and_what_it_does(rtl: Any, engine: str, frame: str) -> None:
    """Nothing comes unasked behind it. The counters are as new, and nothing publishes."""
    tick = TICK[engine]
    settings = Settings(window=8, groups=1, group_size=8, base_hz=50_000_000 // tick)
    sent, steps = FRAMES[frame], [session(1)]
    moments = range(0, len(sent) + 3 * tick // 2, STEP[engine])
    for nonce, moment in enumerate(moments, 2):
        steps += [("send", sent[:moment].decode("latin-1"))] if moment else []
        steps += [("wait", moment - len(sent))] if moment > len(sent) else []
        steps += [("reset", 1), ("wait", 2 * tick), session(nonce)]
    answers = iter({"fast": framed, "small": small}[engine](rtl, settings, steps))
    new = shown(next(answers))
    assert [kind for kind, _ in new[:2]] == [p.DEVICE_KIND_HELLO, p.DEVICE_KIND_OPEN]
    assert len(new) == 6
    for moment in moments:
        for _ in range((moment > 0) + (moment > len(sent)) + 1):
            next(answers)  # of the frame, and of the reset
        assert next(answers) == b"", f"unasked behind a reset at clock {moment}"
        assert shown(next(answers)) == new, f"behind a reset at clock {moment}"
    assert not list(answers)
