# SPDX-License-Identifier: BSD-3-Clause
"""The page in `src/unitylink/dashboard/page` is what `make page` makes of `web/`, byte for byte."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PAGE = Path("src/unitylink/dashboard/page")


def build(checkout: Path, *options: str) -> subprocess.CompletedProcess[str]:
    command = ["node", "web/build.mjs", *options]
    return subprocess.run(command, cwd=checkout, capture_output=True, text=True, check=False, timeout=120)


def test_the_page_is_made_of_its_sources(tmp_path: Path) -> None:
    assert build(ROOT, "--check").returncode == 0, "run make page"
    shutil.copytree(ROOT / "web", tmp_path / "web", ignore=shutil.ignore_patterns("node_modules"))
    (tmp_path / "web" / "node_modules").symlink_to(ROOT / "web" / "node_modules")
    made = build(tmp_path)  # in another folder, with nothing there
    assert made.returncode == 0, made.stderr
    for file in (ROOT / PAGE).iterdir():
        assert (tmp_path / PAGE / file.name).read_bytes() == file.read_bytes(), f"{file.name}: run make page"
    (tmp_path / "web" / "src" / "icon.svg").write_text("<svg/>\n")
    stale = build(tmp_path, "--check")
    assert stale.returncode == 1 and "icon.svg" in stale.stderr


def test_the_types_of_the_page() -> None:
    done = subprocess.run(
        ["node_modules/.bin/tsc", "--noEmit"],
        cwd=ROOT / "web",
        capture_output=True,
        text=True,
        check=False,
        timeout=120,
    )
    assert done.returncode == 0, done.stdout


def test_the_page_loads_nothing_from_elsewhere() -> None:
    for file in (ROOT / PAGE).iterdir():
        if file.suffix in (".js", ".css", ".html"):
            text = file.read_text("utf-8").replace("http://www.w3.org/", "")
            assert "http://" not in text and "https://" not in text, file.name
