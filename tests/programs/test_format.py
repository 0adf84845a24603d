# SPDX-License-Identifier: BSD-3-Clause
"""tools/format.sh formats each kind of source, and with --check it names what is not formatted."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from unit.house.files import ROOT

SETTINGS = ("pyproject.toml", ".clang-format", ".clang-format-ignore", ".mdformat.toml", ".gitattributes")
BAD = {
    "a.py": "x = {'a':1}\n",
    "a.cpp": "int  a( ){return 1;}\n",
    "b.hpp": "int*  b ( ) ;\n",
    "docs/a.md": f"# A page\n* {'word ' * 30}\n* another\n",
}
MENDED = {
    "a.py": 'x = {"a": 1}\n',
    "a.cpp": "int a() { return 1; }\n",
    "b.hpp": "int* b();\n",
    "docs/a.md": f"# A page\n\n- {'word ' * 22}word\n  {'word ' * 6}word\n- another\n",
}
MADE = {
    "docs/settings.md": BAD["docs/a.md"],
    "tests/golden/a.cpp": BAD["a.cpp"],
    "tests/golden/a.py": BAD["a.py"],
}


def texts(folder: Path, names: dict[str, str]) -> dict[str, str]:
    return {name: (folder / name).read_text("utf-8") for name in names}


@pytest.fixture
def checkout(tmp_path: Path) -> Path:
    for name in (*SETTINGS, "tools/format.sh"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        shutil.copy(ROOT / name, tmp_path / name)
    for name, text in (BAD | MADE).items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text, "utf-8")
    (tmp_path / ".venv").symlink_to(sys.prefix)
    (tmp_path / ".gitignore").write_text("/.venv\n")
    subprocess.run(["git", "init", "-q"], cwd=tmp_path, check=True)
    return tmp_path


def test_each_kind_of_source(checkout: Path) -> None:
    def call(*options: str) -> tuple[int, str]:
        command = [checkout / "tools" / "format.sh", *options]
        done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
        return done.returncode, done.stdout + done.stderr

    for name in BAD:  # one fault alone is enough
        for other in BAD:
            (checkout / other).write_text((BAD if other == name else MENDED)[other], "utf-8")
        code, told = call("--check")
        assert (code, [other for other in BAD if other in told]) == (1, [name])
    for name, text in BAD.items():
        (checkout / name).write_text(text, "utf-8")
    code, told = call("--check")
    assert code == 1 and texts(checkout, BAD) == BAD
    assert [name for name in BAD if name not in told] == []
    assert [name for name in MADE if name in told] == []
    assert call()[0] == 0
    assert texts(checkout, BAD) == MENDED and texts(checkout, MADE) == MADE
    assert call("--check")[0] == 0
    assert call()[0] == 0 and texts(checkout, BAD) == MENDED
    assert call("--chek")[0] == 2
