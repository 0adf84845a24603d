# SPDX-License-Identifier: BSD-3-Clause
"""The documents as a site: it is built without a warning, and it needs nothing from the network."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

from unitylink.cli import COMMANDS

from .conftest import PATIENCE_S, ROOT

LOADED = re.compile(r"<(?:script|img|link|iframe)\b[^>]*?(?:src|href)=\"?((?:https?:)?//[^\"\s>]+)")


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("docs")
    build = [sys.executable, ROOT / "tools" / "docs" / "build_site.py", "--out", folder]
    done = subprocess.run(build, capture_output=True, text=True, timeout=3 * PATIENCE_S, check=False)
    assert done.returncode == 0, f"`tools/setup.sh group docs` brings mkdocs\n{done.stdout}{done.stderr}"
    return folder / "site"


@pytest.mark.xdist_group("site")
class TestSite:
    def test_every_document_is_in_it(self, site: Path) -> None:
        for page in (ROOT / "docs").rglob("*.md"):
            name = page.relative_to(ROOT).with_suffix(".html")
            name = name.with_name("index.html") if name.name == "README.html" else name
            assert (site / name).is_file(), name

    def test_nothing_is_loaded_from_the_network(self, site: Path) -> None:
        for page in site.rglob("*.html"):
            assert not (loaded := LOADED.findall(page.read_text("utf-8"))), f"{page}: {loaded}"

    def test_the_reference_has_every_command_with_its_options(self, site: Path) -> None:
        page = (site / "docs" / "reference" / "commands.html").read_text("utf-8")
        for name in COMMANDS:
            assert f'id="{name}"' in page, name
        assert "--duration" in page

    def test_the_reference_has_classes_with_signatures(self, site: Path) -> None:
        page = (site / "docs" / "reference" / "python-unitylink.html").read_text("utf-8")
        assert 'id="linkread_many"' in page
        assert "object at 0x" not in page

    def test_every_page_of_the_navigation_can_be_reached_by_it(self, site: Path) -> None:
        """This includes the folders' own pages. A section may have several of them."""
        front = (site / "index.html").read_text("utf-8")
        reached = set(re.findall(r'class="md-nav__link[^"]*"[^>]*href="([^"#]+)"', front))
        reached |= set(re.findall(r'href="([^"#]+)" class="md-nav__link', front))
        placed = re.findall(
            r"[\w./-]+\.md", (ROOT / "mkdocs.yml").read_text("utf-8").partition("\nnav:\n")[2]
        )
        expected = {re.sub(r"README\.html$", "index.html", name[:-3] + ".html") for name in placed}
        assert len(expected) > 50 and not expected - reached - {"index.html"}

    def test_specs_are_coloured(self, site: Path) -> None:
        front = (site / "index.html").read_text("utf-8")
        assert '<span class="k">public</span>' in front  # a keyword
        language = (site / "docs" / "ul-spec.html").read_text("utf-8")
        assert 'class="kr">READ' in language and 'class="err"' not in language

    def test_pages_of_a_folder_stand_under_its_page(self, site: Path) -> None:
        page = (site / "docs" / "gateware" / "uart.html").read_text("utf-8")
        assert 'href="core.html"' in page  # a neighbour in the navigation


BREAKS_A_LINK = """
import sys
sys.path.insert(0, sys.argv.pop(1))
import build_site
whole = build_site.stage
def stage(folder):
    whole(folder)
    with open(folder / "docs" / "start.md", "a") as page:
        page.write("[gone](gone.md)")
build_site.stage = stage
sys.exit(build_site.main())
"""


def test_a_broken_link_fails_the_build(tmp_path: Path) -> None:
    command = [sys.executable, "-c", BREAKS_A_LINK, ROOT / "tools" / "docs", "--out", tmp_path]
    done = subprocess.run(command, capture_output=True, text=True, timeout=3 * PATIENCE_S, check=False)
    assert done.returncode == 1, done.stdout + done.stderr
    assert "gone.md" in done.stderr
