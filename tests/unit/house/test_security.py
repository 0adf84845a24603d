# SPDX-License-Identifier: BSD-3-Clause
"""SECURITY.md promises only what a test checks."""

from __future__ import annotations

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
PAGE = (ROOT / "SECURITY.md").read_text(encoding="utf-8")


def test_the_tests_it_names_are_there() -> None:
    named = re.findall(r"`((?:tests|native|tools)/[\w/.-]+)`", PAGE)
    assert len(named) > 20
    assert not [path for path in named if not (ROOT / path).exists()]


def test_each_promise_names_its_test() -> None:
    promises = re.findall(r"^- \*\*.*?(?=^- |^#|\n\n)", PAGE, re.MULTILINE | re.DOTALL)
    assert len(promises) > 15
    assert not [promise for promise in promises if "test_" not in promise]
