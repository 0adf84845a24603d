# SPDX-License-Identifier: BSD-3-Clause
"""What this host's software costs, measured: processor time of the calling thread, which does all work."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass
from statistics import median
from time import thread_time_ns

SPEC = """link plain;
public experiment() {
   @input = 0x10: READ(ID="input");
   @output = 0x11: WRITE(ID="output");
}
"""


@dataclass(frozen=True)
class SoftwareCost:
    """Processor time of one request, in seconds: a bare script's and the full stack's."""

    script_read_s: float
    script_write_s: float
    stack_read_s: float
    stack_write_s: float


def measure(*, rounds: int, count: int = 100) -> SoftwareCost:
    """Measure `rounds` times `count` requests of each kind, in turns; the median round counts.

    Waiting for the virtual board takes no processor time, so it is not in the figures, and other programs on
    the machine disturb them little.
    """
    from unitylink import connect
    from unitylink.layer4_data import ReadValue, WriteValue, load_spec_objects
    from unitylink.simulate import Board, BoardConfiguration
    from unitylink.spec import compile_text

    spec = compile_text(SPEC.encode(), "experiment.ul").spec
    assert spec is not None
    configuration = BoardConfiguration(clock_hz=1_000_000_000)
    with Board(configuration=configuration) as first, Board(configuration=configuration) as second:
        descriptor = int(first.url.removeprefix("fd:"))
        os.set_blocking(descriptor, True)
        try:
            with connect(second.url) as link:
                tree = load_spec_objects(spec, link)
                word, output = tree["input"], tree["output"]
                assert isinstance(word, ReadValue) and isinstance(output, WriteValue)
                calls: list[Callable[[], object]] = [
                    lambda: _exchange(descriptor, b"#R:10\n"),
                    lambda: _exchange(descriptor, b"#W:1100000001\n"),
                    word.read,
                    lambda: output.write(1),
                ]
                samples: list[list[float]] = [[] for _ in calls]
                for _ in range(rounds):
                    for call, taken in zip(calls, samples, strict=True):
                        taken.append(thread_s(call, count))
        finally:
            os.close(descriptor)
    return SoftwareCost(*(median(taken) for taken in samples))


def _exchange(descriptor: int, request: bytes) -> bytes:
    """Do what a short script does: write, then read up to the line feed."""
    os.write(descriptor, request)
    reply = b""
    while not reply.endswith(b"\n"):
        reply += os.read(descriptor, 512)
    return reply


def thread_s(call: Callable[[], object], count: int) -> float:
    """Return the processor time of one of `count` calls, in seconds of this thread."""
    start = thread_time_ns()
    for _ in range(count):
        call()
    return (thread_time_ns() - start) / count * 1e-9
