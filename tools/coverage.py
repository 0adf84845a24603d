# SPDX-License-Identifier: BSD-3-Clause
"""Which lines of the gateware its benches execute: a table by file. It fails below 95 % of all lines.

    python tools/coverage.py             run tests/gateware, count, and record it in gateware/coverage.json
    python tools/coverage.py --report    the same of the last run
    python tools/coverage.py --benches gpio fifo    these benches only, with no record and no least share

The benches run with the gcc backend of GHDL, whose programs gcov understands. Netlists are left out: nobody
wrote them. A line without code of its own (declarations, `when`, `end`) does not count.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
import subprocess
import sys
from collections import defaultdict
from pathlib import Path

from unitylink.gateware import bench_sources, gateware_sources, simulation_sources
from unitylink.gateware.dependencies import plain_text

ROOT = Path(__file__).resolve().parent.parent
COUNTS = ROOT / "build" / "coverage"
RECORD = ROOT / "gateware" / "coverage.json"
PERCENT_LEAST = 95.0
# tests with these fixtures run a simulator that counts lines
_RUNS_A_BENCH = re.compile(r"\b(ghdl|rtl)\b: Any")
_NO_TESTS = 5  # pytest's exit code if no test has a name that fits


def digest() -> str:
    """Return 16 hex digits over all VHDL, designs and benches. Comments and blanks do not count."""
    said = hashlib.sha256()
    for path in sorted({*designs(), *bench_sources()}):
        said.update(f"{path.relative_to(ROOT)}\0{plain_text(path)}\0".encode())
    return said.hexdigest()[:16]


def designs() -> set[Path]:
    """Return the files whose lines count."""
    return {*gateware_sources(), *simulation_sources()}


def run_benches(only: list[str]) -> str:
    """Run the benches, or all of them if `only` is empty. Return what went wrong, or ""."""
    subprocess.run(["rm", "-rf", str(COUNTS)], check=True)
    chosen = f"({' or '.join(only)}) and " if only else ""
    options = ["-q", "-n", "2", "-k", f"{chosen}not netlist and not synthesis"]
    tests = ROOT / "tests" / "gateware"
    files = [str(path) for path in sorted(tests.glob("test_*.py")) if _RUNS_A_BENCH.search(path.read_text())]
    command = [sys.executable, "-m", "pytest", *files, *options]
    counting = {**os.environ, "UNITYLINK_COVERAGE": str(COUNTS)}
    code = subprocess.run(command, check=False, env=counting).returncode
    if code == _NO_TESTS:
        return f"no bench has {' or '.join(only)} in its name"
    return "a bench failed (see above)" if code else ""


def executed() -> dict[Path, dict[int, int]]:
    """Return how often each line of each file has been executed, over the programs of all workers."""
    total: dict[Path, dict[int, int]] = defaultdict(lambda: defaultdict(int))
    counted = designs()
    for folder in sorted(COUNTS.iterdir()):
        notes = sorted(path.name for path in folder.glob("*.gcno"))
        command = ["gcov", "--json-format", "--stdout", *notes]
        output = subprocess.run(command, cwd=folder, check=True, capture_output=True, text=True).stdout
        for document in output.splitlines():
            for file in json.loads(document)["files"]:
                path = Path(file["file"])
                if path in counted:
                    for line in file["lines"]:
                        total[path][line["line_number"]] += line["count"]
    return total


def ranges(numbers: list[int]) -> str:
    """Return `numbers` as ranges, such as 3-5, 9."""
    parts: list[list[int]] = []
    for number in numbers:
        if parts and parts[-1][1] == number - 1:
            parts[-1][1] = number
        else:
            parts.append([number, number])
    return ", ".join(str(first) if first == last else f"{first}-{last}" for first, last in parts)


def main(arguments: list[str]) -> int:
    benches = arguments[1:] if arguments[:1] == ["--benches"] else []
    if arguments not in ([], ["--report"]) and not benches:
        print(__doc__, file=sys.stderr)
        return 2
    if arguments != ["--report"] and (wrong := run_benches(benches)):
        print(wrong if benches else f"{wrong}, so {RECORD.name} stays as it was; mend it and run this again")
        return 1
    total = executed()
    absent = designs() - set(total)
    lines = reached = 0
    files = {}
    print(f"{'file':44} {'lines':>5} {'run':>5}     %  not executed")
    for path, counts in sorted(total.items()):
        missed = sorted(number for number, count in counts.items() if count == 0)
        lines, reached = lines + len(counts), reached + len(counts) - len(missed)
        percent = 100 * (1 - len(missed) / len(counts))
        name = path.relative_to(ROOT)
        files[str(name)] = {"lines": len(counts), "run": len(counts) - len(missed)}
        print(f"{name!s:44} {len(counts):5} {len(counts) - len(missed):5} {percent:5.1f}  {ranges(missed)}")
    percent = 100 * reached / lines
    print(f"{'all':44} {lines:5} {reached:5} {percent:5.1f}")
    if benches:
        return 0
    for path in sorted(absent):
        print(f"{path.relative_to(ROOT)}: nothing of it was executed")
    if absent or percent < PERCENT_LEAST:
        print(f"line coverage of the gateware must be {PERCENT_LEAST} % and every file must be run")
        return 1
    RECORD.write_text(json.dumps({"digest": digest(), "files": files}, indent=1) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
