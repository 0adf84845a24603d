# SPDX-License-Identifier: BSD-3-Clause
"""Analyse the gateware once a session, and run its self-checking benches in GHDL."""

from __future__ import annotations

import importlib
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest
from gateware.simulators import CompiledGhdl, CountingGhdl, Ghdl

from unitylink.gateware import every_source
from unitylink.generate import generate_vhdl
from unitylink.interface.board_configuration import BoardConfiguration
from unitylink.spec import Spec
from unitylink_lab.conformance.rtl import RtlPlayer

# A folder in which executed lines are counted, with the gcc backend of GHDL (tools/coverage.py). If it is
# empty, no lines are counted.
COVERAGE = os.environ.get("UNITYLINK_COVERAGE", "")


@pytest.fixture(scope="session")
def ghdl(tmp_path_factory: pytest.TempPathFactory) -> Ghdl:
    """All VHDL of gateware and components: entities and benches."""
    if not COVERAGE:
        return CompiledGhdl(tmp_path_factory.mktemp("ghdl"))
    work = Path(COVERAGE) / os.environ.get("PYTEST_XDIST_WORKER", "main")
    work.mkdir(parents=True)
    return CountingGhdl(work, every_source(), strict=True)


@pytest.fixture
def rtl(ghdl: Ghdl, tmp_path: Path) -> RtlPlayer:
    """A player that gives steps to the core."""
    return RtlPlayer(ghdl, tmp_path)


class Designs:
    """Makes the designs of specs and plays messages to them through their UARTs."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def library(
        self, spec: Spec, configuration: BoardConfiguration | None = None, others: Sequence[Path] = ()
    ) -> Ghdl:
        """Return the design and `others`, with all of the gateware."""
        for name, text in generate_vhdl(spec, configuration).items():
            (self.folder / name).parent.mkdir(exist_ok=True)
            (self.folder / name).write_text(text, encoding="utf-8")
        return Ghdl(self.folder, every_source(), [*sorted(self.folder.glob("vhdl/*.vhd")), *others])

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
def designs(tmp_path: Path) -> Designs:
    """Generated designs in a folder of their own."""
    return Designs(tmp_path)


@pytest.fixture
def assembler(monkeypatch: pytest.MonkeyPatch) -> Any:
    """Import tools/small/assemble.py, which is no package."""
    monkeypatch.syspath_prepend(str(Path(__file__).resolve().parents[2] / "tools" / "small"))
    return importlib.import_module("assemble")
