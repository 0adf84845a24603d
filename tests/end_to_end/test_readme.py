# SPDX-License-Identifier: BSD-3-Clause
"""A stranger can type what README and docs/start.md print, and it works."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from pathlib import Path

from unitylink.spec import compile_text

ROOT = Path(__file__).resolve().parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")
START = (ROOT / "docs" / "start.md").read_text(encoding="utf-8")
UNITYLINK = Path(sys.executable).with_name("unitylink")


def blocks(text: str, language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```", text, re.M | re.S)


def run(*command: str | Path, cwd: Path) -> str:
    result = subprocess.run([*command], cwd=cwd, capture_output=True, text=True, timeout=60, check=False)
    assert result.returncode == 0, f"{command}: {result.stdout}\n{result.stderr}"
    return result.stdout


def test_the_readme_script(tmp_path: Path) -> None:
    shutil.copytree(ROOT / "examples" / "scara", tmp_path / "examples" / "scara")
    run(UNITYLINK, "generate", "examples/scara/scara.ul", "--out", ".", cwd=tmp_path)
    (script,) = blocks(README, "python")
    (tmp_path / "move.py").write_text(script)
    output = run(sys.executable, "-W", "error", "move.py", cwd=tmp_path)
    assert "joint 1 passes 300" in output
    assert "'j1.cpos': 300" in output or "j1.cpos=300" in output


def test_the_spec_shown_is_the_one_shipped() -> None:
    shown = next(block for block in blocks(README, "ul") if block.startswith("public scara"))
    shipped = (ROOT / "examples" / "scara" / "scara.ul").read_text(encoding="utf-8")
    ours, theirs = compile_text(shown, "scara.ul").spec, compile_text(shipped, "scara.ul").spec
    assert ours is not None and theirs is not None
    assert ours.hash == theirs.hash


def test_the_start_page(tmp_path: Path) -> None:
    run(UNITYLINK, "new", "arm", cwd=tmp_path)
    shown = compile_text(
        next(block for block in blocks(START, "ul") if block.startswith("public arm")), "arm.ul"
    )
    made = compile_text((tmp_path / "arm" / "arm.ul").read_bytes(), "arm.ul")
    assert shown.spec is not None and made.spec is not None
    assert shown.spec.hash == made.spec.hash  # the page shows the file that `new` writes
    script, plant = blocks(START, "python")
    (tmp_path / "arm" / "try.py").write_text(script)
    assert "x.position" in run(sys.executable, "-W", "error", "try.py", cwd=tmp_path / "arm")
    (tmp_path / "arm" / "motor.py").write_text(plant)
    mover = script.replace("sim:arm.ul", "sim:arm.ul?plant=motor.py").replace(
        "import unitylink", "import time, unitylink"
    )
    first, _ = mover.split("    robot.target")
    (tmp_path / "arm" / "move.py").write_text(
        first
        + "    robot.x.speed_limit.write(20000)\n    robot.target.write([300, -100])\n"
        + "    while robot.x.position.read() != 300:\n        time.sleep(0.01)\n"
        + "    print(robot.x.position.read(), robot.y.position.read())\n"
    )
    assert run(sys.executable, "-W", "error", "move.py", cwd=tmp_path / "arm") == "300 0\n"


def test_a_new_project_runs(tmp_path: Path) -> None:
    run(UNITYLINK, "new", "arm", cwd=tmp_path)
    assert run(sys.executable, "-W", "error", "run.py", cwd=tmp_path / "arm")


def test_the_readme_s_first_commands_can_be_pasted_as_they_stand(tmp_path: Path) -> None:
    """All in one go.

    No command blocks the others, because one that serves until Ctrl-C stands in a block of its own.
    """
    shutil.copytree(ROOT / "examples" / "scara", tmp_path / "examples" / "scara")
    block = next(one for one in blocks(README, "sh") if "unitylink new" in one)
    (tmp_path / "pasted.sh").write_text(block)
    path = f"{UNITYLINK.parent}:/usr/bin:/bin"
    output = run("env", f"PATH={path}", "bash", "-e", "pasted.sh", cwd=tmp_path)
    assert "no mistakes" in output and "j4.cpos" in output
    served = [one for one in blocks(README, "sh") if "unitylink simulate" in one]
    assert all(one.count("\n") == 1 for one in served)
