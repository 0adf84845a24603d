# SPDX-License-Identifier: BSD-3-Clause
"""No text of a spec acts as code in what is generated: a hostile spec and its benign twin give the same
structure.
"""

from __future__ import annotations

import base64
import builtins
import os
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest

sys.path.insert(0, str(Path(__file__).parent))

from hostile import CANARY, NAMES, PAYLOADS, PLACES, SHOWN, check, files_of, mixed, placed, spec_text
from structure import Broken

from unitylink.errors import BindingError
from unitylink.generate import generate
from unitylink.generate.quoting import Cpp, Matlab, Message, Python, Rust, Vhdl, Xacro, Yaml
from unitylink.spec import compile_text

TURNS = range(0, len(PAYLOADS), 24)  # a part of the long form, which brings every payload to every place


def test_there_are_as_many_as_the_page_says() -> None:
    page = (Path(__file__).resolve().parents[4] / "SECURITY.md").read_text("utf-8")
    assert f"each of {len(PAYLOADS)} hostile texts in each of {len(PLACES)} places" in page
    assert {mixed(turn).get("d_link") for turn in range(len(PAYLOADS))} >= {
        placed("d_link", p) for p in PAYLOADS
    }


def everywhere(text: str) -> dict[str, str]:
    return {place: said for place in PLACES if (said := placed(place, text)) is not None}


@pytest.mark.parametrize("turn", TURNS)
def test_hostile_specs_have_the_structure_of_benign_ones(turn: int) -> None:
    check(mixed(turn))


@pytest.mark.parametrize(
    ("language", "function", "artefact", "payload"),
    [
        (Python, "text", "python", '"'),
        (Python, "said", "python", '"'),
        (Cpp, "text", "cpp", '"'),
        (Matlab, "text", "matlab", '"'),
        (Matlab, "remark", "matlab", "\n"),
        (Rust, "text", "rust", '"'),
        (Rust, "remark", "rust", "\n"),
        (Yaml, "text", "ros2", '"'),
        (Xacro, "text", "ros2", '"'),
        (Message, "remark", "ros2", "*/"),
        (Vhdl, "remark", "vhdl", "\n"),
    ],
)
def test_one_place_without_quotes_is_seen(
    language: type[Python], function: str, artefact: str, payload: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The proof that the comparison finds something: each quoting function, when it quotes nothing, gives
    another structure.
    """
    check(everywhere(payload), [artefact])
    monkeypatch.setattr(language, function, classmethod(lambda cls, text: cls(text)))
    with pytest.raises(Broken):
        check(everywhere(payload), [artefact])


@pytest.mark.parametrize(
    "text", ['"parked"', '>>> """\nx', '"""', "x\\", f"coding=utf-7 +AAo-builtins.{CANARY}+AD0-1"]
)
def test_what_python_imports_runs_no_text(text: str, monkeypatch: pytest.MonkeyPatch) -> None:
    files = files_of(everywhere(text), ("python", "ros2"))
    ros = "ros2:ros2/arm_unitylink/arm_unitylink_node/interface.py"
    for name in ("python:lab.py", ros):
        module = ModuleType("hostile_module")
        module.__file__ = "/nowhere/lab.py"
        monkeypatch.setitem(sys.modules, module.__name__, module)
        exec(compile(files[name].encode(), name, "exec"), module.__dict__)
    assert not hasattr(builtins, CANARY)


def hidden_in_utf_7(text: str) -> str:
    return f"+{base64.b64encode(text.encode('utf-16-be')).decode().rstrip('=')}-"


def test_an_encoding_in_the_name_of_the_file_has_no_effect() -> None:
    """Python takes its encoding from a comment in the first two lines, and one names the spec's file."""
    ends, then, by, rest = (hidden_in_utf_7(text) for text in ('"};', ";", "=", ";a={#"))
    acts = f"{ends}import builtins{then}builtins.{CANARY}{by}1{rest}"
    text = f'public arm() {{ @x = 0x0: READ(ID="{acts}"); }}'
    spec = compile_text(text, "x coding=utf-7 .ul").spec
    assert spec is not None
    for file in generate(spec).values():
        exec(compile(file.encode(), "x.py", "exec"), {"__name__": "x", "__file__": "/nowhere/x.py"})
    assert not hasattr(builtins, CANARY)


def test_cpp_prints_what_was_said(tmp_path: Path) -> None:
    """It is compiled as an old C++, which has trigraphs and so can misread most in a text."""
    said = [payload for payload in PAYLOADS if "\0" not in payload]
    lines = "".join(f"  std::puts({Cpp.text(text)});  // {Cpp.remark(text)}\n" for text in said)
    (tmp_path / "said.cpp").write_text(f"#include <cstdio>\nint main() {{\n{lines}}}\n", encoding="utf-8")
    program = tmp_path / "said"
    compiler = [os.environ.get("CXX", "c++"), "-std=c++11", "-trigraphs", "-Werror", "-Wcomment"]
    subprocess.run([*compiler, "-o", str(program), str(tmp_path / "said.cpp")], check=True)
    told = subprocess.run([str(program)], capture_output=True, check=True).stdout
    assert told == "".join(f"{text}\n" for text in said).encode()


@pytest.mark.parametrize("text", ['"; x\\', "\n*/ --??/"])
def test_ghdl_reads_what_was_made(text: str, tmp_path: Path) -> None:
    package = files_of(everywhere(text), ["vhdl"])["vhdl:vhdl/lab_user_pkg.vhd"]
    (tmp_path / "lab_user_pkg.vhd").write_text(package, encoding="utf-8")
    subprocess.run(["ghdl", "-a", "--std=08", "lab_user_pkg.vhd"], cwd=tmp_path, check=True)


@pytest.mark.parametrize("place", [*NAMES, *SHOWN])
def test_a_text_that_is_not_a_name_is_refused(place: str) -> None:
    """The message has the place and a remedy. No part of it has a newline."""
    texts = {place: "a\nb.ul"}
    result = compile_text(spec_text(texts), texts.get("file", "arm.ul"))
    if place in NAMES:
        (error,) = [found for found in result.diagnostics if found.severity == "error"]
        assert error.code == "UL098" and "'a\\nb.ul' is no name of VHDL" in error.message
        return
    assert result.spec is not None
    with pytest.raises(BindingError, match=r"characters that cannot be printed"):
        generate(result.spec, "ros2")
