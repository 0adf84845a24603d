# SPDX-License-Identifier: BSD-3-Clause
"""VUnit reads the exported gateware and runs the bench of docs/export.md, in which the PC is a component."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

from unitylink.cli import main
from unitylink.generate import generate, write_files
from unitylink.spec import load

ROOT = Path(__file__).resolve().parents[2]
EXAMPLE = ROOT / "examples" / "hello_led"


def test_a_case_of_the_page_passes_and_one_with_a_wrong_expectation_fails(tmp_path: Path) -> None:
    page = (ROOT / "docs" / "export.md").read_text("utf-8")
    (bench,) = re.findall(r"^```vhdl\n(.*?)^```", page, re.M | re.S)
    (runner,) = re.findall(r'^```python title="run_vunit.py"\n(.*?)^```', page, re.M | re.S)
    assert 'check_equal(value, 2, "buttons")' in bench
    (tmp_path / "lamp_tb.vhd").write_text(bench.replace("value, 2,", "value, 3,"), encoding="utf-8")
    (tmp_path / "run_vunit.py").write_text(runner, encoding="utf-8")
    shutil.copy(EXAMPLE / "hello_led_board.vhd", tmp_path)
    assert main(["gateware", str(EXAMPLE / "hello_led.ul"), "--export", str(tmp_path / "hdl")]) == 0
    write_files(generate(load(EXAMPLE / "hello_led.ul"), "bench"), tmp_path)
    done = subprocess.run(
        [sys.executable, "run_vunit.py", "--no-color", "--minimal"],
        cwd=tmp_path,
        env=dict(os.environ) | {"VUNIT_SIMULATOR": "ghdl"},
        capture_output=True,
        text=True,
        check=False,
        timeout=300,
    )
    told = done.stdout + done.stderr
    assert "\npass bench.lamp_tb.the lamps are lit" in told, told[-3000:]
    assert "\nfail bench.lamp_tb.a button is seen" in told and done.returncode == 1
    assert re.search(r"buttons - Got \S+ \(2\)\. Expected \S*3\b", told), told[-3000:]
