# SPDX-License-Identifier: BSD-3-Clause
"""Every component has the files that components/README.md lists, and a page with the same headings."""

from __future__ import annotations

import re

import pytest
from unit.house.files import ROOT, files, text

from unitylink.spec import compile_file
from unitylink.spec.text.imports import component_names

NAMES = sorted({file.parts[1] for file in files() if file.parts[0] == "components" and len(file.parts) > 2})
PAGE = text("components/README.md")
HEADINGS = re.findall(r"^- `(## .+?)`", PAGE, re.M)
TEMPLATES = re.findall(r"^\| `(\S+)` \|(.*)\|$", PAGE, re.M)


def test_the_folders_are_the_library() -> None:
    assert component_names() == tuple(NAMES)
    assert len(NAMES) >= 3 and len(HEADINGS) >= 5 and len(TEMPLATES) >= 6


@pytest.mark.parametrize("name", NAMES)
def test_a_component_has_its_files(name: str) -> None:
    there = {str(file.relative_to(f"components/{name}")) for file in files() if file.parts[1:2] == (name,)}
    wanted = {file.replace("NAME", name) for file, what in TEMPLATES if "optional" not in what}
    assert wanted <= there, f"components/README.md says what they are: {sorted(wanted - there)}"
    known = [re.compile(re.escape(file.replace("NAME", name)).replace(r"\*", ".+")) for file, _ in TEMPLATES]
    further = re.compile(rf"{name}_\w+\.vhd|\w+\.(svg|py)")
    strange = {one for one in there if not any(way.fullmatch(one) for way in [*known, further])}
    assert not strange, "components/README.md knows no such files"


@pytest.mark.parametrize("name", NAMES)
def test_its_page_has_the_headings_and_its_example(name: str) -> None:
    page = text(f"components/{name}/README.md")
    assert page.startswith(f"# {name}\n")
    assert re.findall(r"^## .+", page, re.M)[: len(HEADINGS)] == HEADINGS
    example = text(f"components/{name}/example.ul")
    shown = re.search(r"```ul\n(.*?)```", page, re.S)
    assert shown is not None and shown[1] in example, "the first ```ul of the page is not in example.ul"


@pytest.mark.parametrize("name", NAMES)
def test_it_is_named_where_readers_look(name: str) -> None:
    for page in ("docs/components.md", "docs/ul-spec.md"):
        assert re.search(rf"\b{name}\b", text(page)), page
    assert f'"{name}_tb"' in text("tests/gateware/test_cores.py"), "no test runs its bench"


@pytest.mark.parametrize("name", NAMES)
def test_its_example_compiles_without_a_remark(name: str) -> None:
    result = compile_file(str(ROOT / "components" / name / "example.ul"))
    assert [(one.code, one.message) for one in result.diagnostics] == []
    assert result.spec is not None
    entities = {one.component.entity for one in result.spec.root().instances if one.component}
    assert name in entities
