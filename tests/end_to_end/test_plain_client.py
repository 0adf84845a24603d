# SPDX-License-Identifier: BSD-3-Clause
"""docs/protocol.md is enough: a client of 60 lines without our library talks to the device."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from unitylink.interface.board_configuration import BoardConfiguration
from unitylink.simulate import Board

CLIENT = Path(__file__).resolve().parents[2] / "examples" / "plain_client" / "client.py"


def run(*arguments: str) -> str:
    done = subprocess.run(
        [sys.executable, "-I", str(CLIENT), *arguments],
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_the_plain_client_writes_and_reads() -> None:
    with Board(configuration=BoardConfiguration(address_bits=16), endpoint="tcp") as board:
        address = board.url.removeprefix("tcp://")
        assert run(address, "0x10", "42") == "0x10 = 42\n"
        assert board.registers[0x10] == 42
        # this word has zero bytes, and the first byte of a classic message
        board.registers[0x11] = 0x01002300
        assert run(address, "0x11") == f"0x11 = {0x01002300}\n"


def test_it_is_as_short_as_it_says() -> None:
    lines = CLIENT.read_text(encoding="utf-8").splitlines()
    code = [line for line in lines if line.strip() and not line.lstrip().startswith(("#", '"""'))]
    assert len(code) <= 60
