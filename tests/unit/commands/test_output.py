# SPDX-License-Identifier: BSD-3-Clause
"""Tables and colours."""

from __future__ import annotations

import io

import pytest

from unitylink.commands.output import colours, plain_table, print_json, print_table


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def test_plain_columns_align_and_are_never_cut() -> None:
    long = "x" * 300
    assert plain_table(("a", "b"), [("1", long), ("12345", "y")], right=[0]) == [
        "    a  b",
        f"    1  {long}",
        "12345  y",
    ]
    assert plain_table(("a",), []) == ["a"]


def test_colours_only_on_terminals_that_want_them(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("NO_COLOR", raising=False)
    monkeypatch.setenv("TERM", "xterm-256color")
    assert colours(Terminal())
    assert not colours(io.StringIO())
    monkeypatch.setenv("NO_COLOR", "1")
    assert not colours(Terminal())
    monkeypatch.setenv("NO_COLOR", "")
    monkeypatch.setenv("TERM", "dumb")
    assert not colours(Terminal())


def test_a_table_in_a_pipe_has_no_drawings(capsys: pytest.CaptureFixture[str]) -> None:
    print_table(("name", "value"), [("[bold]j1[/]", "-12")])
    assert capsys.readouterr().out == "name         value\n[bold]j1[/]  -12\n"


def test_json_is_json(capsys: pytest.CaptureFixture[str]) -> None:
    print_json({"a": "µm"})
    assert capsys.readouterr().out == '{\n  "a": "µm"\n}\n'
    with pytest.raises(ValueError, match="JSON"):
        print_json(float("nan"))


def test_a_table_wider_than_the_terminal_is_plain_and_whole(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("unitylink.commands.output.terminal", lambda: True)
    rows = [("left.j1.cpos", "joint 1 position")]
    monkeypatch.setenv("COLUMNS", "30")
    print_table(("name", "id"), rows)
    assert capsys.readouterr().out == "name          id\nleft.j1.cpos  joint 1 position\n"
    monkeypatch.setenv("COLUMNS", "80")
    print_table(("name", "id"), rows)
    assert "───" in capsys.readouterr().out
