# SPDX-License-Identifier: BSD-3-Clause
"""CONTRIBUTING.md is true: its map has every folder, and the code has what the recipes ask for."""

from __future__ import annotations

import re

import click
import pytest
from unit.house.files import ROOT, files, text

from unitylink import cli
from unitylink.connection.schemes import SCHEMES
from unitylink.generate import ARTEFACTS

PAGE = text("CONTRIBUTING.md")
RECIPES = ("Add a link scheme", "Add a component", "Add a generator", "Add a command")


def section(title: str) -> str:
    return PAGE.partition(f"\n## {title}\n")[2].partition("\n## ")[0]


def has(name: str, told: str) -> bool:
    """Tell whether `told` has `name` as a word. A word made of it counts too: `open_spi`, `--spi`."""
    return re.search(rf"(?<![A-Za-z]){name}(?![a-z])", told) is not None


def files_of(recipe: str) -> list[tuple[str, str]]:
    """Return (model, path) of each file that the steps name.

    A step with the words `as X does` has the model X.
    """
    told = section(recipe)
    (model,) = re.findall(r"[Tt]he model is `(\w+)`", told)
    found = []
    for step in re.findall(r"^\d+\. (.*(?:\n   .*)*)", told, re.M):
        if step.startswith("Run "):
            continue
        for sentence in re.split(r"(?<=[.:]) ", step):
            own = re.search(r"as `(\w+)` does", sentence)
            for path in re.findall(r"`([\w./]+/[\w./]*)`", sentence):
                found.append((own[1] if own else model, path))
    return found


def test_the_map_has_every_folder() -> None:
    folders = {file.parts[0] for file in files() if len(file.parts) > 1}
    named = {path.partition("/")[0] for path in re.findall(r"`([\w./]+)`", section("Where a line belongs"))}
    assert {folder for folder in folders if not folder.startswith(".")} - named == set()


@pytest.mark.parametrize("recipe", RECIPES)
def test_the_model_stands_in_every_file_of_its_recipe(recipe: str) -> None:
    files = files_of(recipe)
    assert len(files) >= 5
    for model, template in files:
        path = ROOT / template.replace("NAME", model)
        assert path.exists(), f"{recipe}: {template}, of {model}"
        if path.is_file():
            assert has(model, path.name) or has(model, path.read_text("utf-8")), f"{model} not in {template}"


def test_a_scheme_touches_at_most_8_files() -> None:
    """No other source knows the model, because messages, options and `connect` read its row."""
    recipe = section("Add a link scheme")
    files = {path for _, path in files_of("Add a link scheme")} | set(re.findall(r"`(\w+\.yml)`", recipe))
    assert 5 <= len(files) <= 8, files
    core = [
        path for path in (ROOT / "native" / "src").rglob("*.[ch]pp") if not path.match("layer0_driver/spi_*")
    ]
    knows = re.compile(r"\bspi\b|open_spi", re.IGNORECASE)
    told = [path.name for path in core if knows.search(re.sub(r"//.*", "", path.read_text("utf-8")))]
    assert told == ["schemes.cpp"]


@pytest.mark.parametrize("name", SCHEMES)
def test_every_scheme_has_what_its_recipe_asks_for(name: str) -> None:
    table = text("docs/command-line.md").partition("\n## LINK\n")[2].partition("\nOptions")[0]
    assert f"`{name}:" in table, "docs/command-line.md has a table LINK"
    tried = text("tests/end_to_end/test_every_scheme.py") + text("tests/end_to_end/test_rtl.py")
    assert f'"{name}:' in tried or f'("{name}"' in tried, "no test tries all commands on it"


@pytest.mark.parametrize("name", ARTEFACTS)
def test_every_generator_has_what_its_recipe_asks_for(name: str) -> None:
    assert ARTEFACTS[name].files.__module__.startswith(f"unitylink.generate.{name}")
    assert (ROOT / "src" / "unitylink" / "generate" / name / "README.md").is_file()
    assert f"`{name}/`" in text("src/unitylink/generate/README.md")
    command = cli.cli.get_command(click.Context(cli.cli), "generate")
    assert command is not None
    (only,) = [one for one in command.params if one.name == "only"]
    assert has(name, getattr(only, "help", "")), "the help of --only"


def test_every_command_has_what_its_recipe_asks_for() -> None:
    for name, (module, *_) in cli.COMMANDS.items():
        if name in cli.CHECKOUT_ONLY:
            assert f"`{module}/`" in text("src/unitylink_lab/README.md")
        else:
            assert f"`{module}.py`" in text("src/unitylink/commands/README.md")
        command = cli.cli.get_command(click.Context(cli.cli), name)
        assert command is not None, name
        assert "unitylink " + name in (command.help or ""), f"the help of {name} ends with examples"
