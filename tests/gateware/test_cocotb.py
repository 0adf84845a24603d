# SPDX-License-Identifier: BSD-3-Clause
"""The programs of docs/cocotb.md run: the link and its objects at the pins of a design in GHDL."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

from unitylink.generate import generate, write_files
from unitylink.spec import load

ROOT = Path(__file__).resolve().parents[2]
EXAMPLE = ROOT / "examples" / "hello_led"
MORE = """

import pytest
from unitylink.errors import UnityLinkError, UrlError


@cocotb.test()
async def mistakes_are_named(dut):
    with pytest.raises(UrlError, match="hello_led_board has no pin rx_line; say which the link has"):
        UnityLinkMaster(dut, SPEC)
    with pytest.raises(ValueError, match="invalid literal"):
        await UnityLinkMaster(dut, SPEC, rx="usb_rx", tx="usb_tx").run(int, "five")


@cocotb.test(expect_error=UnityLinkError)
async def a_byte_without_a_stop_bit_is_noticed(dut):
    async def fall():
        await Timer(50, "us")
        dut.reset.value = 0

    dut.reset.value = 1
    cocotb.start_soon(fall())
    async with UnityLinkMaster(dut, SPEC, rx="usb_rx", tx="reset", baud_hz=1_000_000):
        pass
"""


def test_the_page_runs(tmp_path: Path) -> None:
    page = (ROOT / "docs" / "cocotb.md").read_text("utf-8")
    bench, runner = re.findall(r'^```python title="\w+_cocotb.py"\n(.*?)^```', page, re.M | re.S)
    assert len(bench.splitlines()) <= 16
    shutil.copy(EXAMPLE / "hello_led_board.vhd", tmp_path)
    write_files(generate(load(EXAMPLE / "hello_led.ul"), "vhdl"), tmp_path)
    for name, text in {
        "lamp_cocotb.py": f"SPEC = {str(EXAMPLE / 'hello_led.ul')!r}\n{bench}{MORE}",
        "run_cocotb.py": runner,
    }.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    alone = {name: value for name, value in os.environ.items() if not name.startswith("PYTEST_")}
    done = subprocess.run(
        [sys.executable, "run_cocotb.py"],
        cwd=tmp_path,
        env=alone,
        capture_output=True,
        text=True,
        check=False,
        timeout=600,
    )
    assert done.returncode == 0, done.stdout[-4000:] + done.stderr[-4000:]
    (results,) = tmp_path.rglob("results.xml")
    cases = list(ElementTree.parse(results).iter("testcase"))
    bad = [case.get("name") for case in cases if {"failure", "error"} & {part.tag for part in case}]
    assert len(cases) == 3 and not bad, done.stdout[-4000:]
