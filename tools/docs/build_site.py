# SPDX-License-Identifier: BSD-3-Clause
"""Build the documents as a site:  python tools/docs/build_site.py [--out FOLDER]

The site has all pages that links from the top README lead to. They keep their paths in the checkout, so that
a page reads the same on a repository host. FOLDER (build/docs) gets `pages`, which mkdocs reads. The site
goes to FOLDER/site, or to build/site. The exit code is 1 for a broken link, a missing heading, or a page of
mkdocs.yml that does not exist.
"""

from __future__ import annotations

import argparse
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from itertools import groupby
from operator import itemgetter
from pathlib import Path
from typing import Any

import yaml
from reference import pages as reference_pages

ROOT = Path(__file__).resolve().parents[2]
LINK = re.compile(r"(!?\[[^\]]*\])\(([^)\s]+)\)")
FENCE = re.compile(r"^```")


def main() -> int:
    """Stage the pages, build the site, and print where it is."""
    parser = argparse.ArgumentParser(description="Build the documents as a site.")
    parser.add_argument(
        "--out", type=Path, help="folder for pages and site; build/docs and build/site without"
    )
    out: Path | None = parser.parse_args().out
    work = out or ROOT / "build" / "docs"
    site = out / "site" if out else ROOT / "build" / "site"
    shutil.rmtree(work / "pages", ignore_errors=True)
    stage(work / "pages")
    settings = work / "mkdocs.yml"
    places = {
        "docs_dir": "pages",
        "site_dir": str(site.resolve()),
        "nav": navigation(work / "pages"),
        "hooks": [str(Path(__file__).with_name("ulspec_lexer.py"))],  # the colours of UL-spec
    }
    settings.write_text(yaml.safe_dump({"INHERIT": str(ROOT / "mkdocs.yml"), **places}), "utf-8")
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--config-file", settings]
    built = subprocess.run(command, check=False)
    if built.returncode == 0:
        print(f"{site / 'index.html'}; with search: {sys.executable} -m http.server -d {site}")
    return built.returncode


def stage(folder: Path) -> None:
    """Write the pages, and the files that they show, into `folder`."""
    waiting = [ROOT / "README.md"]
    done: set[Path] = set()
    while waiting:
        page = waiting.pop()
        if page in done:
            continue
        done.add(page)
        target = folder / page.relative_to(ROOT)
        target.parent.mkdir(parents=True, exist_ok=True)
        if page.suffix == ".md":
            text, linked = _page(page)
            target.write_text(text, "utf-8")
            waiting += linked
        else:
            shutil.copyfile(page, target)
    for name, text in reference_pages().items():
        target = folder / "docs" / "reference" / name
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(text, "utf-8")


def navigation(pages: Path) -> list[Any]:
    """Return the order of mkdocs.yml.

    Pages without a place in it come after their folder's page, or last. The page of a component comes after
    that of all components.
    """
    text = (ROOT / "mkdocs.yml").read_text("utf-8").partition("\nnav:\n")[2]
    placed = set(re.findall(r"[\w./-]+\.md", text))
    nav: list[Any] = yaml.safe_load(text)
    for name in sorted(str(page.relative_to(pages)) for page in pages.rglob("*.md")):
        if name not in placed:
            folder = Path(name).parent
            beside = _list_with(nav, f"{folder}/README.md") or _list_with(nav, f"docs/{folder.parent}.md")
            (beside or nav[-1]["Explanation"]).append(name)
    return nav


def _list_with(nav: list[Any], name: str) -> list[Any] | None:
    """Return the innermost list that begins with the page `name`, the page of a folder."""
    if nav[0] == name:
        return nav
    for entry in nav:
        for inside in entry.values() if isinstance(entry, dict) else ():
            if isinstance(inside, list) and (found := _list_with(inside, name)):
                return found
    return None


def _page(page: Path) -> tuple[str, list[Path]]:
    """Return a page in a form that mkdocs takes, and the files to which it links."""
    linked: list[Path] = []

    def link(found: re.Match[str]) -> str:
        label, target = found.groups()
        name, mark, anchor = target.partition("#")
        if "://" in target or target.startswith("mailto:") or not name:
            return found.group()
        file = (page.parent / name).resolve()
        if file.is_dir():
            if not (file / "README.md").exists():
                return label.strip("![]")  # only a repository host can show a folder
            file, name = file / "README.md", f"{name.rstrip('/')}/README.md"
        linked.append(file)
        return f"{label}({name}{mark}{anchor})"

    text = ""
    for fenced, group in groupby(_lines(page), key=itemgetter(0)):
        block = "".join(f"{line}\n" for _, line in group)
        text += block if fenced else LINK.sub(link, block)  # the words of a link may go over two lines
    return text, linked


def _lines(page: Path) -> Iterator[tuple[bool, str]]:
    """Yield (whether it is code, line) of a page, with the empty lines that Python-Markdown needs."""
    before, fenced = "", False
    for line in page.read_text("utf-8").splitlines():
        fenced ^= bool(FENCE.match(line))
        if not fenced and _starts_block(line) and before and not _continues(before, line):
            yield False, ""  # GitHub needs no empty line before a list or a table, but Python-Markdown does
        yield fenced, line
        before = line


def _starts_block(line: str) -> bool:
    return bool(re.match(r"([-*] |\d+\. |\|)", line))


def _continues(before: str, line: str) -> bool:
    return _starts_block(before) or before.startswith("  ")


if __name__ == "__main__":
    sys.exit(main())
