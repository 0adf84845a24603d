# SPDX-License-Identifier: BSD-3-Clause
"""All figures of one run, shown as a table and saved as JSON."""

from __future__ import annotations

import json
import os
import platform
import sys
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from unitylink.commands.output import plain_table
from unitylink.output_file import replace_file

from .figure import Figure, number


def machine() -> dict[str, str]:
    """Describe the machine in general terms."""
    model = platform.processor() or platform.machine()
    cpuinfo = Path("/proc/cpuinfo")
    if cpuinfo.exists():
        for line in cpuinfo.read_text(errors="replace").splitlines():
            if line.startswith("model name"):
                model = line.partition(":")[2].strip()
                break
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return {
        "processor": model,
        "cores": str(cores),
        "system": f"{platform.system()} {platform.release()}",
        "python": platform.python_version(),
        "load_before": f"{os.getloadavg()[0]:.2f}",
    }


@dataclass(frozen=True)
class Report:
    """The figures of a run, the reasons why others could not be measured, and the machine."""

    figures: tuple[Figure, ...]
    failures: Mapping[str, str] = field(default_factory=dict)
    quick: bool = False
    machine: dict[str, str] = field(default_factory=machine)

    @property
    def met(self) -> bool:
        """Tell whether every figure was measured and reaches its limit."""
        return not self.failures and all(figure.met for figure in self.figures)

    HEADERS = ("figure", "asked", "measured", "met")

    def rows(self) -> list[tuple[str, str, str, str]]:
        """Return the table, one row for each figure."""
        return [
            (f.title, f.asked, f"{number(f.measured)} {f.unit}", "yes" if f.met else "NO")
            for f in self.figures
        ]

    def text(self) -> str:
        """Return the report for people: the table, then the absolute numbers behind it."""
        lines = plain_table(self.HEADERS, self.rows(), right=(2,))
        lines.append("")
        for figure in self.figures:
            details = ", ".join(f"{name} {number(value)}" for name, value in figure.details.items())
            if details:
                lines.append(f"{figure.name}: {details}")
            if figure.complaint:
                lines.append(f"{figure.name}: does not count: {figure.complaint}")
        for name, reason in self.failures.items():
            lines.append(f"{name}: not measured: {reason}")
        lines.append("")
        lines.append(", ".join(f"{name} {value}" for name, value in self.machine.items()))
        missed = len(self.failures) + sum(not figure.met for figure in self.figures)
        count = len(self.failures) + len(self.figures)
        verdict = f"{missed} of {count} figures missed" if missed else "every figure met"
        lines.append(f"{verdict}{' (quick form: numbers are rough)' if self.quick else ''}")
        return "\n".join(lines)

    def to_json(self) -> dict[str, object]:
        """Return the report for JSON."""
        return {
            "machine": self.machine,
            "quick": self.quick,
            "met": self.met,
            "figures": [figure.to_json() for figure in self.figures],
            "failures": dict(self.failures),
        }

    def write(self, path: Path) -> None:
        """Save the report as JSON. The file is either whole or not written at all."""
        path.parent.mkdir(parents=True, exist_ok=True)
        replace_file(path, json.dumps(self.to_json(), indent=2) + "\n")


def say(message: str) -> None:
    """Print a line of progress on stderr."""
    print(message, file=sys.stderr, flush=True)
