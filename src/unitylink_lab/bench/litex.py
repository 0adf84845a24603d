# SPDX-License-Identifier: BSD-3-Clause
"""LiteX: our reads against LiteX's CommUART, each through a pty to an instant device in another process.

LiteX's side is its own released client, in an environment of its own. The far end of its protocol is a small
C++ program (`bench/native/bench_uartbone.cpp`). Our far end is the twin, with a clock so fast that it is
instant too.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path

from .board import ADDRESS, FIRST_VALUE, layer4_word
from .figure import BenchError, Figure, Run
from .programs import Process, alone, made, native, twin
from .timing import Comparison, in_turns, times

RELEASE = "2024.12"
BLOCK_WORDS = 255
FIFO_BYTES = 4096  # holds a 255-word request and its reply
CLOCK_HZ = 1_000_000_000


def environment(run: Run) -> Path:
    """Return the Python interpreter that has LiteX. Install it the first time."""
    folder = run.build / "litex"
    python = folder / "bin" / "python"
    stamp = folder / f".litex-{RELEASE}"
    with alone(run.build):
        if stamp.exists():
            return python
        run.say(f"making an environment with LiteX {RELEASE} in {folder.relative_to(run.checkout)}")
        for command in (
            [sys.executable, "-m", "venv", str(folder)],
            [str(python), "-m", "pip", "--quiet", "install", f"litex=={RELEASE}", "pyserial"],
        ):
            made(command)
        stamp.touch()
    return python


def compare(run: Run, words: int, rounds: int, count: int, protocol: str = "classic") -> Comparison:
    """Time reads of `words` words on both sides, in turns. With 0 it is the single read."""
    from unitylink import connect

    python = environment(run)
    client = run.checkout / "bench" / "litex" / "client.py"
    with ExitStack() as stack:
        emulator = stack.enter_context(Process([native(run.checkout, "bench_uartbone")]))
        litex = stack.enter_context(Process([python, client, emulator.line()]))
        options = {"read_many": BLOCK_WORDS, "clock_hz": CLOCK_HZ, "fifo": FIFO_BYTES}
        board = stack.enter_context(twin("pty", **options))
        link = stack.enter_context(connect(f"{board.line()}?protocol={protocol}&fifo={FIFO_BYTES}"))
        word = layer4_word(link)
        addresses = list(range(ADDRESS, ADDRESS + words))

        def block() -> list[int]:
            values: list[int] = link.read_many(addresses).tolist()  # LiteX returns a list of whole numbers
            return values

        if words and block() != [FIRST_VALUE + address for address in addresses]:
            raise BenchError("the twin does not hold what was put there")
        call: Callable[[], object] = block if words else word.read

        def ours(n: int) -> list[int]:
            return times(call, n)

        def theirs(n: int) -> list[int]:
            return litex.series(f"{n} {words}")

        ours(count), theirs(count)  # both warm
        return in_turns(ours, theirs, rounds=run.rounds(rounds), count=count)


def figure(name: str, title: str, limit: float, result: Comparison) -> Figure:
    """Make the figure of a comparison."""
    return Figure(
        name,
        title,
        limit,
        False,
        1 / result.ratio,
        "x",
        {
            "ours us": result.ours_ns / 1e3,
            "LiteX us": result.theirs_ns / 1e3,
            "quartile low": 1 / result.high,
            "high": 1 / result.low,
        },
    )


def _single(run: Run, name: str, protocol: str) -> Figure:
    title = f"single reads, times LiteX {RELEASE}, pty, {protocol}"
    return figure(name, title, 1.25, compare(run, 0, 151, 100, protocol))


def _block(run: Run, name: str, protocol: str) -> Figure:
    title = f"{BLOCK_WORDS}-word reads, times LiteX {RELEASE}, pty, {protocol}"
    return figure(name, title, 5.0, compare(run, BLOCK_WORDS, 61, 20, protocol))


def measure_single(run: Run) -> Figure:
    """Measure single reads."""
    return _single(run, "litex-single", "classic")


def measure_single_framed(run: Run) -> Figure:
    """Measure single reads on frames."""
    return _single(run, "litex-single-framed", "framed")


def measure_block(run: Run) -> Figure:
    """Measure reads of 255 words."""
    return _block(run, "litex-block", "classic")


def measure_block_framed(run: Run) -> Figure:
    """Measure reads of 255 words on frames."""
    return _block(run, "litex-block-framed", "framed")
