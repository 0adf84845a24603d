# SPDX-License-Identifier: BSD-3-Clause
"""The record of executed lines fits the gateware as it is. `make coverage` makes it anew."""

from __future__ import annotations

import importlib
import json
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def coverage(monkeypatch: pytest.MonkeyPatch) -> Any:
    """Import tools/coverage.py, which is no package."""
    monkeypatch.syspath_prepend(str(ROOT / "tools"))
    return importlib.import_module("coverage")


def test_the_record_is_of_this_gateware_and_enough_of_it_is_executed(coverage: Any) -> None:
    record = json.loads(coverage.RECORD.read_text(encoding="utf-8"))
    assert record["digest"] == coverage.digest(), "the gateware or a bench has changed: make coverage"
    files = record["files"]
    assert set(files) == {str(path.relative_to(coverage.ROOT)) for path in coverage.designs()}
    lines, run = (sum(file[what] for file in files.values()) for what in ("lines", "run"))
    assert 100 * run / lines >= coverage.PERCENT_LEAST == 95.0


def test_a_statement_that_changes_makes_the_record_stale(
    coverage: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    text = coverage.plain_text
    now = coverage.digest()
    monkeypatch.setattr(
        coverage, "plain_text", lambda path: text(path) + (" " if path.name == "fifo.vhd" else "")
    )
    assert coverage.digest() != now


def test_a_bench_that_fails_leaves_the_record(
    coverage: Any, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    record = tmp_path / "coverage.json"
    record.write_text("{}")
    monkeypatch.setattr(coverage, "RECORD", record)
    monkeypatch.setattr(coverage, "COUNTS", tmp_path / "counts")
    monkeypatch.setattr(coverage.sys, "executable", "false")  # a stand-in for pytest with a failed test
    assert coverage.main([]) == 1
    assert "a bench failed (see above), so coverage.json stays as it was" in capsys.readouterr().out
    assert record.read_text() == "{}"


def test_a_name_that_no_bench_has_is_told(
    coverage: Any, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    stand_in = tmp_path / "python"  # for pytest without a test that has one of the names
    stand_in.write_text(f"#!/bin/sh\nexit {int(pytest.ExitCode.NO_TESTS_COLLECTED)}\n")
    stand_in.chmod(0o755)
    monkeypatch.setattr(coverage.sys, "executable", str(stand_in))
    monkeypatch.setattr(coverage, "COUNTS", tmp_path / "counts")
    assert coverage.main(["--benches", "gpoi", "fifo"]) == 1
    assert capsys.readouterr().out.splitlines()[-1] == "no bench has gpoi or fifo in its name"
