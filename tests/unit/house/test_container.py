# SPDX-License-Identifier: BSD-3-Clause
"""The container file fits the project and what docs/server.md says about it. No container is built here."""

from __future__ import annotations

import json
import re
import shlex

import click
import pytest
import tomli
from unit.house.files import ROOT, text

from unitylink.commands.serve import command

FILE = text("Containerfile")
SHOWN = re.search(r"```sh\n(podman build.*?)```", text("docs/server.md"), re.S)


def test_it_installs_extras_that_there_are() -> None:
    (extras,) = re.findall(r"/source\[([\w,]+)\]", FILE)
    known = tomli.loads(text("pyproject.toml"))["project"]["optional-dependencies"]
    assert set(extras.split(",")) <= set(known)


def test_it_has_what_a_build_needs_and_what_encryption_needs() -> None:
    built, runs = FILE.split("FROM ")[1:]
    assert {"g++", "cmake"} <= set(built.split()) and "(`sudo apt-get install g++ cmake`)" in text(
        "docs/install.md"
    )
    assert "libssl3" in runs.split() and "apt-get install libssl3" in text("docs/server.md")


def test_what_is_left_out_is_what_git_ignores() -> None:
    ignored = {line.strip("/") for line in text(".gitignore").splitlines()}
    for name in text(".containerignore").split():
        assert name == ".git" or name in ignored or name.endswith("/node_modules"), name
    assert all((ROOT / name).exists() for name in ("pyproject.toml", "CMakeLists.txt", "src"))


def test_the_command_of_the_page_is_one_of_serve() -> None:
    (entry,) = re.findall(r"^ENTRYPOINT (.*)$", FILE, re.M)
    assert json.loads(entry)[1:] == ["serve"]
    assert SHOWN, "docs/server.md shows how to build and run it"
    words = shlex.split(SHOWN[1].split("\n", 1)[1].replace("\\\n", " "))
    arguments = words[words.index("unitylink") + 1 :]
    with click.Context(command) as context:
        command.parse_args(context, arguments)
    (port,) = re.findall(r"^EXPOSE (.*)$", FILE, re.M)
    assert context.params["listen"].endswith(f":{port}")
    assert context.params["token_file"] and context.params["tls_cert"] and context.params["anyone"]


def test_a_wrong_option_would_be_found() -> None:
    with click.Context(command) as context, pytest.raises(click.UsageError):
        command.parse_args(context, ["sim:a.ul", "a.ul", "--no-such-option"])
