# SPDX-License-Identifier: BSD-3-Clause
"""What the build script of a generated design does with GHDL and yosys."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from unitylink.errors import ToolError
from unitylink.gateware.build import build, main
from unitylink.generate import write
from unitylink.spec import compile_text

ENTITY = """
library ieee;
  use ieee.std_logic_1164.all;
entity blinker is
  port (clock : in std_ulogic; reset : in std_ulogic; lamp : out std_ulogic);
end entity;
architecture rtl of blinker is
  signal on_now : std_ulogic;
begin
  process (clock) is
  begin
    if rising_edge(clock) then
      assert reset /= 'U' report "no reset" severity failure; -- for a simulator only
      on_now <= not on_now and not reset;
    end if;
  end process;
  lamp <= on_now;
end architecture;
"""


@pytest.fixture
def blinker(tmp_path: Path) -> Path:
    file = tmp_path / "blinker.vhd"
    file.write_text(ENTITY, encoding="ascii")
    return file


def test_from_vhdl_to_cells(blinker: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert build("check", "blinker", tmp_path / "build", [blinker]) == []
    assert not (tmp_path / "build").exists()
    verilog, made = build("ice40", "blinker", tmp_path / "build", [blinker])
    assert "$fatal" not in verilog.read_text(encoding="utf-8")
    cells = json.loads(made.read_text(encoding="utf-8"))["modules"]["blinker"]["cells"]
    assert {cell["type"] for cell in cells.values()} == {"SB_LUT4", "SB_DFF"}
    assert "Number of cells" in capsys.readouterr().out


def test_what_is_wrong_is_told(blinker: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(ToolError, match="'ice40; rm' is neither check, test, verilog nor a family"):
        build("ice40; rm", "blinker", tmp_path, [blinker])
    with pytest.raises(ToolError, match=r"there is no such VHDL file"):
        build("check", "blinker", tmp_path, [tmp_path / "absent.vhd"])
    assert main(["check", "absent", str(tmp_path), str(blinker)]) == 1
    assert "absent" in capsys.readouterr().err
    assert main(["check"]) == 2
    assert main(["nonsense", "blinker", str(tmp_path), str(blinker)]) == 1
    assert "yosys synth_nonsense of blinker failed" in capsys.readouterr().err


def test_the_generated_script(blinker: Path, tmp_path: Path) -> None:
    result = compile_text("public lamp() { @on = 0x10: WRITE(); }", "lamp.ul")
    assert result.spec is not None
    write(result.spec, tmp_path, "vhdl")
    script = tmp_path / "vhdl" / "lamp_build.sh"

    def run(*arguments: str) -> str:
        done = subprocess.run(
            ["sh", str(script), *arguments],
            cwd=tmp_path,
            env=os.environ | {"PYTHON": sys.executable},
            capture_output=True,
            text=True,
            timeout=60,
            check=False,
        )
        assert done.returncode == 0, done.stderr
        return done.stdout

    assert run("check") == "lamp_top: no error\n"
    assert run("check", "blinker", str(blinker)) == "blinker: no error\n"
    files = {Path(file): library for library, file in map(str.split, run("files").splitlines())}
    assert all(file.is_file() for file in files)
    libraries = {file.name: library for file, library in files.items()}
    assert libraries["core.vhd"] == "unitylink" and libraries["lamp_top.vhd"] == "work"
