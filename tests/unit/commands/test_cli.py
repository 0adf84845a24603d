# SPDX-License-Identifier: BSD-3-Clause
"""The command group: its commands, their help, and the output of errors."""

from __future__ import annotations

import io
import re
import shlex
import subprocess
import sys
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path
from unittest.mock import patch

import click
import pytest
from effort import many
from hypothesis import given, settings
from hypothesis import strategies as st

from unitylink import cli, errors
from unitylink.commands.failure import Failure

ROOT = Path(__file__).resolve().parents[3]
PAGES = ("README.md", "docs/start.md", "docs/command-line.md")


def test_every_command_has_help_with_examples(capsys: pytest.CaptureFixture[str]) -> None:
    for name in cli.COMMANDS:
        assert cli.main([name, "--help"]) == 0, name
        out = capsys.readouterr().out
        assert "Example" in out and f"  unitylink {name}" in out
        assert set(re.findall(r"^( *)unitylink ", out.partition("Example")[2], re.M)) == {"    "}, name
        assert max(map(len, out.splitlines())) <= 110, name


def examples() -> list[str]:
    context = click.Context(cli.cli)
    commands = [cli.cli, *(cli.cli.get_command(context, name) for name in cli.COMMANDS)]
    texts = [command.help or "" for command in commands if command is not None]
    texts += [(ROOT / page).read_text("utf-8") for page in PAGES]
    pattern = re.compile(r"^ *((?:\w.* \| )?unitylink (?!COMMAND).*)$", re.M)
    return sorted({line for text in texts for line in pattern.findall(text)})


def test_every_example_is_right_usage() -> None:
    """Every command line in a help text or a document has valid options and arguments. Nothing is run."""
    lines = examples()
    assert len(lines) > 100
    for line in lines:
        words = shlex.split(line, comments=True)
        words = words[words.index("unitylink") + 1 :]
        end = next((i for i, word in enumerate(words) if word in ("&&", "&", ">", "<", "|")), len(words))
        name, *arguments = words[:end]
        command = cli.cli.get_command(click.Context(cli.cli), name)
        assert command is not None, line
        try:
            command.make_context(name, arguments)
        except click.ClickException as error:
            raise AssertionError(line) from error


def test_help_lists_the_commands(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["--help"]) == 0
    out = capsys.readouterr().out
    assert all(f"\n  {name} " in out for name in cli.COMMANDS)


def test_an_unknown_command_is_a_usage_error(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["chekc"]) == 2
    assert "did you mean 'check'?" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("error", "code", "lines"),
    [
        (Failure("broken", "mend it"), 1, "error: broken\nhelp: mend it\n"),
        (errors.BindingError("stale file"), 1, "error: stale file\n"),
        (errors.SpecError("error[UL011]: missing `;`\n"), 1, "error[UL011]: missing `;`\n"),
        (errors.ValueRangeError("j1: 5000 is too large"), 1, "error: j1: 5000 is too large\n"),
        (errors.UrlError("no such scheme"), 2, "error: no such scheme\nhelp: `unitylink info --help`"),
        (
            errors.LinkTimeout("unanswered").with_item("j1"),
            1,
            "error: j1: unanswered\n",
        ),
        (PermissionError(13, "Permission denied", "a.ul"), 1, "error: a.ul: Permission denied\n"),
        (KeyboardInterrupt(), 130, "\n"),
    ],
)
def test_errors_are_lines_and_codes(
    error: BaseException,
    code: int,
    lines: str,
    monkeypatch: pytest.MonkeyPatch,
    capfd: pytest.CaptureFixture[str],
) -> None:
    @click.command()
    def failing() -> None:
        raise error

    monkeypatch.setattr(cli.Commands, "get_command", lambda *_: failing)
    assert cli.main(["check"]) == code
    err = capfd.readouterr().err
    assert err.startswith(lines)
    assert "Traceback" not in err


TOKENS = st.one_of(
    st.sampled_from(
        ["--spec", "x.ul", "--json", "sim:x.ul", "0x10", "a=1", "*", "--", "-h", "=", "tcp://", "serial:"]
    ),
    st.sampled_from(
        ["sim:", "sim:?", "fd:999", "fd:", "udp://:", "tcp://127.0.0.1:1?timeout=0.01", "0x", "", "[", "-"]
    ),
    st.text(st.characters(exclude_characters="\0", exclude_categories=["Cs"]), max_size=8),
)


@settings(max_examples=many(150), deadline=None)
@given(
    st.sampled_from(["check", "list", "read", "write", "info", "watch", "conformance"]),
    st.lists(TOKENS, max_size=5),
)
def test_any_arguments_end_with_a_code_and_never_an_exception(command: str, arguments: list[str]) -> None:
    out, err = io.StringIO(), io.StringIO()
    with redirect_stdout(out), redirect_stderr(err), patch("sys.stdin", io.TextIOWrapper(io.BytesIO())):
        code = cli.main([command, *arguments])
    assert code in (0, 1, 2)
    assert (code == 0) or err.getvalue() or "error" in out.getvalue()


def test_a_file_name_that_is_no_text(tmp_path: Path) -> None:
    name = bytes(tmp_path) + b"/\xff.ul"
    done = subprocess.run(
        [sys.executable, "-m", "unitylink", "check", name], capture_output=True, text=True, check=False
    )
    assert done.returncode == 1
    assert "cannot be read" in done.stdout and done.stderr == ""


def test_starting_imports_nothing_heavy() -> None:
    code = (
        "import sys; from unitylink.cli import main; main(['--version']); main(['check', '--help']);"
        "print(*{'rich', 'numpy', 'jinja2', 'unitylink._native', 'asyncio'} & set(sys.modules))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == ""
