# SPDX-License-Identifier: BSD-3-Clause
"""The lines of Python on the page of a component run with its example, as a reader would type them."""

from __future__ import annotations

import math
import re
import sys
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import pytest

from unitylink import connect
from unitylink.generate import SpecPlan, planned_files
from unitylink.spec import Spec, load
from unitylink.spec.text.imports import component_names

COMPONENTS = Path(__file__).resolve().parents[2] / "components"
_BLOCK = re.compile(r"```python\n(.*?)```", re.S)
# what a page leaves to the program around its lines
_AROUND = {
    "drive": lambda *speeds: None,
    "stop": lambda: None,
    "parser": SimpleNamespace(feed=lambda byte: None),
    "pi": math.pi,
}


def module_of(spec: Spec, name: str, monkeypatch: pytest.MonkeyPatch) -> Any:
    """Return the Python that is generated for `spec`."""
    module = ModuleType(name)
    module.__file__ = str(COMPONENTS / f"{name}.py")  # beside it there is no spec with which it is compared
    monkeypatch.setitem(sys.modules, name, module)
    (text,) = planned_files(SpecPlan(spec), ["python"]).values()
    exec(compile(text, f"{name}.py", "exec"), module.__dict__)
    return module


def test_the_lines_of_each_page_run_with_its_example(monkeypatch: pytest.MonkeyPatch) -> None:
    ran = set()
    for component in component_names():
        page = (COMPONENTS / component / "README.md").read_text(encoding="utf-8")
        blocks = [block for block in _BLOCK.findall(page) if "= ..." not in block]
        if not blocks:
            continue
        example = COMPONENTS / component / "example.ul"
        spec = load(example)
        root = spec.root().name
        module = module_of(spec, f"page_of_{component}", monkeypatch)
        with connect(f"sim:{example}") as link:
            names = {**_AROUND, root: getattr(module, root.title())(link), "board": link.board}
            for block in blocks:
                exec(compile(block, f"components/{component}/README.md", "exec"), names)
        ran.add(component)
    assert {"pid", "stepgen", "i2c_device", "servo_bus"} <= ran
