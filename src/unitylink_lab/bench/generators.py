# SPDX-License-Identifier: BSD-3-Clause
"""The generators: from a large flat spec to every output, as a user runs them, in a new process each time."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from pathlib import Path
from resource import struct_rusage
from statistics import median
from time import perf_counter

from unitylink.generate import ARTEFACTS

from .figure import BenchError, Figure, Run
from .start_up import as_installed, flat_spec

_LAUNCHER = """
import resource, subprocess, sys
code = subprocess.call(sys.argv[1:], stdout=subprocess.DEVNULL)
print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)
sys.exit(code)
"""


def measure_thousand(run: Run) -> Figure:
    """Measure 1,000 registers to all outputs."""
    taken, busy = _generate(1_000, run.rounds(5, 1))
    title = f"1,000 registers to {_outputs()}"
    return Figure("generate-1k", title, 1.0, True, taken, "s", {"processor s": busy})


def measure_ten_thousand(run: Run) -> Figure:
    """Measure 10,000 registers to all outputs."""
    taken, busy = _generate(1_000 if run.quick else 10_000, run.rounds(3, 1))
    title = f"10,000 registers to {_outputs()}"
    return Figure("generate-10k", title, 8.0, True, taken, "s", {"processor s": busy})


def measure_memory(run: Run) -> Figure:
    """Measure the memory that the generators need."""
    with tempfile.TemporaryDirectory() as folder:
        command = _command(Path(folder), 1_000 if run.quick else 10_000)
        # A process starts with its parent's peak memory, and this process has measured other things. So a
        # small one starts it.
        launcher = [sys.executable, "-c", _LAUNCHER, *command, "--out", folder]
        done = subprocess.run(launcher, env=as_installed(), capture_output=True, text=True, check=False)
    if done.returncode:
        raise BenchError(f"`unitylink generate` ended with {done.returncode}: {done.stderr[-300:]}")
    peak = int(done.stdout) / 1024
    return Figure("generate-memory", "10,000 registers to all outputs, peak memory", 400, True, peak, "MB")


def _outputs() -> str:
    return ", ".join(ARTEFACTS)


def _command(folder: Path, registers: int) -> list[str]:
    """Write a spec of `registers` registers.

    Return the command that makes all its outputs. The caller adds the output folder.
    """
    spec = folder / "flat.ul"
    spec.write_text(flat_spec(registers), encoding="utf-8")
    return [sys.executable, "-m", "unitylink", "generate", str(spec), "--only", ",".join(ARTEFACTS)]


def _generate(registers: int, runs: int) -> tuple[float, float]:
    """Return the time and the processor time of making all artefacts, in s. Both are medians."""
    times: list[float] = []
    usages: list[struct_rusage] = []
    with tempfile.TemporaryDirectory() as folder:
        environment = as_installed()
        command = _command(Path(folder), registers)
        for number in range(runs + 1):  # the first run writes the byte code
            start = perf_counter()
            code, usage = _run([*command, "--out", str(Path(folder) / str(number))], environment)
            times.append(perf_counter() - start)
            usages.append(usage)
            if code:
                raise BenchError(f"`unitylink generate` of {registers:,} registers ended with {code}")
    return median(times[1:]), median(usage.ru_utime + usage.ru_stime for usage in usages[1:])


def _run(command: list[str], environment: Mapping[str, str]) -> tuple[int, struct_rusage]:
    """Run the command. Return its exit code and its use of resources."""
    quiet = [(os.POSIX_SPAWN_OPEN, 1, os.devnull, os.O_WRONLY, 0)]
    process = os.posix_spawn(command[0], command, environment, file_actions=quiet)
    _, status, usage = os.wait4(process, 0)
    return os.waitstatus_to_exitcode(status), usage
