# SPDX-License-Identifier: BSD-3-Clause
"""What a user gets with the library has a licence that goes together with ours, BSD-3-Clause."""

from __future__ import annotations

import json
import re
from importlib.metadata import PackageNotFoundError, metadata
from pathlib import Path

import pytest
from unit.modules import module_of

ROOT = Path(__file__).resolve().parents[3]
# Weak copyleft by file, as EPL-2.0 and MPL-2.0 are, asks nothing of a program that only imports the package.
FREE = re.compile(
    r"\b(MIT|BSD|0BSD|Apache|ISC|PSF|Python Software Foundation|EPL|Eclipse|MPL|Zlib|CC0|Unlicense)\b", re.I
)
NOT_FREE = re.compile(r"\b[AL]?GPL|General Public|propriet|commercial", re.I)


def judged(said: list[str]) -> str:
    """Return what is wrong with licences, or an empty text."""
    text = " / ".join(filter(None, said))
    if NOT_FREE.search(text):
        return f"{text} does not go together with BSD-3-Clause"
    return "" if FREE.search(text) else f"{text or 'nothing'} is no licence that is known here"


@pytest.mark.parametrize(
    ("said", "wrong"),
    [
        (["MIT"], ""),
        (["", "", "Eclipse Public License 2.0 (EPL-2.0)"], ""),
        (["GPL-3.0-only"], "does not go together"),
        (["MIT AND LGPL-2.1"], "does not go together"),
        (["", "GNU General Public License v3 (GPLv3)"], "does not go together"),
        (["see LICENSE"], "no licence that is known"),
        ([""], "nothing is no licence"),
    ],
)
def test_what_is_judged(said: list[str], wrong: str) -> None:
    assert wrong in judged(said) and bool(wrong) == bool(judged(said))


def test_of_every_package_that_the_library_or_an_extra_needs() -> None:
    bill = module_of(ROOT / "tools" / "sbom.py").bill()
    names = {
        one["name"] for one in bill["components"] if ":pypi/" in one["purl"] and one["scope"] != "excluded"
    }
    found: dict[str, str] = {}
    for name in sorted(names):
        try:
            told = metadata(name)
        except PackageNotFoundError:  # for another version of Python, or another system
            continue
        kinds = [one.rpartition(" :: ")[2] for one in told.get_all("Classifier") or [] if "License ::" in one]
        first = (told.get("License") or "").strip().partition("\n")[0]
        found[name] = judged([told.get("License-Expression") or "", first, *kinds])
    assert len(found) > 0.9 * len(names)
    assert not {name: wrong for name, wrong in found.items() if wrong}


def test_of_every_package_in_the_page() -> None:
    lock = json.loads((ROOT / "web" / "package-lock.json").read_text("utf-8"))
    shipped = {path: one for path, one in lock["packages"].items() if path and not one.get("dev")}
    wrong = {path: judged([one.get("license", "")]) for path, one in shipped.items()}
    assert shipped and not {path: why for path, why in wrong.items() if why}
