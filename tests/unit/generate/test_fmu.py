# SPDX-License-Identifier: BSD-3-Clause
"""The description of a unit of FMI 3.0, read by FMPy."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from fmpy import read_model_description

from unitylink.generate import generate, write_files
from unitylink.spec import compile_text, load

ROOT = Path(__file__).resolve().parents[3]
SPECS = [*sorted((ROOT / "examples").glob("*/*.ul")), ROOT / "tests/unit/generate/typed.ul"]
SPEC = """
enum mode: u2 { run = 1; stop = 2; }
public arm(one, two) {
   x: axis(one, 0x10);
   y: axis(two, 0x20);
}
axis(c, at: int) {
   MEMORY(CTRL=c, COMM=c);
   @time = at: i16 READ(UNIT="rad", SCALE=0.5, ID="the \\"angle\\" <now>");
   @gain = at+1: u8 READWRITE(MIN=3, MAX=9);
   @on = at+2: bool WRITE(INITIAL=true);
   @mode = at+3: mode WRITE();
   @start = at+4: u4 PULSE();
}
public other() { @time = 0x1: u64 READ(); @limit = 0x3: f32 WRITE(MIN=-1, MAX=1, INITIAL=0.25); }
"""


def described(files: dict[str, str], folder: Path) -> dict[str, Any]:
    """Return what FMPy reads, by the names of the units. It compares each with the standard's schema."""
    write_files(files, folder)
    return {one.name: read_model_description(str(one)) for one in (folder / "fmu").iterdir()}


@pytest.mark.parametrize("source", SPECS, ids=lambda path: path.stem)
def test_every_example_is_a_valid_unit(source: Path, tmp_path: Path) -> None:
    spec = load(source)
    units = described(generate(spec, "fmu"), tmp_path)
    assert len(units) == len(spec.roots)
    for unit in units.values():
        assert unit.fmiVersion == "3.0" and unit.instantiationToken.startswith(spec.hash)
        outputs = [one for one in unit.modelVariables if one.causality == "output"]
        assert [one.variable for one in unit.outputs] == outputs


def test_values_become_variables(tmp_path: Path) -> None:
    spec = compile_text(SPEC, "arm.ul").spec
    assert spec is not None
    units = described(generate(spec, "fmu"), tmp_path)
    arm = {one.name: one for one in units["arm"].modelVariables}
    assert list(arm) == [
        *("time", "link.paced", "link.url", "link.two.url"),
        *(f"{axis}.{name}" for axis in "xy" for name in ("time", "gain", "on", "mode")),
    ]
    assert (arm["link.url"].start, arm["link.two.url"].start) == ("tcp://127.0.0.1:5555", "")
    angle = arm["x.time"]
    assert (angle.type, angle.causality, angle.unit) == ("Float64", "output", "rad")
    assert angle.description == 'the "angle" <now>' and (angle.min, angle.max) == ("-16384.0", "16383.5")
    starts = {name: (arm[f"y.{name}"].type, arm[f"y.{name}"].start) for name in ("gain", "on", "mode")}
    assert starts == {"gain": ("Int64", "3"), "on": ("Boolean", "true"), "mode": ("Int64", "1")}
    references = [one.valueReference for one in units["arm"].modelVariables]
    assert len(set(references)) == len(references)


def test_a_value_may_have_the_name_of_a_variable_of_the_unit(tmp_path: Path) -> None:
    spec = compile_text(SPEC, "arm.ul").spec
    assert spec is not None
    (other,) = (unit for name, unit in described(generate(spec, "fmu"), tmp_path).items() if name == "other")
    assert [one.name for one in other.modelVariables] == ["time_", "link.paced", "link.url", "time", "limit"]
    assert other.modelVariables[3].max == str((1 << 63) - 1) and other.modelVariables[4].start == "0.25"
