# SPDX-License-Identifier: BSD-3-Clause
"""A board that stands still, and what a program prints on it."""

from __future__ import annotations

import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from unitylink.simulate import Board, Registers
from unitylink.spec.model import Spec


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


@contextmanager
def still(spec: Spec) -> Iterator[str]:
    with Board(spec, endpoint="tcp", plant=Still()) as board:
        yield board.url
