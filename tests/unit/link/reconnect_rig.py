# SPDX-License-Identifier: BSD-3-Clause
"""A board behind a line that is cut. The board itself counts what was written to it."""

from __future__ import annotations

import time
from collections.abc import Callable

from unit.link.cut_wire import CutWire

from unitylink import Link, connect
from unitylink.simulate import Board, BoardConfiguration, FifoConfiguration

FIFO, SCRATCH = 0x40, 0x20
PATIENCE_S = 30.0
CONFIGURATION = BoardConfiguration(groups=4, fifos=(FifoConfiguration(base=FIFO, depth=1024),))


class Rig:
    """A board that can be cut off, or killed and made again. It keeps what was written to all of its lives.

    Each word written to the FIFO stays there, once for each write. So the board itself keeps the count.
    """

    def __init__(self, configuration: BoardConfiguration = CONFIGURATION) -> None:
        self.configuration = configuration
        self.written: list[int] = []
        self.board = Board(configuration=configuration, endpoint="tcp")
        self.wire = CutWire(self.board.url)

    @property
    def url(self) -> str:
        return self.wire.url

    def collect(self) -> None:
        while self.board.registers[FIFO + 1]:
            self.written.append(self.board.registers[FIFO])

    def restart(self) -> str:
        self.board.close()
        self.collect()
        self.board = Board(configuration=self.configuration, endpoint="tcp")
        self.wire.board_url = self.board.url
        return self.board.url

    def close(self) -> None:
        if not self.board.closed:
            self.wire.close()
            self.board.close()
            self.collect()


def opened(url: str, protocol: str, options: str = "") -> Link:
    """The timeout is long, because a busy machine must not look like a silent device."""
    return connect(f"{url}?timeout=5&protocol={protocol}{options}", reconnect=True)


def until(ready: Callable[[], object]) -> None:
    deadline = time.monotonic() + PATIENCE_S
    while not ready():
        assert time.monotonic() < deadline, "it did not come about"
        time.sleep(0.001)


def kinds(link: Link) -> list[str]:
    return [kind for kind, _, _ in link._native.events(0)[0]]
