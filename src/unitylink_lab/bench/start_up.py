# SPDX-License-Identifier: BSD-3-Clause
"""Start-up: the command line as a user runs it, in a new process each time."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from statistics import median

from unitylink.resources import cache_folder

from .figure import BenchError, Figure, Run
from .timing import times

STATEMENTS = 10_000


def flat_spec(statements: int) -> str:
    """Return a spec of `statements` READs and WRITEs in turns."""
    lines = ["link flat;", "public flat() {"]
    for index in range(statements):
        kind = ("READ", "signed READ", "WRITE", "signed WRITE")[index % 4]
        lines.append(f'   @r{index} = {index:#x}: {kind}(ID="register {index}");')
    return "\n".join([*lines, "}", ""])


def as_installed() -> dict[str, str]:
    """Return an environment in which Python keeps its byte code, in the user's cache.

    An installed package comes with byte code. A checkout without byte code would compile the library at each
    start.
    """
    environment = dict(os.environ)
    environment.pop("PYTHONDONTWRITEBYTECODE", None)
    return environment | {"PYTHONPYCACHEPREFIX": str(cache_folder("byte-code"))}


def seconds(arguments: Sequence[str], runs: int) -> float:
    """Return the median time of `runs` runs of the command, in s."""
    script = Path(sys.executable).with_name("unitylink")
    command = [str(script)] if script.exists() else [sys.executable, "-m", "unitylink"]

    def call() -> None:
        done = subprocess.run(
            [*command, *arguments], capture_output=True, text=True, check=False, env=environment
        )
        if done.returncode:
            said = (done.stderr or done.stdout).strip()[-300:]
            raise BenchError(f"`unitylink {' '.join(arguments)}` failed: {said}")

    environment = as_installed()
    call()  # the first run writes the byte code
    return median(times(call, runs)) / 1e9


def measure_check(run: Run) -> Figure:
    """Measure `unitylink check` of a flat spec."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "flat.ul"
        path.write_text(flat_spec(STATEMENTS), encoding="utf-8")
        taken = seconds(["check", str(path)], run.rounds(7, 1))
    return Figure("check", f"unitylink check, {STATEMENTS:,} flat statements", 1.5, True, taken, "s")


def measure_import(run: Run) -> Figure:
    """Measure two Python processes: one imports the library and ends, the other also imports what opens a
    link.
    """

    def python(code: str) -> float:
        def call() -> None:
            subprocess.run([sys.executable, "-c", code], check=True, env=environment)

        call()
        return median(times(call, run.rounds(15, 1))) / 1e6

    environment = as_installed()
    details = {"python alone ms": python(""), "with connect ms": python("from unitylink import connect")}
    return Figure("import", "import unitylink", 60, True, python("import unitylink"), "ms", details)


def measure_version(run: Run) -> Figure:
    """Measure `unitylink --version`."""
    bare = times(lambda: subprocess.run([sys.executable, "-c", ""], check=True), run.rounds(15, 1))
    taken = seconds(["--version"], run.rounds(15, 1)) * 1e3
    return Figure(
        "version", "unitylink --version", 150, True, taken, "ms", {"python alone ms": median(bare) / 1e6}
    )
