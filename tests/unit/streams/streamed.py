# SPDX-License-Identifier: BSD-3-Clause
"""A served board whose samples go to streams, for tests."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from typing import Any

from unit.dashboard.robot import Still
from unit.server.served import Served, served

from unitylink.server.scopes import Rights
from unitylink.simulate import Board, BoardConfiguration
from unitylink.spec import compile_text
from unitylink.streams.source import Source

TEXT = """
enum Mode: u8 { off = 0; run = 3; }
public arm() {
   @position = 0x12: i32 READ(UNIT="deg", PUBLISH(100 Hz));
   @target = 0x1A: i16 WRITE(UNIT="deg", SCALE=0.1, MIN=-90, MAX=90, SAFE=0);
   @power = 0x1B: u16 READWRITE(SAFE=0);
   @other = 0x13: u16 READ();
   @alarm = 0x14: u16 READ(PUBLISH(on change));
   @mode = 0x1C: Mode READWRITE();
   @open = 0x1D: bool WRITE();
   @reset = 0x34: bool PULSE();
}
"""
EVERYTHING = Rights.of(["read"])


@contextmanager
def still() -> Iterator[Served]:
    """Serve a board on which nothing moves by itself."""
    spec = compile_text(TEXT, "arm.ul").spec
    assert spec is not None
    board = Board(spec, configuration=BoardConfiguration.for_spec(spec), plant=Still(), endpoint="tcp")
    with served(board, spec=spec) as one:
        yield one


@contextmanager
def streaming(one: Served, *streams: Any, token: str = "looks") -> Iterator[Source]:
    """Hand the samples of a served board to streams."""
    with tempfile.NamedTemporaryFile("w") as file:
        file.write(token)
        file.flush()
        with ExitStack() as stack:
            for stream in streams:
                stack.callback(stream.close)
            yield stack.enter_context(Source(one.url(f"&token_file={file.name}"), one.robot.spec, streams))


def until(check: Callable[[], Any], patience_s: float = 15.0) -> Any:
    end_s = time.monotonic() + patience_s
    while not (found := check()):
        assert time.monotonic() < end_s, "it does not happen"
        time.sleep(0.005)
    return found


__all__ = ["EVERYTHING", "Served", "still", "streaming", "until"]
