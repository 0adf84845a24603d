# SPDX-License-Identifier: BSD-3-Clause
"""Analyse the gateware once a session, and run its self-checking benches in GHDL."""

from __future__ import annotations

import importlib
import os
import re
import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest

from unitylink.gateware import every_source
from unitylink.generate import generate_vhdl
from unitylink.interface.board_configuration import BoardConfiguration
from unitylink.spec import Spec
from unitylink_lab.conformance.rtl import RtlPlayer

SECONDS_MOST = 120  # a bench has a watchdog on simulated time; this limit is for a simulator that hangs


# A folder in which executed lines are counted, with the gcc backend of GHDL (tools/coverage.py). If it is
# empty, no lines are counted.
COVERAGE = os.environ.get("UNITYLINK_COVERAGE", "")
COUNT_LINES = ["-fprofile-arcs", "-ftest-coverage", "-Wl,-lgcov", "-Wl,--coverage"]

# Each of these warnings of GHDL is an error: what vendors' tools and newer versions of GHDL take amiss.
WARNINGS = """
    analyze-assert attribute binding body default-binding delayed-checks library nested-comment others
    parenthesis port port-bounds pure runtime-error shared specs static universal unused useless
"""
STRICT = [*(f"-W{warning}" for warning in WARNINGS.split()), "-Wno-hide", "-Werror"]


class Ghdl:
    """Run benches of analysed VHDL, at --std=08.

    `sources` are the library `work`. If there are `own` ones, those are, and `sources` are the library
    `unitylink`.
    """

    def __init__(
        self,
        work: Path,
        sources: Sequence[Path],
        own: Sequence[Path] = (),
        *,
        count_lines: bool = False,
        strict: bool = False,
    ) -> None:
        name = "ghdl-gcc" if count_lines else "ghdl"
        executable = shutil.which(name)
        assert executable, (
            f"{name} is missing: install the Debian package {name if count_lines else 'ghdl-mcode'}"
        )
        self.executable = executable
        self.work = work
        # Our own VHDL never compares an unknown value. Gates do, and so does a bus that decodes an address
        # without a strobe. So in netlists and generated designs, a warning of numeric_std means nothing.
        self.strict = strict
        # The GHDL that counts lines compiles unit by unit, and warns of checks that it delays.
        self.make = ["-m", "--std=08", *(COUNT_LINES if count_lines else STRICT)]
        self._call("-i", "--std=08", *(["--work=unitylink"] if own else []), *map(str, sources))
        if own:
            self._call("-i", "--std=08", *map(str, own))

    def run(self, bench: str, *options: str, **generics: int | str | bool) -> str:
        """Elaborate and run `bench`, and return its output.

        A failed assertion fails the test, and so does a bench that ends early.
        """
        self._call(*self.make, bench)
        settings = [
            f"-g{name}={str(value).lower() if isinstance(value, bool) else value}"
            for name, value in generics.items()
        ]
        checks = ["--assert-level=error", "--ieee-asserts=disable-at-0"]
        output = self._call("-r", "--std=08", bench, *settings, *checks, *options)
        assert re.search(rf"{bench}: passed", output), f"{bench} stopped before its end\n{output}"
        # the warnings that numeric_std gives
        doubts = [line for line in output.splitlines() if "(assertion warning)" in line]
        remedy = "a metavalue is a signal without a value before the reset: give it an initial one"
        assert not (self.strict and doubts), f"{bench}: {len(doubts)} warnings ({remedy}), first {doubts[0]}"
        return output

    def refuse(self, bench: str, message: str, **generics: int | str | bool) -> None:
        """Elaborate `bench` with generics that are not allowed. It must fail with `message`."""
        self._call(*self.make, bench)
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
        command = [self.executable, *arguments]
        done = subprocess.run(
            command, cwd=self.work, capture_output=True, text=True, timeout=SECONDS_MOST, check=False
        )
        output = done.stdout + done.stderr
        assert done.returncode == 0, f"{' '.join(command)}\nended with {done.returncode}\n{output[-6000:]}"
        return output


@pytest.fixture(scope="session")
def ghdl(tmp_path_factory: pytest.TempPathFactory) -> Ghdl:
    """All VHDL of gateware and components: entities and benches."""
    sources = every_source()
    if not COVERAGE:
        return Ghdl(tmp_path_factory.mktemp("ghdl"), sources, strict=True)
    work = Path(COVERAGE) / os.environ.get("PYTEST_XDIST_WORKER", "main")
    work.mkdir(parents=True)
    return Ghdl(work, sources, count_lines=True, strict=True)


@pytest.fixture
def rtl(ghdl: Ghdl, tmp_path: Path) -> RtlPlayer:
    """A player that gives steps to the core."""
    return RtlPlayer(ghdl, tmp_path)


class Designs:
    """Makes the designs of specs and plays messages to them through their UARTs."""

    def __init__(self, make: type[Ghdl], folder: Path) -> None:
        self.make = make
        self.folder = folder

    def library(
        self, spec: Spec, configuration: BoardConfiguration | None = None, others: Sequence[Path] = ()
    ) -> Ghdl:
        """Return the design and `others`, with all of the gateware."""
        for name, text in generate_vhdl(spec, configuration).items():
            (self.folder / name).parent.mkdir(exist_ok=True)
            (self.folder / name).write_text(text, encoding="utf-8")
        return self.make(self.folder, every_source(), [*sorted(self.folder.glob("vhdl/*.vhd")), *others])

    def play(
        self, spec: Spec, bench: str, steps: Sequence[str | int], others: Sequence[Path] = ()
    ) -> list[bytes]:
        """Send each text, or wait so many clocks, in a bench of designs/.

        Return what came during each step.
        """
        lines = [f"w {step}" if isinstance(step, int) else f"s {step.encode().hex()}" for step in steps]
        (self.folder / "steps.txt").write_text("\n".join(lines) + "\n", encoding="ascii")
        benches = Path(__file__).parent / "designs"
        self.library(spec, None, [benches / f"{bench}.vhd", *others]).run(bench)
        answers = (self.folder / "answers.txt").read_text(encoding="ascii").splitlines()
        assert len(answers) == len(steps)
        return [bytes.fromhex(answer.removesuffix("end")) for answer in answers]


@pytest.fixture
def designs(ghdl: Ghdl, tmp_path: Path) -> Designs:
    """Generated designs in a folder of their own."""
    return Designs(type(ghdl), tmp_path)


@pytest.fixture
def assembler(monkeypatch: pytest.MonkeyPatch) -> Any:
    """Import tools/small/assemble.py, which is no package."""
    monkeypatch.syspath_prepend(str(Path(__file__).resolve().parents[2] / "tools" / "small"))
    return importlib.import_module("assemble")
