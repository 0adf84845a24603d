# SPDX-License-Identifier: BSD-3-Clause
"""What every file and folder owes its reader."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]
FILES = [
    ROOT / name
    for name in subprocess.run(
        # safe.directory: in a container the checkout often belongs to somebody else
        ["git", "-c", "safe.directory=*", "ls-files", "--cached", "--others", "--exclude-standard"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    ).stdout.splitlines()
    if (ROOT / name).is_file()
]
CODE = [f for f in FILES if f.suffix in (".py", ".pyi", ".cpp", ".hpp", ".h", ".c", ".vhd", ".sh")]


@pytest.mark.parametrize("path", CODE, ids=lambda p: str(p.relative_to(ROOT)))
def test_licence_line(path: Path) -> None:
    if not path.read_text(encoding="utf-8").strip():
        return
    head = path.read_text(encoding="utf-8").splitlines()[:3]
    assert any("SPDX-License-Identifier: BSD-3-Clause" in line for line in head)


def test_files_fit_in_the_head() -> None:
    long = [f"{f.relative_to(ROOT)}: {n}" for f in CODE if (n := len(f.read_text().splitlines())) > 450]
    assert not long, "split these (one noun a file):\n" + "\n".join(long)


MIRRORS = [ROOT / "tests" / name for name in ("unit", "lab")]  # of src/; their page is tests/README.md


def test_folders_have_a_page() -> None:
    roots = ("src", "native", "gateware", "protocol", "examples", "bench", "tests", "tools")
    folders = {f.parent for f in CODE if str(f.relative_to(ROOT)).startswith(roots)}
    missing = [
        str(folder.relative_to(ROOT))
        for folder in sorted(folders)
        if not (folder / "README.md").exists()
        and not any(folder.is_relative_to(mirror) for mirror in MIRRORS)
    ]
    assert not missing, "folders without a README.md:\n" + "\n".join(missing)
