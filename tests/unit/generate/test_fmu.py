# SPDX-License-Identifier: BSD-3-Clause
"""The descriptions of units of FMI 3.0 and 2.0, read by FMPy."""

from __future__ import annotations

import shutil
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
WIDE = """
public arm() {
   @small = 0x0: u31 WRITE(); @word = 0x1: i32 WRITE(); @wide = 0x2: u32 WRITE(); @long = 0x3: i33 WRITE();
   @far = 0x5: u64 WRITE(); @seen = 0x9: u32 READ(MAX=100); @angle = 0x7: i16 READ(UNIT="rad", SCALE=0.5);
   @on = 0x8: bool WRITE();
}
"""


def described(files: dict[str, str], folder: Path, version: str = "fmi3") -> dict[str, Any]:
    """Return what FMPy reads, by the names of the units. It compares each with the standard's schema."""
    write_files(files, folder)
    found = {}
    for one in (folder / "fmu").iterdir():
        shutil.copy(one / f"{version}.xml", one / "modelDescription.xml")
        found[one.name] = read_model_description(str(one))
    return found


@pytest.mark.parametrize("source", SPECS, ids=lambda path: path.stem)
def test_every_example_is_a_valid_unit(source: Path, tmp_path: Path) -> None:
    spec = load(source)
    files = generate(spec, "fmu")
    for version, told in (("fmi3", "3.0"), ("fmi2", "2.0")):
        units = described(files, tmp_path, version)
        assert len(units) == len(spec.roots)
        for unit in units.values():
            assert unit.fmiVersion == told
            assert (unit.guid if version == "fmi2" else unit.instantiationToken).startswith(spec.hash)
            outputs = [one for one in unit.modelVariables if one.causality == "output"]
            assert [one.variable for one in unit.outputs] == outputs


def test_both_versions_have_the_same_variables_and_only_wide_ones_are_real(tmp_path: Path) -> None:
    spec = compile_text(WIDE, "arm.ul").spec
    assert spec is not None
    files = generate(spec, "fmu")
    new, old = (described(files, tmp_path, one)["arm"].modelVariables for one in ("fmi3", "fmi2"))
    same = ("name", "valueReference", "causality", "variability", "unit", "min", "max", "start")
    (far,) = (one for one in new if one.name == "far")  # FMPy reads no limits of a UInt64
    assert far.type == "UInt64" and 'min="0" max="18446744073709551615"' in files["fmu/arm/fmi3.xml"]
    far.min, far.max = "0", str((1 << 64) - 1)
    assert [[getattr(one, name) for name in same] for one in new] == [
        [getattr(one, name) for name in same] for one in old
    ]
    types = {one.name: one.type for one in old}
    assert {types[name] for name in ("small", "word")} == {"Integer"}
    assert {types[name] for name in ("wide", "long", "far", "angle", "seen")} == {"Real"}, (
        "a device may hold more than the limit of `seen`"
    )


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
    assert other.modelVariables[4].start == "0.25"
