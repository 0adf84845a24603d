# SPDX-License-Identifier: BSD-3-Clause
"""docs/command-line.md and docs/performance.md name all commands, their JSON, all figures."""

from __future__ import annotations

import re
from pathlib import Path

import click

from unitylink import cli
from unitylink_lab.bench import FIGURES

DOCS = Path(__file__).resolve().parents[3] / "docs"


def first_cells(text: str) -> set[str]:
    """Return the words in code type in the first column of the tables."""
    cells = re.findall(r"^\| (`[^|]*?) \|", text.replace("\\|", " "), re.M)
    return {word for cell in cells for word in re.findall(r"`([\w-]+)", cell)}


def _with_parts(command: click.Command) -> list[click.Command]:
    """Return a command and, if it is a group, its own commands."""
    return [command, *(command.commands.values() if isinstance(command, click.Group) else ())]


def test_every_command_and_what_it_prints_as_json() -> None:
    page = (DOCS / "command-line.md").read_text("utf-8")
    commands, as_json = page.split("`--json` prints instead:")
    assert set(cli.COMMANDS) - first_cells(commands) == set()
    context = click.Context(cli.cli)
    printing = {
        name
        for name in cli.COMMANDS
        if (command := cli.cli.get_command(context, name)) is not None
        and any("--json" in parameter.opts for one in _with_parts(command) for parameter in one.params)
    }
    assert first_cells(as_json.split("\n\n", 2)[1]) == printing


def test_every_figure_of_the_bench() -> None:
    page = (DOCS / "performance.md").read_text("utf-8")
    assert set(FIGURES) - first_cells(page.split("## How each is measured")[0]) == set()


def test_the_last_table_asks_what_the_page_asks() -> None:
    page = (DOCS / "performance.md").read_text("utf-8")
    meant, _, last = page.partition("## How each is measured")
    asked = re.findall(r"^\| (`[^|]*) \| ([^|]*) \|", meant, re.M)
    rows = re.findall(r"^\| `([\w-]+)` \| ([^|]*) \|", last.partition("## Last table")[2], re.M)
    assert len(rows) > 25
    for name, told in rows:
        (text,) = [text for names, text in asked if f"`{name}`" in names]
        number = re.search(r"\d[\d.,]*\d|\d", told)
        assert number is None or number[0] in re.findall(r"\d[\d.,]*\d|\d", text), f"{name}: {told}; {text}"
