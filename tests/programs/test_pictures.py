# SPDX-License-Identifier: BSD-3-Clause
"""The pictures of the documents show the present links, boards and captures."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import pytest

ROOT = Path(__file__).resolve().parents[2]
IMAGES = ROOT / "docs" / "images"


@pytest.mark.parametrize("script", ["pictures.py", "terminal.py"])
def test_the_pictures_are_those_of_the_script(script: str) -> None:
    check = [sys.executable, ROOT / "tools" / "docs" / script, "--check"]
    done = subprocess.run(check, capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 0, f"`make docs` draws them: {done.stdout}{done.stderr}"


def test_a_message_is_shown_byte_for_byte() -> None:
    texts = [e.text for e in ElementTree.parse(IMAGES / "message.svg").iter() if e.tag.endswith("}text")]
    assert "PC to device: $R:12*58" in texts
    assert [t for t in texts if t and len(t) == 1][:9] == list("$R:12*58$")
