# SPDX-License-Identifier: BSD-3-Clause
"""The generators: a large flat spec to every output there is, as a user runs it, a new process each time."""

from __future__ import annotations

import os
import sys
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from resource import struct_rusage
from statistics import median
from time import perf_counter

from unitylink.generate import ARTEFACTS

from .figure import BenchError, Figure, Run
from .start_up import as_installed, flat_spec


def measure_thousand(run: Run) -> Figure:
    """Measure 1,000 registers to all outputs."""
    taken, busy, _ = _generate(1_000, run.rounds(5, 1))
    title = f"1,000 registers to {_outputs()}"
    return Figure("generate-1k", title, 1.0, True, taken, "s", {"processor s": busy})


def measure_ten_thousand(run: Run) -> Figure:
    """Measure 10,000 registers to all outputs."""
    taken, busy, _ = _generate(1_000 if run.quick else 10_000, run.rounds(3, 1))
    title = f"10,000 registers to {_outputs()}"
    return Figure("generate-10k", title, 8.0, True, taken, "s", {"processor s": busy})


def measure_memory(run: Run) -> Figure:
    """Measure the memory that takes."""
    _, _, peak = _generate(1_000 if run.quick else 10_000, 1)
    return Figure("generate-memory", "10,000 registers to all outputs, peak memory", 400, True, peak, "MB")


def _outputs() -> str:
    return ", ".join(ARTEFACTS)


def _generate(registers: int, runs: int) -> tuple[float, float, float]:
    """Return time in s, processor time in s (medians) and peak memory in MB of making all artefacts."""
    times: list[float] = []
    usages: list[struct_rusage] = []
    with tempfile.TemporaryDirectory() as folder:
        environment = as_installed()
        spec = Path(folder) / "flat.ul"
        spec.write_text(flat_spec(registers), encoding="utf-8")
        for number in range(runs + 1):  # the first run writes the byte code
            out = str(Path(folder) / str(number))
            start = perf_counter()
            command = ["generate", str(spec), "--out", out, "--only", ",".join(ARTEFACTS)]
            code, usage = _run(command, environment)
            times.append(perf_counter() - start)
            usages.append(usage)
            if code:
                raise BenchError(f"`unitylink generate` of {registers:,} registers ended with {code}")
    busy = median(usage.ru_utime + usage.ru_stime for usage in usages[1:])
    return median(times[1:]), busy, max(usage.ru_maxrss for usage in usages) / 1024


def _run(arguments: Sequence[str], environment: Mapping[str, str]) -> tuple[int, struct_rusage]:
    """Run the command; return its exit code and what it used."""
    quiet = [(os.POSIX_SPAWN_OPEN, 1, os.devnull, os.O_WRONLY, 0)]
    command = [sys.executable, "-m", "unitylink", *arguments]
    process = os.posix_spawn(sys.executable, command, environment, file_actions=quiet)
    _, status, usage = os.wait4(process, 0)
    return os.waitstatus_to_exitcode(status), usage
