# SPDX-License-Identifier: BSD-3-Clause
"""Generated proxies are clean to type checkers and linters, and a mistake of their user is a type error."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

from unit.generate.test_python import GOLDEN, MEETING, ROOT, SPECS, golden, spec_of

from unitylink.generate import write
from unitylink.spec import load

# A strict mypy without our settings. It reuses what `make check` has found out about the library.
MYPY = [sys.executable, "-m", "mypy", "--strict", f"--cache-dir={ROOT / '.mypy_cache'}", "--config-file="]
MYPY += ["--python-version=3.10"]


def test_generated_code_is_clean() -> None:
    """As in a user's own checks: strict types, default lint rules, default formatting and ours."""
    files = [str(golden(path)) for path in SPECS]
    assert set(GOLDEN.glob("*.py")) <= {golden(path) for path in SPECS}
    # arrays of packed words are laid out for 88 columns there, and fit in one line of 110
    wide = [file for file in files if Path(file).stem not in ("scara_stepper", "xyz_stage")]
    run = [sys.executable, "-m"]
    for command in (
        [*MYPY, *files],
        [*run, "ruff", "check", "--isolated", *files],
        [*run, "ruff", "format", "--isolated", "--check", *files],
        [*run, "ruff", "format", "--isolated", "--line-length=110", "--check", *wide],
    ):
        environment = os.environ | {"MYPYPATH": str(ROOT / "src")}
        done = subprocess.run(command, capture_output=True, text=True, cwd=ROOT, env=environment, check=False)
        assert done.returncode == 0, f"{' '.join(command[2:5])}:\n{done.stdout}{done.stderr}"


def test_a_users_mistakes_are_type_errors(tmp_path: Path) -> None:
    """It is checked in a user's place: outside of this checkout, with the installed library."""
    write(load(ROOT / "examples" / "scara" / "scara.ul"), tmp_path)
    lines = {
        "robot.j1.pos_sp.write(5)": "",
        "robot.j1.cpos.read() + 1": "",
        "robot.j1.cpos.write(5)": 'no attribute "write"',
        "robot.j1.pos_sp.read()": 'no attribute "read"',
        "robot.j1.pos_sp.write(1.5)": "incompatible type",
        "robot.j9.pos_sp.write(1)": 'no attribute "j9"',
        "robot.j1.cpos = 5": "Incompatible types",
        "Scara()": "Missing positional argument",
    }
    head = ["import unitylink", "from scara import Scara", 'robot = Scara(unitylink.connect("sim:scara.ul"))']
    (tmp_path / "user.py").write_text("\n".join([*head, *lines]) + "\n")
    done = subprocess.run([*MYPY, "user.py"], capture_output=True, text=True, cwd=tmp_path, check=False)
    said = done.stdout.splitlines()
    for number, (line, error) in enumerate(lines.items(), len(head) + 1):
        here = [text for text in said if text.startswith(f"user.py:{number}: error")]
        assert (len(here) == 1 and error in here[0]) if error else not here, (line, done.stdout)
    assert f"Found {sum(map(bool, lines.values()))} errors in 1 file" in said[-1]


def test_names_that_meet_in_the_module_are_clean(tmp_path: Path) -> None:
    (file,) = write(spec_of(MEETING), tmp_path)
    done = subprocess.run([*MYPY, str(file)], capture_output=True, text=True, cwd=tmp_path, check=False)
    assert done.returncode == 0, done.stdout
