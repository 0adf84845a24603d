# SPDX-License-Identifier: BSD-3-Clause
"""Units of FMI 3.0 and 2.0: FMPy checks and simulates what CMake makes, as docs/fmu.md says."""

from __future__ import annotations

import math
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import fmpy
import pytest
from conformance.boards import Still, board_of, output
from fmpy.validation import validate_fmu

from unitylink.generate import generate, write_files
from unitylink.simulate import Board
from unitylink.spec import load

ROOT = Path(__file__).resolve().parents[2]
CMAKE = Path(sys.executable).with_name("cmake")
HEADERS = Path(fmpy.__file__).parent / "c-code"  # the standard's own: all functions must be as they say
STEPS = ROOT / "tests" / "conformance" / "objects" / "steps.ul"
PLACES = {path: element.addresses for path, element in load(STEPS).walk()}
STRICT = f"-DUNITYLINK_FMI_HEADERS -I{HEADERS} -Wall -Wextra -Werror"


def units(source: Path, library: Path, folder: Path) -> dict[str, Path]:
    """Generate the units of a spec and build them, with the library as it is installed."""
    spec = load(source)
    write_files(generate(spec, "fmu"), folder)
    prefix, made = folder / "prefix", folder / "made"
    for line in (
        ["--install", library, "--prefix", prefix],
        [
            "-S",
            folder / "fmu" / spec.roots[0].name,
            "-B",
            made,
            f"-DCMAKE_PREFIX_PATH={prefix}",
            f"-DCMAKE_C_FLAGS={STRICT}",
        ],
        ["--build", made],
    ):
        done = subprocess.run([CMAKE, *line], capture_output=True, text=True, check=False, timeout=600)
        assert done.returncode == 0, done.stdout + done.stderr
    name = spec.roots[0].name
    return {"3.0": made / f"{name}.fmu", "2.0": made / f"{name}_fmi2.fmu"}


def test_the_page_runs(library: Path, tmp_path: Path) -> None:
    page = (ROOT / "docs" / "fmu.md").read_text("utf-8")
    (program,) = re.findall(r"^```python.*?\n(.*?)^```", page, re.M | re.S)
    source = ROOT / "examples" / "scara" / "scara.ul"
    made = units(source, library, tmp_path)["3.0"]
    with board_of("fmu.md") as board:
        program = program.replace("tcp://127.0.0.1:5555", board.url).replace('"scara.fmu"', repr(str(made)))
        (tmp_path / "simulate.py").write_text(program, encoding="utf-8")
        told = output(sys.executable, tmp_path / "simulate.py")
        assert told[-1] == "joint 1 is at 300", told


