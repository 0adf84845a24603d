# SPDX-License-Identifier: BSD-3-Clause
"""`@source` names the VHDL of a component of one's own, and never leads out of the spec's folder."""

from __future__ import annotations

from pathlib import Path

import pytest

from unitylink.spec import Diagnostic, compile_file

SPEC = """public a() {{ m: mover(); }}
@component("mover")
@source({source})
@pin("step", "out")
mover(): @base[1] {{ @target = base: WRITE(); }}
"""


def diagnostics(folder: Path, source: str) -> list[Diagnostic]:
    file = folder / "a.ul"
    file.write_text(SPEC.format(source=source), encoding="utf-8")
    return list(compile_file(file).diagnostics)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    inside = tmp_path / "inside"
    (inside / "parts").mkdir(parents=True)
    (inside / "mover.vhd").write_text("entity mover is port (step : out bit); end;", encoding="utf-8")
    (inside / "parts" / "ramp pkg.vhd").write_text("package ramp is end;", encoding="utf-8")
    (tmp_path / "secret.vhd").write_text("secret", encoding="utf-8")
    (inside / "link.vhd").symlink_to(tmp_path / "secret.vhd")
    (inside / "out").symlink_to(tmp_path)
    return inside


def test_the_files_are_found_beside_the_spec(folder: Path) -> None:
    assert diagnostics(folder, '"mover.vhd", "parts/ramp pkg.vhd"') == []
    spec = compile_file(folder / "a.ul").spec
    assert spec is not None
    component = spec.root().instances[0].component
    assert component is not None
    assert component.sources == (str(folder / "mover.vhd"), str(folder / "parts/ramp pkg.vhd"))


def test_the_files_of_an_import_are_beside_the_import(folder: Path) -> None:
    (folder / "parts" / "mover.ul").write_text(
        SPEC.format(source='"ramp pkg.vhd"').partition("\n")[2], encoding="utf-8"
    )
    (folder / "a.ul").write_text('import "parts/mover.ul"; public a() { m: mover(); }', encoding="utf-8")
    result = compile_file(folder / "a.ul")
    assert result.diagnostics == [] or list(result.diagnostics) == []
    assert result.spec is not None
    component = result.spec.root().instances[0].component
    assert component is not None and component.sources == (str(folder / "parts" / "ramp pkg.vhd"),)


@pytest.mark.parametrize(
    ("source", "code"),
    [
        ('"absent.vhd"', "UL042"),
        ('"../secret.vhd"', "UL044"),
        ('"parts/../../secret.vhd"', "UL044"),
        ('"/etc/passwd"', "UL044"),
        ('"/etc/passwd.vhd"', "UL044"),
        ('"link.vhd"', "UL044"),
        ('"out/secret.vhd"', "UL044"),
        ('"a.ul"', "UL044"),
        ('""', "UL044"),
        ('".vhd"', "UL044"),
        ('"-o.vhd"', "UL044"),
        ('"$(touch x).vhd"', "UL044"),
        ('"x\\ny.vhd"', "UL044"),
        ('"' + "x" * 240 + '.vhd"', "UL042"),
        ('"' + "x/" * 120 + 'y.vhd"', "UL042"),
        ("1", "UL098"),
        ("", "UL098"),
        ('"mover.vhd", 1', "UL098"),
    ],
)
def test_other_names_are_refused_at_their_place(folder: Path, source: str, code: str) -> None:
    (one,) = diagnostics(folder, source)
    assert one.code == code
    assert one.hint
    assert one.span.line == 3


@pytest.mark.parametrize(
    ("note", "name"),
    [
        ('@pin("stop", "out")', "stop"),
        ('@pin("then", "out")', "then"),
        ('@event("done")', "done"),
        ("@generic(widht=3)", "widht"),
        ('@wire("step_wire", "out", "target")', "step_wire"),
        ('@event("STEP")', None),
        ("@generic(width=3)", None),
    ],
)
def test_a_name_that_the_vhdl_lacks_is_refused_at_its_place(
    folder: Path, note: str, name: str | None
) -> None:
    text = """
    -- stop done
    package p is constant widht : string := "stop end"; end;
    entity Mover is
      generic (width : positive := 3; data_width : positive := 32; what : string := "end"); -- then
      port (step : out bit);
    end entity;
    architecture rtl of mover is signal done, step_wire : bit; begin end;
    """
    (folder / "mover.vhd").write_text(text, encoding="utf-8")
    found = diagnostics(folder, f'"mover.vhd") {note} @source("parts/ramp pkg.vhd"')
    if name is None:
        assert found == []
    else:
        (one,) = found
        assert (one.code, one.span.line) == ("UL098", 3)
        assert one.message == f"entity `mover` has no port or generic `{name}`"
