# SPDX-License-Identifier: BSD-3-Clause
"""Crates of Rust: equal to the golden files, in step with the C ABI. tests/conformance compiles them."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from unitylink.generate import MARK, generate
from unitylink.spec import compile_text, load

ROOT = Path(__file__).resolve().parents[3]
GOLDEN = ROOT / "tests" / "golden" / "rust"
RUNTIME = ROOT / "src" / "unitylink" / "generate" / "rust" / "runtime"


@pytest.mark.parametrize("path", ["tests/unit/generate/typed.ul", "examples/scara/scara.ul"])
def test_golden(path: str) -> None:
    spec = load(ROOT / path)
    files = generate(spec, "rust")
    name = Path(path).stem
    text, golden = files[f"rust/{name}/src/lib.rs"], GOLDEN / f"{name}.rs"
    if os.environ.get("UPDATE_GOLDEN"):
        golden.write_text(text, encoding="utf-8")
    assert text == golden.read_text(encoding="utf-8")
    assert files == generate(spec, "rust"), "the same spec gives the same text"
    assert all(MARK in text for text in files.values())


def test_the_crates_below_are_the_same_for_each_spec() -> None:
    one, other = (
        {name: text for name, text in generate(load(ROOT / path), "rust").items() if "/unitylink" in name}
        for path in ("examples/scara/scara.ul", "examples/hello_led/hello_led.ul")
    )
    assert one == other and len(one) == 3 + 1 + len(list(RUNTIME.glob("*.rs"))) - 2


def test_the_declarations_are_those_of_the_header() -> None:
    tool = ROOT / "tools" / "rust_sys.py"
    assert subprocess.run([sys.executable, tool, "--check"], check=False).returncode == 0
    declared = re.findall(r"pub fn (\w+)\(", (RUNTIME / "sys.rs").read_text("utf-8"))
    header = (ROOT / "native" / "include" / "unitylink.h").read_text("utf-8")
    assert declared == re.findall(r"^UL_API .*?(\w+)\(", header, re.M) and "ul_exchange" in declared


def test_no_unsafe_but_in_the_calls_of_the_c_abi() -> None:
    found = {
        path.name
        for path in RUNTIME.glob("*.rs")
        if re.search(r"\bunsafe \{|unsafe impl", path.read_text("utf-8"))
    }
    assert found == {"error.rs", "link.rs"}
    assert "#![forbid(unsafe_code)]" in (GOLDEN / "scara.rs").read_text("utf-8")


def test_names_and_first_values() -> None:
    text = "enum kind: u2 { self = 1; type = 2; } public fn() {"
    text += " @match = 0x0: kind WRITE(); @loop = 0x1: u8 WRITE(INITIAL=7); }"
    spec = compile_text(text, "crate.ul").spec
    assert spec is not None
    made = generate(spec, "rust")["rust/crate_2/src/lib.rs"]
    assert "    self_2 = 1,\n    type_2 = 2,\n" in made
    assert "pub match_2: ::unitylink::WriteValue<Kind>," in made and "pub loop_2: u8," in made
    assert "Default for FnOutputs" not in made, "a closed enumeration without a 0 has no first value"
