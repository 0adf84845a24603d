# SPDX-License-Identifier: BSD-3-Clause
from __future__ import annotations

import threading

from unitylink.line_writer import LineWriter

PATIENCE_S = 20.0


def test_nobody_waits_for_a_reader_that_hangs() -> None:
    reads, takes, written = threading.Event(), threading.Event(), list[object]()

    def put(line: str) -> None:
        takes.set()
        reads.wait(PATIENCE_S)
        written.append(line)

    writer = LineWriter(put, most=3, tell_left_out=written.append)
    writer.write("first")
    assert takes.wait(PATIENCE_S)
    for number in range(10):
        writer.write(str(number))
    assert not written and writer.left_out == 7
    writer.close(0.0)  # it does not wait for the reader either
    writer.write("too late")
    reads.set()
    writer.close(PATIENCE_S)
    assert written == ["first", 7, "7", "8", "9"]


def test_the_end_writes_the_lines_that_wait() -> None:
    written = list[str]()
    writer = LineWriter(written.append, most=1000, tell_left_out=print)
    lines = [str(number) for number in range(100)]
    for line in lines:
        writer.write(line)
    writer.close(PATIENCE_S)
    assert written == lines and writer.left_out == 0
