# SPDX-License-Identifier: BSD-3-Clause
from __future__ import annotations

from pathlib import Path

import pytest

from unitylink.cli import main
from unitylink.server.token_file import load_tokens, parse_tokens


def test_a_printed_token_logs_in_by_the_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "tokens.toml"
    made = []
    for words in (["ana", "write j1.*"], ["ben", "read", "--expires", "2027-01-31"]):
        assert main(["token", *words, "--file", str(path)]) == 0
        made.append(capsys.readouterr().out.strip())
    tokens = load_tokens(path)
    users = [tokens.user(token, 0.0) for token in made]
    assert [user and str(user.rights) for user in users] == ["write j1.*", "read"]
    assert users[1] and users[1].expires_s == 1801353600.0
    assert path.stat().st_mode & 0o777 == 0o600
    assert not any(token in path.read_text() for token in made)


def test_without_a_file_the_entry_is_shown_beside(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["token", "ana", "read"]) == 0
    said = capsys.readouterr()
    entry = said.err[said.err.index("[[token]]") :].partition("\nThe token")[0]
    assert parse_tokens(entry, "entry").user(said.out.strip(), 0.0)


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["ana", "fly"], "'fly' is no scope"),
        (["a b", "read"], "name is 'a b'"),
        (["ana", "read", "--expires", "soon"], "write a day as 2027-01-31"),
    ],
)
def test_a_mistake_leaves_no_entry(
    tmp_path: Path, words: list[str], told: str, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "tokens.toml"
    assert main(["token", *words, "--file", str(path)]) == 1
    said = capsys.readouterr()
    assert told in said.err
    assert said.out == ""
    assert not path.exists()


def test_a_name_that_is_there_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "tokens.toml"
    assert main(["token", "ana", "read", "--file", str(path)]) == 0
    before = path.read_text()
    assert main(["token", "ana", "admin", "--file", str(path)]) == 1
    assert "has a token of ana" in capsys.readouterr().err
    assert path.read_text() == before
