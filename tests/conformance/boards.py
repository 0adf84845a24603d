# SPDX-License-Identifier: BSD-3-Clause
"""A board that stands still, and what a program prints on it."""

from __future__ import annotations

import re
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from unitylink.simulate import Board, Registers
from unitylink.simulate.plant import load_plant
from unitylink.spec import load
from unitylink.spec.model import Spec

ROOT = Path(__file__).resolve().parents[2]


class Still:
    """A plant that moves nothing, so that each run finds the same words."""

    period_s = 1.0

    def attach(self, spec: Spec | None, registers: Registers) -> None:
        for address, word in {0x10: 0xFF00, 0x18: 1234, 0x1A: 2, 0x3E: 5, 0x3F: 77, 0x41: 42}.items():
            registers[address] = word

    def step(self, time_s: float) -> None:
        """Do nothing."""


def output(*command: str | Path) -> list[str]:
    done = subprocess.run(command, check=False, capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout.splitlines()


def board_of(page: str) -> Board:
    """Return the board that a page of docs/ serves, with its plant: another one would never come to 300."""
    text = (ROOT / "docs" / page).read_text("utf-8")
    (line,) = re.findall(r"^unitylink simulate (?:\.\./)?(.*) --tcp 5555 &$", text, re.M)
    source, _, plant = line.partition(" --plant ")
    return Board(load(ROOT / source), endpoint="tcp", plant=load_plant(plant or "ramp"))


@contextmanager
def still(spec: Spec) -> Iterator[str]:
    with Board(spec, endpoint="tcp", plant=Still()) as board:
        yield board.url
