# SPDX-License-Identifier: BSD-3-Clause
"""The samples of a board that is lost and comes back, and of one that comes late."""

from __future__ import annotations

import socket
from collections.abc import Mapping, Sequence
from typing import Any

import pytest
from unit.streams.streamed import still, streaming, until

from tests.unit.server.served import arm, served
from unitylink.simulate import Board
from unitylink.streams.topic import Batches, Topic


class Notes:
    """A stream that notes what it is told."""

    def __init__(self) -> None:
        self.topics: list[str] = []
        self.begun = 0
        self.gone: list[str] = []
        self.count = 0
        self.last_s = 0.0

    def begin(self, topics: Sequence[Topic], values: Mapping[str, Any]) -> None:
        self.topics = [topic.name for topic in topics]
        assert {value.path for topic in topics for value in topic.values} <= values.keys()
        self.begun += 1

    def take(self, batches: Batches) -> None:
        for topic, batch in batches.items():
            assert topic.name in self.topics and len(batch.times_s) == len(batch.rows)
            if topic.rate_hz == 100:
                assert batch.times_s[0] > self.last_s
                self.last_s = float(batch.times_s[-1])
                self.count += len(batch.rows)

    def away(self, why: str) -> None:
        self.gone.append(why)

    def close(self) -> None: ...


def test_the_samples_go_on_after_the_line_was_cut() -> None:
    notes = Notes()
    with still() as one, streaming(one, notes):
        until(lambda: notes.count > 20)
        assert (notes.begun, notes.topics.count("/arm/100_hz")) == (1, 1)
        one.board.hang_up()
        until(lambda: one.robot.report().get("statistics", {}).get("reconnections"))
        before = notes.count
        until(lambda: notes.count > before + 20)


@pytest.mark.takes(2)
def test_a_board_that_comes_after_the_streams_and_goes_and_comes() -> None:
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    notes = Notes()
    with served(url=f"tcp://127.0.0.1:{port}?timeout=0.5") as one, streaming(one, notes):
        until(lambda: notes.gone)
        assert "the board arm is away" in notes.gone[0] and not notes.begun
        for times in (1, 2):
            before = notes.count
            with Board(arm(), endpoint=f"tcp:{port}"):
                until(lambda before=before: notes.count > before + 20)
                gone = len(notes.gone)  # an attempt before that may have been told late
            until(lambda gone=gone: len(notes.gone) > gone)
            assert notes.begun >= times and all(notes.gone)
