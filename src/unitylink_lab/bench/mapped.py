# SPDX-License-Identifier: BSD-3-Clause
"""Mapped memory: a read through layer 4 from Python, where the registers are memory (`mmap:`)."""

from __future__ import annotations

import statistics
import tempfile

from .board import ADDRESS, FIRST_VALUE, layer4_word
from .figure import Figure, Run
from .timing import times

_BYTES = 4096


def measure(run: Run) -> Figure:
    """Measure the figure on a file of shared memory. A real bus adds its own time."""
    from unitylink import connect

    with tempfile.NamedTemporaryFile(prefix="unitylink-bench-") as file:
        file.truncate(_BYTES)
        with connect(f"mmap:{file.name}") as link:
            link.write(ADDRESS, FIRST_VALUE + ADDRESS)
            read = layer4_word(link).read
            count = 200 if run.quick else 2000
            times(read, count)
            rounds = run.rounds(51)
            layer_4 = [statistics.median(times(read, count)) for _ in range(rounds)]
            layer_2 = [statistics.median(times(lambda: link.read(ADDRESS), count)) for _ in range(rounds)]
    return Figure(
        "mmap",
        "layer-4 read from Python, mapped memory",
        2.0,
        True,
        statistics.median(layer_4) / 1e3,
        "us",
        {"layer 2 us": statistics.median(layer_2) / 1e3},
    )
