# SPDX-License-Identifier: BSD-3-Clause
"""GHDL, which runs the self-checking benches.

`Ghdl` starts at once: for a few clocks of VHDL that changes. `CompiledGhdl` makes a program of each bench,
for all of the gateware. Its IEEE library is compiled with optimisation, which Debian's is not. So a bench
runs about three times as fast. The programs stay in `build/ghdl` until a source changes, and all workers
share them.
"""

from __future__ import annotations

import fcntl
import hashlib
import re
import shutil
import subprocess
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import pytest

from unitylink.gateware import every_source

SECONDS_MOST = 120  # a bench has a watchdog on simulated time; this limit is for a simulator that hangs
BUILD = Path(__file__).resolve().parents[2] / "build" / "ghdl"

COUNT_LINES = ["-fprofile-arcs", "-ftest-coverage", "-Wl,-lgcov", "-Wl,--coverage"]

# Each of these warnings of GHDL is an error: what vendors' tools and newer versions of GHDL take amiss.
WARNINGS = """
    analyze-assert attribute binding body default-binding library nested-comment others parenthesis port
    port-bounds pure runtime-error shared specs static universal unused useless
"""
STRICT = [*(f"-W{warning}" for warning in WARNINGS.split()), "-Wno-hide", "-Werror"]

# The packages of IEEE that the gateware uses, in the order of compilation.
IEEE = """
    ieee2008/std_logic_1164 ieee2008/std_logic_1164-body ieee2008/numeric_std ieee2008/numeric_std-body
    ieee/math_real ieee/math_real-body
"""


def executable(name: str, package: str) -> str:
    """Return the program, or fail with the package that has it."""
    found = shutil.which(name)
    assert found, f"{name} is missing: install the Debian package {package}"
    return found


class Ghdl:
    """Run benches of analysed VHDL, at --std=08.

    `sources` are the library `work`. If there are `own` ones, those are, and `sources` are the library
    `unitylink`.
    """

    def __init__(
        self, work: Path, sources: Sequence[Path], own: Sequence[Path] = (), *, strict: bool = False
    ) -> None:
        self.work = work
        # Our own VHDL never compares an unknown value. Gates do, and so does a bus that decodes an address
        # without a strobe. So in netlists and generated designs, a warning of numeric_std means nothing.
        self.strict = strict
        self._prepare()
        self._call("-i", "--std=08", *(["--work=unitylink"] if own else []), *map(str, sources))
        if own:
            self._call("-i", "--std=08", *map(str, own))

    def _prepare(self) -> None:
        self.executable = executable("ghdl", "ghdl-mcode")
        self.make = ["-m", "--std=08", *STRICT]

    def run(self, bench: str, *options: str, **generics: int | str | bool) -> str:
        """Elaborate and run `bench`, and return its output.

        A failed assertion fails the test, and so does a bench that ends early.
        """
        settings = [
            f"-g{name}={str(value).lower() if isinstance(value, bool) else value}"
            for name, value in generics.items()
        ]
        checks = ["--assert-level=error", "--ieee-asserts=disable-at-0"]
        output = called([*self._make(bench), *settings, *checks, *options], self.work)
        assert re.search(rf"{bench}: passed", output), f"{bench} stopped before its end\n{output}"
        # the warnings that numeric_std gives
        doubts = [line for line in output.splitlines() if "(assertion warning)" in line]
        remedy = "a metavalue is a signal without a value before the reset: give it an initial one"
        assert not (self.strict and doubts), f"{bench}: {len(doubts)} warnings ({remedy}), first {doubts[0]}"
        return output

    def _make(self, bench: str) -> list[str]:
        """Return the command that runs `bench`, without options."""
        self._call(*self.make, bench)
        return [self.executable, "-r", "--std=08", bench]

    def refuse(self, bench: str, message: str, **generics: int | str | bool) -> None:
        """Elaborate `bench` with generics that are not allowed. It must fail with `message`."""
        self._make(bench)
        with pytest.raises(AssertionError, match=re.escape(message)):
            self.run(bench, **generics)

    def synthesise(self, entity: str, *harmless: str) -> str:
        """Return the netlist of `entity` as VHDL, with its default generics. A warning fails the test."""
        self._call(*self.make, entity)
        output = self._call("--synth", "--std=08", entity)
        wrong = [
            line
            for line in output.splitlines()
            if "warning:" in line and not any(text in line for text in (*harmless, "unhandled attribute"))
        ]
        assert not wrong, wrong
        end = "end rtl;\n"  # `_call` appends GHDL's notes about memories after it
        return output[: output.rindex(end) + len(end)]

    def run_netlist(
        self, entity: str, work: Path, bench: str | None = None, **generics: int | str | bool
    ) -> None:
        """Run the bench of `entity` on its netlist. `generics` are those that differ from the bench's own."""
        path = work / f"{entity}.vhd"
        path.write_text(self.synthesise(entity))
        others = [source for source in every_source() if source.stem != entity]
        Ghdl(work, [*others, path]).run(bench or f"{entity}_tb", **generics)

    def _call(self, *arguments: str) -> str:
        return called([self.executable, *arguments], self.work)