@pytest.fixture(scope="module")
def steps(library: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    return units(STEPS, library, tmp_path_factory.mktemp("steps"))


@pytest.mark.parametrize("version", ["3.0", "2.0"])
def test_each_kind_of_value_and_what_is_refused(version: str, steps: dict[str, Path]) -> None:
    made = steps[version]
    assert fmpy.read_model_description(str(made)).fmiVersion == version and validate_fmu(str(made)) == []
    said: list[str] = []

    def simulated(**start: Any) -> Any:
        said.clear()
        return fmpy.simulate_fmu(
            str(made),
            stop_time=0.2,
            output_interval=0.1,
            start_values={"link.paced": False} | {name.replace("__", "."): start[name] for name in start},
            logger=lambda *told: said.append(told[-1].decode()),
        )

    with Board(load(STEPS), endpoint="tcp", plant=Still()) as board:
        result = simulated(link__url=board.url)
        assert result.dtype.names == ("time", "j[0].pos", "j[1].pos", "faults", "limit") and not said
        assert list(result[-1]) == [pytest.approx(0.2), -0.256, 1.234, 5, 42]
        assert board.registers[0x31] == 0, "what is not set is not written"
        given = {"lamps[1]": True, "net__a": -9, "j[0]__mode": 3, "count": 0xFFFFFFFE, "big": 1 << 40}
        simulated(link__url=board.url, small=-7, gain=2.5, **given)
        assert not said
        written = {0x31: 0xF9, 0x34: 0x40200000, 0x3A: 0, 0x3B: 1, 0x12: 3, 0x100: 0xFFFFFFF7}
        written |= dict.fromkeys(PLACES["count"], 0xFFFFFFFE) | dict(
            zip(PLACES["big"], (0, 1 << 8), strict=True)
        )
        assert {address: board.registers[address] for address in written} == written
        with pytest.raises(fmpy.fmi1.FMICallException):
            simulated(link__url=board.url, small=101)
        assert said == ["small: 101 is not in -100 to 100; nothing was sent"]
        if version == "2.0":  # there it is a Real
            with pytest.raises(fmpy.fmi1.FMICallException):
                simulated(link__url=board.url, count=0.5)
            assert said == ["this variable takes whole numbers of 64 bits"]
        simulated(link__url=board.url, big=(1 << 64) - (1 << 40))
        assert [board.registers[address] for address in PLACES["big"]] == [0, 0xFFFFFF00]
    with pytest.raises(fmpy.fmi1.FMICallException):
        simulated(link__url="tcp://127.0.0.1:1")
    assert said[0].startswith("tcp://127.0.0.1:1: nothing listens there")


class Unit:
    """A unit as an importer has it, call by call."""

    def __init__(self, made: Path, folder: Path, told: list[str]) -> None:
        self.told = told  # of all units: for FMI 2.0, FMPy has one log
        self.described = fmpy.read_model_description(str(made))
        self.variables = {one.name: one for one in self.described.modelVariables}
        self.inner = fmpy.instantiate_fmu(
            fmpy.extract(str(made), str(folder)),
            self.described,
            "CoSimulation",
            logger=lambda *said: told.append(said[-1].decode()),
        )

    def get(self, name: str) -> Any:
        variable = self.variables[name]
        return getattr(self.inner, f"get{variable.type}")([variable.valueReference])[0]

    def set(self, name: str, value: Any) -> None:
        variable = self.variables[name]
        getattr(self.inner, f"set{variable.type}")([variable.valueReference], [value])

    def start(self, url: str, time_s: float = 0.0) -> None:
        self.set("link.paced", False)
        self.set("link.url", url)
        if self.described.fmiVersion == "2.0":
            self.inner.setupExperiment(startTime=time_s)
            self.inner.enterInitializationMode()
        else:
            self.inner.enterInitializationMode(startTime=time_s)

    def refused(self, why: str, function: Callable[..., Any], *given: Any) -> None:
        self.told.clear()
        with pytest.raises(fmpy.fmi1.FMICallException):
            function(*given)
        assert why in self.told[-1]


@pytest.mark.parametrize("version", ["3.0", "2.0"])
def test_the_life_of_a_unit(version: str, steps: dict[str, Path], tmp_path: Path) -> None:
    told: list[str] = []
    unit, other = (Unit(steps[version], tmp_path / name, told) for name in ("one", "two"))

    step = unit.inner.doStep

    def as_described() -> bool:
        given = [one for one in unit.variables.values() if one.causality in ("input", "parameter")]
        url = unit.get("link.url")
        numbers = {one.name: float(unit.get(one.name)) for one in given if one.type != "String"}
        starts = {one.name: {"true": "1", "false": "0"}.get(one.start, one.start) for one in given}
        assert starts.pop("link.url") == (url if isinstance(url, str) else url.decode())
        return numbers == {name: float(text) for name, text in starts.items()}

    assert as_described()
    unit.refused("a step before the initialization", step, 0.0, 0.1)
    unit.refused("the initialization has not begun", unit.inner.exitInitializationMode)
    with (
        Board(load(STEPS), endpoint="tcp", plant=Still()) as board,
        Board(load(STEPS), endpoint="tcp", plant=Still()) as second,
    ):
        unit.refused("the start is no number", unit.start, board.url, math.nan)
        unit.start(board.url, 1.0)
        unit.refused("the link is open", unit.set, "link.url", board.url)
        unit.refused("it is initialized already", unit.inner.enterInitializationMode)
        unit.refused("a step before the initialization", step, 1.0, 0.1)
        unit.inner.exitInitializationMode()
        for size_s in (0.0, -0.1, math.nan, math.inf):
            unit.refused("a step takes more than 0 s", step, 1.0, size_s)
        unit.set("small", -7)
        step(1.0, 0.1)
        unit.refused("this step has been made", step, 1.0, 0.1)
        assert board.registers[0x31] == 0xF9 and unit.get("time") == pytest.approx(1.1)
        other.start(second.url)
        other.inner.exitInitializationMode()
        unit.inner.terminate()
        assert unit.get("limit") == 42
        unit.refused("after the end", step, 1.1, 0.1)
        unit.set("small", 9)
        unit.inner.reset()
        assert as_described()
        board.registers[0x31] = 3
        unit.start(board.url)
        unit.inner.exitInitializationMode()
        step(0.0, 0.1)
        other.inner.doStep(0.0, 0.1)  # two instances know nothing of each other
        assert board.registers[0x31] == 3, "what was set before the reset is forgotten"
    unit.refused("the link is closed", step, 0.1, 0.1)
    with Board(load(STEPS), endpoint="tcp", plant=Still()) as board:
        unit.inner.reset()
        unit.start(board.url)
        unit.inner.exitInitializationMode()
        step(0.0, 0.1)
    for one in (unit, other):
        one.inner.freeInstance()
