# SPDX-License-Identifier: BSD-3-Clause
"""Classes of MATLAB: equal to the golden files, in step with the headers of C.

tests/conformance runs them in Octave.
"""

from __future__ import annotations

import os
import re
from pathlib import Path

import pytest

from unitylink.generate import MARK, generate
from unitylink.generate.matlab.dialect import CONSTANTS
from unitylink.spec import compile_text, load

ROOT = Path(__file__).resolve().parents[3]
GOLDEN = ROOT / "tests" / "golden" / "matlab"
RUNTIME = ROOT / "src" / "unitylink" / "generate" / "matlab" / "runtime"


@pytest.mark.parametrize("path", ["tests/unit/generate/typed.ul", "examples/scara/scara.ul"])
def test_golden(path: str) -> None:
    spec = load(ROOT / path)
    files = generate(spec, "matlab")
    name = Path(path).stem
    own = sorted(file for file in files if file.startswith(f"matlab/+{name}/"))
    text = "".join(f"% ==== {file}\n{files[file]}" for file in own)
    golden = GOLDEN / f"{name}.m"
    if os.environ.get("UPDATE_GOLDEN"):
        golden.write_text(text, encoding="utf-8")
    assert text == golden.read_text(encoding="utf-8")
    assert files == generate(spec, "matlab"), "the same spec gives the same text"
    assert all(MARK in text for text in files.values())
    same = {file.removeprefix("matlab/") for file in files} - {file.removeprefix("matlab/") for file in own}
    assert same == {
        path.relative_to(RUNTIME).as_posix() for path in RUNTIME.rglob("*.*") if path.suffix != ".md"
    }


def test_the_constants_are_those_of_the_header() -> None:
    header = (ROOT / "native" / "include" / "unitylink" / "value.h").read_text("utf-8")
    (kinds,) = re.findall(r"enum \{ (UL_KIND_.*?) \};", header)
    assert kinds.split(", ") == [f"UL_KIND_{name}" for name in CONSTANTS["KIND"]]
    assert list(CONSTANTS["KIND"].values()) == list(range(len(CONSTANTS["KIND"])))
    flags = dict(re.findall(r"UL_VALUE_(\w+) = (\d+),? +/\*", header))
    assert {name: int(number) for name, number in flags.items()} == CONSTANTS["VALUE"]


def test_the_identifiers_are_the_statuses_of_the_abi() -> None:
    header = (ROOT / "native" / "include" / "unitylink.h").read_text("utf-8")
    statuses = re.findall(r"^  UL_([A-Z_]+) = (\d+)", header, re.M)[:19]
    facts = (RUNTIME / "mex" / "facts.h").read_text("utf-8")
    (names,) = re.findall(r"names\[\] = \{(.*?)\};", facts, re.S)
    assert re.findall(r'"(\w+)"', names) == [name.title().replace("_", "") for name, _ in statuses]
    assert [int(number) for _, number in statuses] == list(range(19))
    page = (ROOT / "docs" / "matlab.md").read_text("utf-8")
    assert all(f"`{name}`" in page for name in re.findall(r'"(\w+)"', names)[1:])


def test_names_first_values_and_long_numbers() -> None:
    text = "enum kind: u64 { end = 1; top = 18446744073709551615; } public fn() {"
    text += " @global = 0x0: kind WRITE(); @take_x = 0x2: WRITE(INITIAL=7); @x = 0x3: READCLEAR(); }"
    spec = compile_text(text, "case.ul").spec
    assert spec is not None
    made = generate(spec, "matlab")
    assert "    top = 0xFFFFFFFFFFFFFFFFu64  %" in made["matlab/+case_/Kind.m"]
    assert "initial = [0x1u64, 0x7u64, 0x0u64];" in made["matlab/+case_/tables.m"]
    own = made["matlab/+case_/Fn.m"]
    assert "    global_2  %" in own and "function value = take_x_2(self)" in own
