# SPDX-License-Identifier: BSD-3-Clause
"""ROS packages as text: they have our mark, are the same each time, and behave as a bridge would."""

from __future__ import annotations

import ast
from pathlib import Path
from xml.etree import ElementTree

import pytest

from unitylink.errors import BindingError
from unitylink.generate import MARK, generate, stale, write
from unitylink.ros import Interface, plan_interface
from unitylink.spec import compile_text, load
from unitylink.spec.model import Spec

ROOT = Path(__file__).resolve().parents[3]
SPECS = [
    ROOT / "examples" / "scara" / "scara.ul",
    ROOT / "examples" / "servo" / "servo.ul",
    ROOT / "examples" / "pa10" / "pa10_pair.ul",
    ROOT / "tests" / "ros" / "rig.ul",
]
ARTEFACTS = ["ros1", "ros2"]


@pytest.fixture(params=SPECS, ids=lambda path: path.stem)
def spec(request: pytest.FixtureRequest) -> Spec:
    return load(request.param)


@pytest.mark.parametrize("artefact", ARTEFACTS)
def test_files_are_marked_parse_and_stay_the_same(spec: Spec, artefact: str, tmp_path: Path) -> None:
    files = generate(spec, artefact)
    assert files == generate(spec, artefact)
    for name, text in files.items():
        assert MARK in text, f"{name} would not be overwritten"
        if name.endswith(".py"):
            ast.parse(text)
        if name.endswith((".xml", ".launch")):
            ElementTree.fromstring(text)
    write(spec, tmp_path, artefact)
    assert not stale(spec, tmp_path, artefact)


@pytest.mark.parametrize("artefact", ARTEFACTS)
def test_the_interface_of_a_package_is_that_of_the_spec(spec: Spec, artefact: str) -> None:
    """The literals are read back. So the generated node does what the mapping says."""
    files = generate(spec, artefact)
    for root in spec.roots:
        planned = plan_interface(spec, root.name)
        (text,) = [
            t
            for name, t in files.items()
            if name.endswith("/interface.py") and f"/{planned.package}/" in name
        ]
        names: dict[str, Interface] = {}
        exec(compile(text, "interface.py", "exec"), names)
        assert names["INTERFACE"] == planned


def test_names_that_become_one_are_refused() -> None:
    text = "public aB() { @x = 0x0: READ(); } public a_b() { @x = 0x0: READ(); }"
    spec = compile_text(text, "robot.ul").spec
    assert spec is not None
    with pytest.raises(BindingError, match="two public constructors give the package 'a_b_unitylink'"):
        generate(spec, "ros1")
