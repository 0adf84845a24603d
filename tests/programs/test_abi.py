# SPDX-License-Identifier: BSD-3-Clause
"""The shared library exports exactly what unitylink.h promises."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest

from unitylink.simulate import Board

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def library() -> Path:
    subprocess.run([ROOT / "tools" / "setup.sh", "native"], check=True)
    return ROOT / "build" / "native" / "libunitylink.so"


def test_symbols(library: Path) -> None:
    listing = subprocess.run(
        ["nm", "-D", "--defined-only", library], check=True, capture_output=True, text=True
    ).stdout
    shown = sorted(line.split()[2] for line in listing.splitlines())
    listed = (ROOT / "native" / "abi_symbols.txt").read_text().split()
    header = (ROOT / "native" / "include" / "unitylink.h").read_text()
    assert shown == listed
    assert sorted(re.findall(r"^UL_API .*?(ul_\w+)\(", header, re.M)) == listed


def test_it_is_the_core_alone(library: Path) -> None:
    """A user of a board from C does not load the model of one, nor the fault simulation."""
    has = subprocess.run(["nm", "-C", library], check=True, capture_output=True, text=True).stdout
    assert "unitylink::FramedEngine::" in has, "nm shows no inner symbols: was the library stripped?"
    assert not re.findall(r"unitylink::(?:device|faults)::\S+", has)


def test_the_c_example(library: Path, tmp_path: Path) -> None:
    program = tmp_path / "reader"
    strict = ["-std=c11", "-Wall", "-Wextra", "-Wpedantic", "-Werror"]
    place = [f"-I{ROOT / 'native' / 'include'}", f"-L{library.parent}", f"-Wl,-rpath,{library.parent}"]
    source = ROOT / "examples" / "c_reader" / "reader.c"
    subprocess.run(["cc", *strict, *place, source, "-lunitylink", "-o", program], check=True)

    def reader(*arguments: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run([program, *arguments], check=False, capture_output=True, text=True, timeout=60)

    with Board(endpoint="tcp") as board:
        board.registers[0x20] = 0xCAFE
        done = reader(board.url, "0x20", "5")
        assert (done.returncode, done.stderr) == (0, "")
        lines = done.stdout.splitlines()
        assert lines[0] == "0x0000cafe"
        assert [line.split()[-1] for line in lines[1:]] == ["0x0000cafe"] * 5
    done = reader("tcp://127.0.0.1:1", "0x20")
    assert done.returncode == 1
    assert done.stderr.startswith("open: tcp://127.0.0.1:1: nothing listens there")
    assert reader().returncode == 2
