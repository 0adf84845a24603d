# SPDX-License-Identifier: BSD-3-Clause
"""Symbolic links among the files that a spec imports."""

from __future__ import annotations

from pathlib import Path

from unitylink.spec import compile_file


def test_links_lead_nowhere_but_below_the_search_path(tmp_path: Path) -> None:
    project, library = tmp_path / "project", tmp_path / "library"
    project.mkdir()
    library.mkdir()
    (library / "joint.ul").write_text("joint(): @ (p) { @p: READ(); }\n")
    (project / "joint.ul").symlink_to(library / "joint.ul")
    spec = project / "arm.ul"
    spec.write_text('import "joint.ul"; public a() { j: joint() @ (0x1); }')
    (error,) = [one for one in compile_file(spec).diagnostics if one.code == "UL044"]
    assert f"leads to `{library / 'joint.ul'}`" in error.message and str(library) in error.hint
    assert compile_file(spec, [library]).spec is not None, "what the hint says helps"
