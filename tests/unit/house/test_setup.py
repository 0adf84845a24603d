# SPDX-License-Identifier: BSD-3-Clause
"""As root, tools/setup.sh installs only what it has named before. As another user it installs nothing."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import pytest

SETUP = Path(__file__).resolve().parents[3] / "tools" / "setup.sh"


@pytest.fixture
def machine(tmp_path: Path) -> Path:
    """A checkout, on a machine without GHDL and Verilator. Its fake apt-get notes its arguments."""
    (tmp_path / "tools").mkdir()
    (tmp_path / "tools" / "setup.sh").write_text(SETUP.read_text(encoding="utf-8"), encoding="utf-8")
    programs = tmp_path / "bin"
    programs.mkdir()
    for name in ("bash", "mkdir", "flock", "dirname", "sed", "tail", "cat", "grep"):
        found = next(
            Path(place) / name for place in os.defpath.split(":")[::-1] if (Path(place) / name).exists()
        )
        (programs / name).symlink_to(found)
    script(programs / "apt-get", 'echo "$@" >> said; cat told >> seen 2>/dev/null; exit 0')
    return tmp_path


def script(path: Path, text: str) -> None:
    path.write_text(f"#!{path.parent / 'bash'}\n{text}\n")
    path.chmod(0o755)


def run(machine: Path, user: int) -> subprocess.CompletedProcess[str]:
    script(machine / "bin" / "id", f"echo {user}")
    with (machine / "told").open("w") as told:  # a file, so that apt-get can read what was printed before
        command = [machine / "bin" / "bash", machine / "tools" / "setup.sh", "rtl"]
        done = subprocess.run(
            command,
            env={"PATH": str(machine / "bin")},
            stdout=told,
            stderr=subprocess.PIPE,
            text=True,
            check=False,
            timeout=60,
        )
    return done


def test_as_root_it_names_what_it_installs_before_it_does(machine: Path) -> None:
    done = run(machine, 0)
    assert done.returncode == 0, done.stderr
    assert "install" in (machine / "said").read_text() and "ghdl verilator" in (machine / "said").read_text()
    first = (machine / "seen").read_text().splitlines()[0]
    assert first == "installing with apt-get, as root: ghdl verilator"


def test_as_anybody_else_it_names_what_is_missing_and_stops(machine: Path) -> None:
    done = run(machine, 1000)
    assert done.returncode == 1 and not (machine / "said").exists()
    assert "missing: ghdl, verilator; on Debian or Ubuntu: sudo apt-get install ghdl verilator" in done.stderr


def test_it_waits_while_another_program_uses_apt(machine: Path) -> None:
    lock = "E: Could not get lock /var/lib/apt/lists/lock. It is held by process 7 (apt-get)"
    script(machine / "bin" / "sleep", "echo waited >> slept")
    script(
        machine / "bin" / "apt-get",
        f'echo "$@" >> said; [ -e slept ] && exit 0; echo "{lock}"; exit 100',
    )
    done = run(machine, 0)
    assert done.returncode == 0, done.stderr
    assert (machine / "slept").read_text() == "waited\n"
    assert "another program uses apt; waiting for it" in (machine / "told").read_text()


def test_it_waits_for_nothing_else(machine: Path) -> None:
    script(machine / "bin" / "sleep", "echo waited >> slept")
    script(machine / "bin" / "apt-get", 'echo "E: Unable to locate package verilator"; exit 100')
    done = run(machine, 0)
    assert done.returncode == 1 and not (machine / "slept").exists()
    assert "E: Unable to locate package verilator" in done.stderr
