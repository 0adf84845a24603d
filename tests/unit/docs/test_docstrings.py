# SPDX-License-Identifier: BSD-3-Clause
"""The examples in the docstrings of the library are true."""

from __future__ import annotations

import doctest
from importlib import import_module
from pathlib import Path, PurePosixPath

import pytest
from unit.house.files import files, text

EXAMPLE = ">>> "
FILES = [file for file in files((".py",)) if str(file).startswith("src/unitylink/") and EXAMPLE in text(file)]


def module_name(file: PurePosixPath) -> str:
    return ".".join(file.relative_to("src").with_suffix("").parts).removesuffix(".__init__")


def test_the_files_are_found() -> None:
    assert len(FILES) > 70
    assert module_name(PurePosixPath("src/unitylink/spec/__init__.py")) == "unitylink.spec"


@pytest.mark.parametrize("file", FILES, ids=str)
def test_examples(file: PurePosixPath, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert doctest.testmod(import_module(module_name(file))).failed == 0
