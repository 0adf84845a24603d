# SPDX-License-Identifier: BSD-3-Clause
"""A served board whose samples go to streams, for tests."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from unit.dashboard.robot import Still
from unit.server.served import Served, arm, served

from unitylink.server.scopes import Rights
from unitylink.simulate import Board, BoardConfiguration
from unitylink.streams.source import Source, Stream

EVERYTHING = Rights.of(["read"])


@contextmanager
def still() -> Iterator[Served]:
    """Serve a board on which nothing moves by itself."""
    spec = arm()
    board = Board(spec, configuration=BoardConfiguration.for_spec(spec), plant=Still(), endpoint="tcp")
    with served(board) as one:
        yield one


@contextmanager
def streaming(one: Served, *streams: Stream, token: str = "looks") -> Iterator[Source]:
    """Hand the samples of a served board to streams."""
    with tempfile.NamedTemporaryFile("w") as file:
        file.write(token)
        file.flush()
        with Source(one.url(f"&token_file={file.name}"), one.robot.spec, streams) as source:
            yield source


def until(check: Callable[[], Any], patience_s: float = 15.0) -> Any:
    end_s = time.monotonic() + patience_s
    while not (found := check()):
        assert time.monotonic() < end_s, "it does not happen"
        time.sleep(0.005)
    return found


__all__ = ["EVERYTHING", "Served", "still", "streaming", "until"]
