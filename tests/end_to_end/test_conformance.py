# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink conformance` on the recordings, and on files that are not recordings."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

RECORDINGS = Path(__file__).resolve().parents[1] / "conformance" / "classic-transcripts.json"
Run = Callable[..., "subprocess.CompletedProcess[str]"]


def test_the_twin_answers_as_the_gateware_did(run: Run) -> None:
    done = run("conformance", RECORDINGS)
    assert done.returncode == 0, done.stdout
    assert done.stdout.splitlines()[-1] == "366 passed, 0 failed"


def test_json(run: Run) -> None:
    done = run("conformance", RECORDINGS, "--json")
    report = json.loads(done.stdout)
    assert done.returncode == 0
    assert (report["passed"], report["failed"], report["defects_wrong"]) == (366, 0, 0)
    assert len(report["exchanges"]) == 439


def test_a_wrong_answer_is_found(run: Run, tmp_path: Path) -> None:
    document = json.loads(RECORDINGS.read_text(encoding="utf-8"))
    exchange = next(e for r in document["runs"] for e in r["exchanges"] if e["status"] == "required")
    exchange["response"] = "?00\n" + exchange["response"]
    (tmp_path / "wrong.json").write_text(json.dumps(document), encoding="utf-8")
    done = run("conformance", "wrong.json")
    assert done.returncode == 1
    assert done.stdout.splitlines()[-1] == "365 passed, 1 failed"
    assert exchange["name"] in done.stdout


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "not JSON"),
        ("{}", "runs"),
        ('{"runs": []}', "no required exchange"),
        ('{"runs": [1]}', "runs[0]"),
    ],
)
def test_a_file_that_is_no_recording(run: Run, tmp_path: Path, text: str, message: str) -> None:
    (tmp_path / "x.json").write_text(text)
    done = run("conformance", "x.json")
    assert (done.returncode, done.stdout) == (1, "")
    assert message in done.stderr


def test_no_file(run: Run) -> None:
    assert run("conformance", "gone.json").stderr == "error: gone.json: No such file or directory\n"
    assert run("conformance").returncode == 2
