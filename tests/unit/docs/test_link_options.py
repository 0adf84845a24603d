# SPDX-License-Identifier: BSD-3-Clause
"""The error message names the same options of a link as the pages. The defaults are the same, too."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from unitylink import connect
from unitylink.errors import UrlError
from unitylink.zenoh.far_options import OPTIONS

DOCS = Path(__file__).resolve().parents[3] / "docs"
PAGE = (DOCS / "command-line.md").read_text("utf-8")
LINKED = re.findall(r"\]\(([\w-]+\.md)\)", PAGE.partition("\n## LINK\n")[2].partition("\nOptions")[0])
PAGES = PAGE + "".join((DOCS / name).read_text("utf-8") for name in LINKED)


def known() -> set[str]:
    """Return the options of the native core, and those of `zenoh:`."""
    with pytest.raises(UrlError, match="no option 'nonsense'") as caught:
        connect("tcp://127.0.0.1:1?nonsense=1")
    listed = re.sub(r" \([\w, ]+\)", "", str(caught.value).partition("known are ")[2])
    return set(re.split(r", | and ", listed)) | set(OPTIONS)


def test_every_option_has_its_place_in_the_pages() -> None:
    names = known()
    assert {"timeout", "channel", "plant", "publish_mode", "offset"} <= names
    assert [name for name in sorted(names) if not re.search(rf"\b{name}=", PAGES)] == []


def test_every_option_of_the_page_is_known() -> None:
    page = (
        (DOCS / "command-line.md").read_text("utf-8").partition("\n## LINK\n")[2].partition("\n## Names\n")[0]
    )
    shown = set(re.findall(r"`(\w+)=", page)) | set(re.findall(r"(\w+)= ?", page))
    assert shown - known() - {"DIR"} == set()


def test_defaults() -> None:
    root = DOCS.parent / "native" / "src" / "layer2_message"
    engine = (root / "engine.hpp").read_text("utf-8")
    options = (root / "link_options.hpp").read_text("utf-8")
    page = (DOCS / "command-line.md").read_text("utf-8")
    window = re.search(r"\bwindow = (\d+);", engine)
    attempts = re.search(r"\battempts = (\d+);", options)
    timeout = re.search(r"\btimeout_ns = ([\d']+);", engine)
    assert window and attempts and timeout
    assert f"`window={window[1]}`" in page
    assert f"`attempts={attempts[1]}`" in page
    seconds = int(timeout[1].replace("'", "")) / 1e9
    assert f"`timeout={seconds:g}`" in page
