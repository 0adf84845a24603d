# SPDX-License-Identifier: BSD-3-Clause
"""The stub headers of ros2_control have what `stubs/published.toml` says of each release, and no more."""

from __future__ import annotations

import re
import sys
from pathlib import Path

import pytest

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

STUBS = Path(__file__).parent / "stubs"
TABLE = tomllib.loads((STUBS / "published.toml").read_text())
FOLDERS = {release: STUBS / release / "hardware_interface" for release in ("humble", "jazzy", "rolling")}
FOLDERS["hardware_interface"] = STUBS / "hardware_interface"
HEADERS = [
    (release, header)
    for release in TABLE
    for header in TABLE[release]
    if header not in ("version", "told_by")
]
OURS = ("// ours",)  # what tests need of a stub


def published(text: str) -> list[str]:
    """Return the functions that classes declare in public, one line each, without their bodies."""
    found, public = [], False
    for line in text.splitlines():
        if re.match(r"(class|struct) \w", line):
            public = line.startswith("struct")
        elif re.match(r" (public|protected|private):", line):
            public = line == " public:"
        elif public and re.match(r"  \S.*\(", line) and not line.endswith(OURS):
            found.append(re.split(r" \{| : |;|$", line.strip())[0])
    return [re.sub(r" = default$", "", one) if "&&" not in one else one for one in found]


@pytest.mark.parametrize(("release", "header"), HEADERS)
def test_a_stub_has_what_its_release_publishes_and_nothing_more(release: str, header: str) -> None:
    facts = TABLE[release][header]
    text = (FOLDERS[release] / header).read_text()
    assert facts["source"].startswith("https://")
    assert sorted(published(text)) == sorted(facts["published"])
    if "types" in facts:
        together = " ".join(text.split())
        assert f"std::variant<std::monostate, {', '.join(facts['types'])}>;" in together


def test_every_stub_with_a_class_is_in_the_table() -> None:
    told = {FOLDERS[release] / header for release, header in HEADERS}
    made = {
        path for folder in FOLDERS.values() for path in folder.glob("*.hpp") if published(path.read_text())
    }
    assert made == told


@pytest.mark.parametrize("release", ["jazzy", "rolling"])
def test_the_version_is_that_of_the_table(release: str) -> None:
    text = (FOLDERS[release] / "version.h").read_text()
    numbers = re.findall(r"_VERSION_(?:MAJOR|MINOR|PATCH) \((\d+)\)", text)
    assert ".".join(numbers) == TABLE[release]["version"]
    assert not (FOLDERS["humble"] / "version.h").exists(), "a release without it is also compiled"
