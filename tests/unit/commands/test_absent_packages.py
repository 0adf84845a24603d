# SPDX-License-Identifier: BSD-3-Clause
"""A package that only some commands need: the message names the command that installs it.

One extra has all of these.
"""

from __future__ import annotations

import importlib.util
import re
import shlex
import sys
from importlib.machinery import ModuleSpec
from pathlib import Path

import pytest

from unitylink.cli import main
from unitylink.optional import installation, requirement

ROOT = Path(__file__).resolve().parents[3]
EXTRAS = re.search(
    r"^\[project\.optional-dependencies\]\n(.*?)^\[",
    (ROOT / "pyproject.toml").read_text("utf-8"),
    re.M | re.S,
)

# name in an import -> (name of the package, a command that needs it)
NEEDED = {
    "mcap": ("mcap", ["record", "sim:arm.ul", "--out", "arm.mcap", "--count", "1"]),
    "pyarrow": ("pyarrow", ["record", "sim:arm.ul", "--lerobot", "data", "--count", "1"]),
    "matplotlib": ("matplotlib", ["plot", "arm.csv", "--out", "arm.png"]),
    "pygls": ("pygls", ["lsp"]),
    "systemrdl": ("systemrdl-compiler", ["import", "arm.rdl"]),
    "textual": ("textual", ["tui", "sim:arm.ul"]),
    "cyclonedds": ("cyclonedds", ["bridge", "ros2", "sim:arm.ul"]),
}


@pytest.fixture
def project(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "arm.ul").write_text("public arm() { @x = 0x1: READ(PUBLISH(100 Hz)); }")
    (tmp_path / "arm.csv").write_text("time_s,x\n1.0,2\n")
    (tmp_path / "arm.rdl").write_text("addrmap a { reg { field {} f; } r; };")
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize("package", NEEDED)
def test_an_absent_package_is_named_with_the_command_that_installs_it(
    package: str, project: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    name, command = NEEDED[package]
    for loaded in [one for one in sys.modules if one.partition(".")[0] == package]:
        monkeypatch.delitem(sys.modules, loaded)
    users = r"unitylink\.(commands\.(language_server|systemrdl)|recording\.(lerobot|parquet))"
    for loaded in [one for one in sys.modules if re.match(users, one)]:
        monkeypatch.delitem(sys.modules, loaded)
    monkeypatch.setitem(sys.modules, package, None)  # as if it were not installed
    found = importlib.util.find_spec

    def find_spec(module: str, of: str | None = None) -> ModuleSpec | None:
        return None if module == package else found(module, of)

    monkeypatch.setattr("unitylink.commands.plot.find_spec", find_spec)
    assert main(command) == 1
    error = capsys.readouterr().err
    assert (
        f"needs the package {name}: {installation(name)}; for all optional packages at once: make extras"
        in error
    )
    assert not list(project.glob("*.mcap")), "nothing was begun"


def test_the_command_is_for_this_very_python_with_the_versions_that_were_tried() -> None:
    python, module, *rest = shlex.split(installation("mcap"))
    assert (python, module, rest[:2]) == (sys.executable, "-m", ["pip", "install"])
    assert re.fullmatch(r"mcap[<>=,.\d]+", rest[2]) and requirement("mcap") == rest[2]


def test_one_extra_has_all_of_them_and_what_a_new_project_is_tested_with() -> None:
    assert EXTRAS is not None
    extras = {
        name: set(re.findall(r'"([^"]+)"', packages))
        for name, packages in re.findall(r"^([\w-]+) = \[(.*)\]$", EXTRAS[1], re.M)
    }
    everything = extras.pop("all")
    assert len(extras) > 5
    assert {one for one in everything if not one.startswith("pytest")} == set().union(*extras.values())
    assert any(one.startswith("pytest") for one in everything)


def test_the_demo_ends_by_naming_it() -> None:
    rule = (ROOT / "Makefile").read_text("utf-8").partition("\ndemo: ")[2].partition("\n\nextras:")[0]
    assert "make extras" in rule.splitlines()[-1]
