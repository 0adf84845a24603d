# SPDX-License-Identifier: BSD-3-Clause
"""What every file and folder must have for its reader."""

from __future__ import annotations

from unit.house.files import ROOT, files, text

CODE = (".py", ".pyi", ".cpp", ".hpp", ".h", ".c", ".vhd", ".sh")
LICENCE = "SPDX-License-Identifier: BSD-3-Clause"


def test_licence_line() -> None:
    heads = {file: text(file).splitlines()[:3] for file in files(CODE) if text(file).strip()}
    assert len(heads) > 900
    missing = [str(file) for file, head in heads.items() if not any(LICENCE in line for line in head)]
    assert not missing, "without a licence line:\n" + "\n".join(missing)


def test_files_fit_in_the_head() -> None:
    written = [file for file in files(CODE) if file.parts[:2] != ("tests", "golden")]  # those are made
    long = [f"{f}: {n}" for f in written if (n := len(text(f).splitlines())) > 450]
    assert not long, "split these (one noun a file):\n" + "\n".join(long)


MIRRORS = ("tests/unit", "tests/lab")  # they mirror src/; their page is tests/README.md


def test_folders_have_a_page() -> None:
    roots = ("src", "native", "gateware", "components", "protocol", "examples", "bench", "tests", "tools")
    folders = {file.parent for file in files(CODE) if str(file).startswith(roots)}
    missing = [
        str(folder)
        for folder in sorted(folders)
        if not (ROOT / folder / "README.md").exists()
        and not any(folder.is_relative_to(mirror) for mirror in MIRRORS)
    ]
    assert not missing, "folders without a README.md:\n" + "\n".join(missing)
