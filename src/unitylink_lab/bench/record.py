# SPDX-License-Identifier: BSD-3-Clause
"""Record: the cost of `unitylink record` for 18 joints that are published 1000 times a second."""

from __future__ import annotations

import json
import resource
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from .figure import BenchError, Figure, Run
from .programs import twin

JOINTS = 18
RATE_HZ = 1000
SHORT_S = 1.0  # the length of the short recording, which holds the cost of starting
_SHARE = 0.99  # the share of the samples that must be recorded


def spec() -> str:
    """Return a spec with the joints of a walker, all published together at the base rate."""
    joints = "".join(
        f'   @j{n} = {n:#x}: signed READ(ID="joint {n}", PUBLISH(1, 1));\n' for n in range(JOINTS)
    )
    return f"link walker;\npublic walker() {{\n{joints}}}\n"


def _cpu_s() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def _record(url: str, folder: Path, duration_s: float) -> tuple[float, dict[str, Any]]:
    """Record for `duration_s`. Return the processor time of the recording process in s, and its output."""
    command = [
        sys.executable,
        "-m",
        "unitylink",
        "record",
        url,
        "--spec",
        str(folder / "walker.ul"),
        "--json",
    ]
    command += ["--out", str(folder / "walker.mcap"), "--force", "--duration", str(duration_s)]
    before_s = _cpu_s()
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if not done.stdout.strip():
        raise BenchError(f"`unitylink record` failed: {done.stderr.strip()[-300:]}")
    return _cpu_s() - before_s, json.loads(done.stdout)


def measure(run: Run) -> Figure:
    """Measure the figure: the cost of a long recording less that of a short one, over the time between."""
    long_s = SHORT_S + (2.0 if run.quick else 20.0)
    with tempfile.TemporaryDirectory() as name, twin("tcp") as board:
        folder = Path(name)
        (folder / "walker.ul").write_text(spec(), encoding="utf-8")
        url = board.line()
        short_cpu_s, short = _record(url, folder, SHORT_S)
        long_cpu_s, long = _record(url, folder, long_s)
    time_s = long["duration_s"] - short["duration_s"]
    samples = long["samples"] - short["samples"]
    complaint = f"{long['lost']} samples lost" if long["lost"] else ""
    if samples < _SHARE * RATE_HZ * time_s:
        complaint = f"only {samples} samples in {time_s:.1f} s"
    return Figure(
        "record",
        f"unitylink record, {JOINTS} joints x {RATE_HZ:,} Hz to MCAP",
        10,
        True,
        100 * (long_cpu_s - short_cpu_s) / time_s,
        "% of a core",
        {"samples": samples, "bytes": long["bytes"], "start and first second s": short_cpu_s},
        complaint,
        difference=True,
    )