class PatientGhdl(Ghdl):
    """For VHDL that changes and runs for long. It takes a second more to start, and then half the time."""

    def _prepare(self) -> None:
        self.executable = executable("ghdl-gcc", "ghdl-gcc")
        with locked():
            self.make = ["-m", *optimised_ieee(self.executable), "-O1"]


class CountingGhdl(Ghdl):
    """Its programs count how often each line is executed (tools/coverage.py)."""

    def _prepare(self) -> None:
        self.executable = executable("ghdl-gcc", "ghdl-gcc")
        # It compiles unit by unit, and warns of checks that it delays. So its warnings are no errors.
        with locked():
            self.make = ["-m", *optimised_ieee(self.executable), *COUNT_LINES]


class CompiledGhdl(Ghdl):
    """All VHDL of gateware and components. Benches are programs, which run in the folder `work`."""

    def __init__(self, work: Path) -> None:
        super().__init__(work, every_source(), strict=True)
        self.compiler = executable("ghdl-gcc", "ghdl-gcc")
        self.programs = BUILD / digest(every_source())

    def _make(self, bench: str) -> list[str]:
        """Return the program of a bench. It is made the first time."""
        with locked():
            if not self.programs.exists():
                for old in BUILD.glob("????????????????"):
                    shutil.rmtree(old)
                self.programs.mkdir()
                called([self.compiler, "-i", "--std=08", *map(str, every_source())], self.programs)
            program = self.programs / bench
            if not program.exists():
                called([self.compiler, "-m", *optimised_ieee(self.compiler), "-O1", bench], self.programs)
        return [str(program)]


def optimised_ieee(compiler: str) -> list[str]:
    """Compile IEEE's packages with optimisation, once. Return the options that use them."""
    version = called([compiler, "--version"], BUILD).splitlines()[0]
    folder = BUILD / f"ieee-{hashlib.sha256(f'{version}{IEEE}'.encode()).hexdigest()[:8]}"
    if not (stamp := folder / ".made").exists():
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir()
        for name in IEEE.split():
            path = Path(compiler).parents[1] / "lib" / "ghdl" / "src" / f"{name}.vhdl"
            options = ["--std=08", "--work=ieee", f"--workdir={folder}", f"-P{folder}", "-O3", "-Wno-hide"]
            called([compiler, "-a", *options, str(path)], BUILD)
        stamp.touch()
    return ["--std=08", "--ieee=none", f"-P{folder}"]


def digest(sources: Sequence[Path]) -> str:
    """Return 16 hex digits over the names and texts of the sources."""
    said = hashlib.sha256()
    for path in sources:
        said.update(f"{path}\0".encode() + path.read_bytes() + b"\0")
    return said.hexdigest()[:16]


@contextmanager
def locked() -> Iterator[None]:
    """Let one process at a time make programs."""
    BUILD.mkdir(parents=True, exist_ok=True)
    with (BUILD / ".lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield


def called(command: Sequence[str], folder: Path) -> str:
    """Return what the command prints. The test fails if the command does."""
    done = subprocess.run(
        command, cwd=folder, capture_output=True, text=True, timeout=SECONDS_MOST, check=False
    )
    output = done.stdout + done.stderr
    assert done.returncode == 0, f"{' '.join(command)}\nended with {done.returncode}\n{output[-6000:]}"
    return output
