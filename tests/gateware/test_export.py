# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink gateware --export`: FuseSoC builds from it, and every list has all files."""

from __future__ import annotations

import re
import runpy
import shlex
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from unitylink.cli import main
from unitylink.gateware import gateware_sources, simulation_sources

ROOT = Path(__file__).resolve().parents[2]
EXAMPLE = ROOT / "examples" / "hello_led" / "hello_led.ul"
TWO = """
link lab.two;
link left (DATA=32);
link left_arm (DATA=32);
public one(c) { MEMORY(CTRL=c, COMM=c, LINK=left); @a = 0x0: WRITE(); }
public one_arm(c) { MEMORY(CTRL=c, COMM=c, LINK=left_arm); @b = 0x0: READ(); }
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("export") / "hdl"
    assert main(["gateware", str(EXAMPLE), "--export", str(place)]) == 0
    return place


def test_the_page_runs(folder: Path) -> None:
    page = (ROOT / "docs" / "export.md").read_text("utf-8")
    (line,) = re.findall(r"^fusesoc .*", page, re.M)
    done = subprocess.run(
        [sys.executable, "-m", "fusesoc.main", *shlex.split(line)[1:]],
        cwd=folder.parent,
        capture_output=True,
        text=True,
        check=False,
        timeout=300,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert "hello_led_top --no-run" in done.stdout
    (library,) = (folder.parent / "build").rglob("unitylink-obj08.cf")
    assert "entity uart at" in library.read_text("utf-8"), "the gateware was compiled into its library"


def test_every_list_has_all_files(folder: Path) -> None:
    logic = {path.name for path in gateware_sources()}
    benches = {path.name for path in simulation_sources()}
    listed = [line.split() for line in (folder / "library.txt").read_text("utf-8").splitlines()]
    assert {library for library, _ in listed} == {"unitylink"}
    names = [name for _, name in listed]
    assert {Path(name).name for name in names} == logic | benches and len(names) == len(logic | benches)
    assert {str(path.relative_to(folder)) for path in (folder / "hdl").rglob("*.vhd")} == set(names)
    core = (folder / "unitylink.core").read_text("utf-8")
    assert re.findall(r"- (hdl/.*)", core) == names
    for name in ("vivado.tcl", "quartus.qip", "diamond.tcl", "radiant.tcl", "libero.tcl", "gowin.tcl"):
        found = re.findall(r"hdl/\S+\.vhd", (folder / name).read_text("utf-8"))
        assert found == [one for one in names if Path(one).name in logic], name


def test_vunit_is_given_all_files(folder: Path) -> None:
    class Recorder:
        def __init__(self) -> None:
            self.calls: list[Any] = []

        def add_library(self, name: str) -> Recorder:
            self.calls.append(name)
            return self

        def add_source_file(self, path: Path, *, vhdl_standard: str) -> None:
            assert path.is_file() and vhdl_standard == "2008"
            self.calls.append(path.name)

    vunit = Recorder()
    runpy.run_path(str(folder / "vunit_unitylink.py"))["add_unitylink"](vunit)
    assert vunit.calls[0] == "unitylink"
    assert len(vunit.calls) == 1 + len(gateware_sources()) + len(simulation_sources())


def test_each_board_of_a_spec_has_a_core(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "two.ul").write_text(TWO)
    assert main(["gateware", str(tmp_path / "two.ul"), "--export", str(tmp_path / "hdl")]) == 0
    cores = re.findall(r"wrote .*/(\w+)\.core", capsys.readouterr().out)
    assert len(cores) == 3 and "unitylink" in cores
    listed: list[str] = []
    for name in set(cores) - {"unitylink"}:
        core = (tmp_path / "hdl" / f"{name}.core").read_text("utf-8")
        files = re.findall(r"- (vhdl/.*)", core)
        assert f"vhdl/{name}_top.vhd" in files
        listed += files
    made = [f"vhdl/{path.name}" for path in (tmp_path / "hdl" / "vhdl").iterdir()]
    assert sorted(listed) == sorted(made), "each file is of one board"


def test_nothing_is_overwritten(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "mine.txt").write_text("mine")
    assert main(["gateware", "--export", str(tmp_path)]) == 1
    assert "exists and is not empty" in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["mine.txt"]


def test_without_a_folder_it_lists_what_is_installed(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["gateware"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == len(gateware_sources())
    assert all(Path(line.removeprefix("unitylink ")).is_file() for line in lines)
