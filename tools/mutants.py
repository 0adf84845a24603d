# SPDX-License-Identifier: BSD-3-Clause
"""Make each mistake of native/mutants.toml, one at a time, and check that it is caught.

The fault simulation catches it, or a native test, or the histories between programs (tests/apart).

    python tools/mutants.py              all of them
    python tools/mutants.py --sample 3   three of them
    python tools/mutants.py --only dedup

It needs the result of `make native-tests`. For a mutant, it compiles the batches with changed files again.
"""

from __future__ import annotations

import argparse
import re
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

ROOT = Path(__file__).resolve().parent.parent
SOURCES = ROOT / "native" / "src"
BUILD = ROOT / "build" / "native"
# in link order: each library uses those after it
LIBRARIES = (BUILD / "libunitylink_twin.a", BUILD / "libunitylink_core.a")
MESSAGES = 10_000
LONGEST_S = 120  # for one run
SEEDS = 24  # histories with one seed each, until one fails; some mistakes show only in one of twelve
MAIN = ROOT / "native" / "fuzz" / "fuzz_faults.cpp"
TESTS = ROOT / "native" / "test"  # a mutant with `test` runs this test instead of the simulation
BOARD = ROOT / "native" / "fuzz" / "journal_board.cpp"  # a mutant with `apart` is built into this board
HISTORIES = ROOT / "tests" / "apart" / "histories.py"
FLAGS = ["-std=c++20", "-O1", "-pthread", '-DUNITYLINK_VERSION="mutant"']
INCLUDED = re.compile(r'^#include "(.+)"$', re.M)


def batches() -> dict[Path, Path]:
    """Return, for each source, the batch of the library in which it is compiled."""
    cache = (BUILD / "CMakeCache.txt").read_text(encoding="utf-8")
    named = re.search(r"^UNITYLINK_OBJECTS:PATH=(.+)$", cache, re.M)
    objects = Path(named[1]) if named else BUILD
    found = [*(objects / "CMakeFiles").glob("unitylink_*_objects.dir/Unity/*.cxx")]
    return {Path(name): batch for batch in found for name in INCLUDED.findall(batch.read_text("utf-8"))}


def read_mutants() -> list[dict[str, Any]]:
    """Return the mistakes of native/mutants.toml."""
    table = tomllib.loads((ROOT / "native" / "mutants.toml").read_text(encoding="utf-8"))
    mutants: list[dict[str, Any]] = table["mutant"]
    return mutants


def edited(mutant: dict[str, Any]) -> dict[str, str]:
    """Return the changed files: name to text.

    Raises SystemExit if a file does not have the text exactly once.
    """
    texts: dict[str, str] = {}
    for edit in (mutant, *([mutant["also"]] if "also" in mutant else [])):
        name = edit["file"]
        text = texts.get(name, (SOURCES / name).read_text(encoding="utf-8"))
        if text.count(edit["find"]) != 1:
            times = text.count(edit["find"])
            raise SystemExit(
                f"{mutant['name']}: {name} has this {times} times instead of once: {edit['find']}"
            )
        texts[name] = text.replace(edit["find"], edit["replace"])
    return texts


def units_of(mutant: dict[str, Any]) -> list[Path]:
    """Return the sources that must be compiled: the changed ones, and those of its patterns."""
    names = {mutant["file"], *([mutant["also"]["file"]] if "also" in mutant else [])}
    units = [SOURCES / name for name in sorted(names) if name.endswith(".cpp")]
    return units + [path for pattern in mutant.get("units", []) for path in SOURCES.glob(pattern)]


def changed(mutant: dict[str, Any], folder: Path) -> list[Path]:
    """Write the changed files into `folder`. Return the whole batches that must be compiled with them.

    One file alone would define again what the rest of its batch in the library defines.
    """
    texts = edited(mutant)
    for name, text in texts.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    of = batches()
    written = []
    for batch in sorted({of[unit] for unit in units_of(mutant)}):
        text = batch.read_text(encoding="utf-8")
        for name in texts:
            text = text.replace(f'"{SOURCES / name}"', f'"{folder / name}"')
        written.append(folder / f"batch_{len(written)}.cxx")
        written[-1].write_text(text, encoding="utf-8")
    return written


