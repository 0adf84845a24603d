# SPDX-License-Identifier: BSD-3-Clause
"""Analyses the gateware once a session and runs its self-checking benches in GHDL."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest

from unitylink.board_configuration import BoardConfiguration
from unitylink.generate import generate_vhdl
from unitylink.spec import Spec

GATEWARE = Path(__file__).resolve().parents[2] / "gateware"
SECONDS_MOST = 120  # a bench has its own watchdog on simulated time; this one is for a simulator that hangs


# A folder: count executed lines there, with the gcc backend of GHDL (tools/coverage.sh). Empty: no counting.
COVERAGE = os.environ.get("UNITYLINK_COVERAGE", "")
COUNT_LINES = ["-fprofile-arcs", "-ftest-coverage", "-Wl,-lgcov", "-Wl,--coverage"]


class Ghdl:
    """Run benches of one library of analysed VHDL, at --std=08."""

    def __init__(self, work: Path, sources: Sequence[Path], *, count_lines: bool = False) -> None:
        name = "ghdl-gcc" if count_lines else "ghdl"
        executable = shutil.which(name)
        assert executable, (
            f"{name} is missing: install the Debian package {name if count_lines else 'ghdl-mcode'}"
        )
        self.executable = executable
        self.work = work
        self.make = ["-m", "--std=08", "-Wno-hide", *(COUNT_LINES if count_lines else [])]
        self._call("-i", "--std=08", *map(str, sources))

    def run(self, bench: str, *options: str, **generics: int | str | bool) -> str:
        """Elaborate and run `bench`; its output. A failed assertion fails the test, as does an early end."""
        self._call(*self.make, bench)
        settings = [
            f"-g{name}={str(value).lower() if isinstance(value, bool) else value}"
            for name, value in generics.items()
        ]
        checks = ["--assert-level=error", "--ieee-asserts=disable-at-0"]
        output = self._call("-r", "--std=08", bench, *settings, *checks, *options)
        assert re.search(rf"{bench}: passed", output), f"{bench} stopped before its end\n{output}"
        return output

    def refuse(self, bench: str, message: str, **generics: int | str | bool) -> None:
        """Elaborate `bench` with generics that may not be: it must fail, and say `message`."""
        self._call(*self.make, bench)
        with pytest.raises(AssertionError, match=re.escape(message)):
            self.run(bench, **generics)

    def synthesise(self, entity: str, *harmless: str) -> str:
        """The netlist of `entity`, as VHDL, with its default generics; a warning fails the test."""
        self._call(*self.make, entity)
        output = self._call("--synth", "--std=08", entity)
        wrong = [
            line
            for line in output.splitlines()
            if "warning:" in line and not any(text in line for text in harmless)
        ]
        assert not wrong, wrong
        end = "end rtl;\n"  # behind it `_call` puts GHDL's notes about memories it found
        return output[: output.rindex(end) + len(end)]

    def run_netlist(self, entity: str, work: Path, **generics: int | str | bool) -> None:
        """Run the bench of `entity` on its netlist; `generics` are those that differ from the bench's own."""
        path = work / f"{entity}.vhd"
        path.write_text(self.synthesise(entity))
        others = [source for source in sorted(GATEWARE.rglob("*.vhd")) if source.stem != entity]
        Ghdl(work, [*others, path]).run(f"{entity}_tb", **generics)

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
    """All of gateware/, entities and benches."""
    sources = sorted(GATEWARE.rglob("*.vhd"))
    if not COVERAGE:
        return Ghdl(tmp_path_factory.mktemp("ghdl"), sources)
    work = Path(COVERAGE) / os.environ.get("PYTEST_XDIST_WORKER", "main")
    work.mkdir(parents=True)
    return Ghdl(work, sources, count_lines=True)


class RtlPlayer:
    """Plays steps to the core in GHDL, as conformance_bench.play_on_twin does to the twin."""

    def __init__(self, ghdl: Ghdl, folder: Path) -> None:
        self.ghdl = ghdl
        self.folder = folder
        self.runs = 0
        self.times: list[
            tuple[str, int, int]
        ] = []  # of the last run: see replay_tb; kind, clock, byte or address or -1

    def __call__(
        self,
        configuration: BoardConfiguration,
        exchanges: Sequence[Sequence[tuple[str, Any]]],
        **generics: int | str,
    ) -> list[bytes]:
        """Do the exchanges in order from reset; the bytes sent during each one."""
        self.runs += 1
        steps_file = self.folder / f"steps_{self.runs}.txt"
        answers_file = self.folder / f"answers_{self.runs}.txt"
        steps = [step for exchange in exchanges for step in exchange]
        steps_file.write_text(
            "".join(
                f"{kind[0]} {argument.encode('latin-1').hex() if kind == 'send' else argument}\n"
                for kind, argument in steps
            ),
            encoding="ascii",
        )
        self.ghdl.run(
            "replay_tb",
            **{
                "steps_file": str(steps_file),
                "answers_file": str(answers_file),
                "address_width": configuration.address_bits,
                "data_width": configuration.data_bits,
                "base_hz": configuration.base_hz,
                "groups": configuration.groups,
                "group_size": configuration.group_size,
                "rate_bytes": configuration.rate_bytes,
                "read_many": configuration.read_many,
                "publish_mode": configuration.publish_mode,
                "with_rlc": int(configuration.configuration_command),
                "datalink": configuration.datalink,
                "checksum": configuration.checksum,
                "polynomial": configuration.polynomial,
                "edge_events": sum(1 << group for group in configuration.edge_event_groups),
                "recorded": int(configuration.bench_memory),
                **generics,
            },
        )
        sent: list[bytes] = [b""]
        self.times = []
        for line in answers_file.read_text(encoding="ascii").splitlines():
            kind, *numbers = line.split()
            if numbers:
                self.times.append((kind, int(numbers[0]), int(numbers[1]) if len(numbers) > 1 else -1))
            if kind == "b":
                sent[-1] += bytes([int(numbers[1])])
            elif kind == "s":
                sent.append(b"")
        assert len(sent) == len(steps) + 1, f"{len(sent) - 1} of {len(steps)} steps were played"
        after_all = sent.pop()
        sent[-1] += after_all
        parts = iter(sent)
        return [b"".join(next(parts) for _ in exchange) for exchange in exchanges]


@pytest.fixture
def rtl(ghdl: Ghdl, tmp_path: Path) -> RtlPlayer:
    """Plays steps to the core."""
    return RtlPlayer(ghdl, tmp_path)


class Designs:
    """Makes the designs of specs and plays messages to them through their UARTs."""

    def __init__(self, make: type[Ghdl], folder: Path) -> None:
        self.make = make
        self.folder = folder

    def library(
        self, spec: Spec, configuration: BoardConfiguration | None = None, others: Sequence[Path] = ()
    ) -> Ghdl:
        """The design, all of the gateware, and `others`."""
        for name, text in generate_vhdl(spec, configuration).items():
            (self.folder / name).parent.mkdir(exist_ok=True)
            (self.folder / name).write_text(text, encoding="utf-8")
        gateware = sorted(GATEWARE.rglob("*.vhd"))
        return self.make(self.folder, [*gateware, *sorted(self.folder.glob("vhdl/*.vhd")), *others])

    def play(
        self, spec: Spec, bench: str, steps: Sequence[str | int], others: Sequence[Path] = ()
    ) -> list[bytes]:
        """Send each text, or wait so many clocks, in a bench of designs/; what came during each step."""
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
