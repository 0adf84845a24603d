# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink explain`.

(tests/unit/spec/test_codes.py tests that every code has a page, and that it is true)
"""

from __future__ import annotations

import json

import pytest

from unitylink import cli
from unitylink.ports.findings import FINDINGS
from unitylink.spec import CODES


def test_explains_with_the_example_marked(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["explain", "ul013"]) == 0
    out = capsys.readouterr().out
    assert out.startswith("UL013, error: closing brace without an opening one\n")
    assert "    }\n    }\n    ^\n" in out and "Right:" in out


def test_lists_all_codes(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["explain"]) == 0
    listed = [line.split()[0] for line in capsys.readouterr().out.splitlines()[1:]]
    assert listed == [*CODES, *FINDINGS]


def test_explains_a_finding_of_the_doctor(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["explain", "No-Port"]) == 0
    out = capsys.readouterr().out
    assert out.startswith("no-port, error: The port does not exist\n") and "    unitylink discover\n" in out
    assert cli.main(["explain", "no-prot"]) == 1
    assert "did you mean no-port?" in capsys.readouterr().err


def test_a_finding_is_explained_with_an_example_and_no_braces(capsys: pytest.CaptureFixture[str]) -> None:
    for code in FINDINGS:
        assert cli.main(["explain", code]) == 0, code
        assert "{" not in capsys.readouterr().out, code
        assert cli.main(["explain", code, "--json"]) == 0, code
        (found,) = json.loads(capsys.readouterr().out)
        assert "{" not in found["cause"] + found["remedy"] and found["code"] == code


def test_json(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["explain", "UL011", "--json"]) == 0
    (page,) = json.loads(capsys.readouterr().out)
    assert page["code"] == "UL011" and (page["line"], page["column"]) == (2, 20)
    assert page["mended"].count(";") == page["wrong"].count(";") + 1


def test_unknown_code(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["explain", "UL999"]) == 1
    error = capsys.readouterr().err
    assert "there is no code 'UL999'" in error and "help: " in error