def build(mutant: dict[str, Any], folder: Path) -> Path:
    """Compile and link one mutant."""
    include = [f"-I{folder}", f"-I{SOURCES}", f"-I{ROOT / 'native' / 'include'}"]
    objects = []
    mains = [BOARD if "apart" in mutant else MAIN]
    if "test" in mutant:
        mains = [TESTS / name for name in (mutant["test"], "main.cpp", "failing.cpp", "abi_test.c")]
    for number, unit in enumerate([*changed(mutant, folder), *mains]):
        objects.append(str(folder / f"{number}.o"))
        compiler = ["gcc", "-std=c11"] if unit.suffix == ".c" else ["g++", *FLAGS]
        subprocess.run([*compiler, *include, "-c", str(unit), "-o", objects[-1]], check=True)
    program = folder / "mutant"
    subprocess.run(["g++", *FLAGS, *objects, *map(str, LIBRARIES), "-ldl", "-o", str(program)], check=True)
    return program


def caught(mutant: dict[str, Any]) -> str:
    """Return what the simulation reports about a mutant, or "" if it reports nothing."""
    with tempfile.TemporaryDirectory(prefix="unitylink-mutant-") as folder:
        program = build(mutant, Path(folder))
        if "test" in mutant:
            done = subprocess.run(
                [str(program)], capture_output=True, text=True, timeout=LONGEST_S, check=False
            )
            failed = [line.strip() for line in done.stdout.splitlines() if "ERROR: CHECK" in line]
            return (failed or [f"it ended with {done.returncode}"])[0] if done.returncode else ""
        if "apart" in mutant:
            history = ["--profile", mutant["apart"], "--messages", str(MESSAGES), "--board", str(program)]
            done = subprocess.run(
                [sys.executable, str(HISTORIES), *history, "--keep", str(Path(folder) / "history")],
                capture_output=True,
                text=True,
                timeout=300,
                check=False,
            )
            accused = [line.strip() for line in done.stdout.splitlines() if ", executed [" in line]
            return accused[0] if done.returncode and accused else ""
        for seed in range(1, SEEDS + 1):
            history = ["--seed", str(seed), "--messages", str(MESSAGES), "--profile", mutant["profile"]]
            try:
                done = subprocess.run(
                    [str(program), *history], capture_output=True, text=True, timeout=LONGEST_S, check=False
                )
            except subprocess.TimeoutExpired:  # on a slow machine, this could happen without any mistake
                print(f"{mutant['name']}: no end within {LONGEST_S} s, seed {seed}", file=sys.stderr)
                return ""
            if done.returncode:
                lines = done.stdout.splitlines()
                return lines[1].strip() if len(lines) > 1 else f"it died with {done.returncode}"
    return ""


def main() -> int:
    plain = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=plain)
    parser.add_argument("--sample", type=int, default=0, metavar="N")
    parser.add_argument("--only", default="", metavar="TEXT")
    arguments = parser.parse_args()
    if not all(library.exists() for library in LIBRARIES):
        raise SystemExit("no build/native: run `make native-tests` first")
    mutants = [mutant for mutant in read_mutants() if arguments.only in mutant["name"]]
    if not mutants:
        raise SystemExit(f"no mutant has {arguments.only!r} in its name")
    if arguments.sample:
        mutants = mutants[:: -(-len(mutants) // arguments.sample)]
    missed = 0
    with ThreadPoolExecutor(2) as pool:
        for mutant, verdict in zip(mutants, pool.map(caught, mutants), strict=True):
            missed += not verdict
            print(f"{'caught' if verdict else 'MISSED'}  {mutant['name']}: {verdict}", flush=True)
    print(f"{len(mutants) - missed} of {len(mutants)} mutants caught")
    return int(missed > 0)


if __name__ == "__main__":
    sys.exit(main())
