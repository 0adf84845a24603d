# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink check`: fixes that never break a file, JSON and SARIF."""

from __future__ import annotations

import json
import random
from pathlib import Path

import pytest

from unitylink import cli
from unitylink.spec import CODES, compile_text
from unitylink.spec.fix import fix_text
from unitylink.spec.report.explain import explain

SCARA = (Path(__file__).parents[3] / "examples" / "scara" / "scara.ul").read_text("utf-8")
WRONG = SCARA.replace("BASE=0);", "BASE=0)").replace("0x95);", "0x95)")


def test_fix_mends_the_file_and_shows_how(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "scara.ul"
    file.write_text(WRONG, encoding="utf-8")
    file.chmod(0o640)
    assert cli.main(["check", "--diff", str(file)]) == 0
    shown = capsys.readouterr().out
    assert "-   TOSNET(CTRL=ctrl, COMM=comm, BASE=0)\n+   TOSNET(CTRL=ctrl, COMM=comm, BASE=0);\n" in shown
    assert file.read_text("utf-8") == WRONG
    assert cli.main(["check", "--fix", str(file)]) == 0
    out, err = capsys.readouterr()
    assert out == shown and "2 fixes made" in err and "no mistakes" in out
    assert file.read_text("utf-8") == SCARA
    assert file.stat().st_mode & 0o777 == 0o640


def test_what_cannot_be_fixed_is_reported(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "scara.ul"
    file.write_text(WRONG.replace("0x80,", "0x81,"), encoding="utf-8")
    assert cli.main(["check", "--fix", str(file)]) == 1
    assert "error[UL051]" in capsys.readouterr().out
    for bad in (b"\xff", b" " * 2_000_000):
        file.write_bytes(bad)
        assert cli.main(["check", "--fix", str(file)]) == 1
        assert file.read_bytes() == bad
    assert cli.main(["check", "--fix", str(tmp_path)]) == 1
    assert cli.main(["check", "--fix", "-"]) == 2
    capsys.readouterr()


def faults(text: str) -> tuple[int, int, int]:
    result = compile_text(text)
    syntax = sum(d.severity == "error" and d.code <= "UL019" for d in result.diagnostics)
    return syntax, result.errors, len(result.diagnostics)


def test_fixes_never_make_a_text_worse() -> None:
    """The mistakes get fewer, or the text stays the same.

    This is tried on wrong examples and on texts with random damage.
    """
    chance = random.Random(4)
    texts = [explain(code).wrong for code in CODES if explain(code).wrong]
    for _ in range(120):
        text = chance.choice([SCARA, *texts])
        at = chance.randrange(len(text))
        texts.append(
            text[:at] + chance.choice(["", ";", "}", "x", "0", "("]) + text[at + chance.randrange(3) :]
        )
    made = 0
    for text in texts:
        fixed = fix_text(text)
        assert (fixed.text == text) == (not fixed.made)
        if fixed.made:
            made += 1
            assert faults(fixed.text) < faults(text)
            assert fix_text(fixed.text).made == ()
    assert made > 3


def test_sarif(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "my scara.ul"
    file.write_text(WRONG + "unused() {\n}\n", encoding="utf-8")
    assert cli.main(["check", "--sarif", str(file)]) == 1
    log = json.loads(capsys.readouterr().out)
    assert log["version"] == "2.1.0"
    (run,) = log["runs"]
    first = run["results"][0]
    assert run["tool"]["driver"]["rules"][first["ruleIndex"]]["id"] == first["ruleId"] == "UL011"
    place = first["locations"][0]["physicalLocation"]
    assert place["artifactLocation"]["uri"].endswith("my%20scara.ul")
    assert (place["region"]["startLine"], place["region"]["startColumn"]) == (2, 40)
    (change,) = first["fixes"][0]["artifactChanges"]
    (replacement,) = change["replacements"]
    assert replacement["insertedContent"]["text"] == ";"
    assert replacement["deletedRegion"] == {"charOffset": WRONG.index("BASE=0)") + 7, "charLength": 0}
    assert cli.main(["check", "--sarif", "--json", str(file)]) == 2
    capsys.readouterr()
