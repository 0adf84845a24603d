# SPDX-License-Identifier: BSD-3-Clause
"""The measured cost of this host's software: processor time of the calling thread, which does all work."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from statistics import median
from time import thread_time_ns
from typing import TYPE_CHECKING

from .exchange import SPEC

if TYPE_CHECKING:
    from unitylink.simulate import Board


@dataclass(frozen=True)
class SoftwareCost:
    """Processor time of one request in seconds: of a bare classic script, and of the full stack on each
    protocol.
    """

    script_read_s: float
    script_write_s: float
    stack_read_s: float
    stack_write_s: float
    framed_read_s: float
    framed_write_s: float


def measure(*, rounds: int, count: int = 100) -> SoftwareCost:
    """Measure `rounds` times `count` requests of each kind, in turns.

    The result is that of the median round.

    Waiting for the virtual board takes no processor time, so it is not in the figures. Other programs on the
    machine disturb them little. Both sides share one processor. On a virtual machine, waking the board's
    thread on another processor takes several times as long as all that is measured. No link to a real board
    does that.
    """
    with ExitStack() as stack:
        stack.enter_context(on_processors())
        descriptor = stack.enter_context(_descriptor())
        calls: list[Callable[[], object]] = [
            lambda: _exchange(descriptor, b"#R:10\n"),
            lambda: _exchange(descriptor, b"#W:1100000001\n"),
        ]
        for protocol in ("classic", "framed"):
            calls += _requests(stack, protocol)
        samples: list[list[float]] = [[] for _ in calls]
        for _ in range(rounds):
            for call, taken in zip(calls, samples, strict=True):
                taken.append(thread_s(call, count))
    return SoftwareCost(*(median(taken) for taken in samples))


def _board() -> Board:
    from unitylink.simulate import Board, BoardConfiguration

    return Board(configuration=BoardConfiguration(clock_hz=1_000_000_000))


@contextmanager
def _descriptor() -> Iterator[int]:
    """Serve a board. Yield the descriptor for the bare script."""
    with _board() as board:
        descriptor = int(board.url.removeprefix("fd:"))
        os.set_blocking(descriptor, True)
        try:
            yield descriptor
        finally:
            os.close(descriptor)


def _requests(stack: ExitStack, protocol: str) -> list[Callable[[], object]]:
    """Return a read and a write through generated objects. Their board is served until `stack` ends."""
    from unitylink import connect
    from unitylink.layer4_data import ReadValue, WriteValue, load_spec_objects
    from unitylink.spec import compile_text

    spec = compile_text(SPEC.encode(), "experiment.ul").spec
    assert spec is not None
    board = stack.enter_context(_board())
    link = stack.enter_context(connect(f"{board.url}?protocol={protocol}"))
    tree = load_spec_objects(spec, link)
    word, output = tree["input"], tree["output"]
    assert isinstance(word, ReadValue) and isinstance(output, WriteValue)
    return [word.read, lambda: output.write(1)]


def _exchange(descriptor: int, request: bytes) -> bytes:
    """Do what a short script does: write, then read up to the line feed."""
    os.write(descriptor, request)
    reply = b""
    while not reply.endswith(b"\n"):
        reply += os.read(descriptor, 512)
    return reply


def thread_s(call: Callable[[], object], count: int) -> float:
    """Return the processor time that one of `count` calls takes in this thread, in seconds."""
    start = thread_time_ns()
    for _ in range(count):
        call()
    return (thread_time_ns() - start) / count * 1e-9


@contextmanager
def on_processors(processors: Iterable[int] | None = None) -> Iterator[None]:
    """Keep this thread on these processors, or on one.

    The threads that it starts meanwhile stay there too.
    """
    allowed = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {min(allowed)} if processors is None else processors)
    try:
        yield
    finally:
        os.sched_setaffinity(0, allowed)
