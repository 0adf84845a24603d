# SPDX-License-Identifier: BSD-3-Clause
"""Try all commands that take a LINK on one, one after another. Check what they need and what they print."""

from __future__ import annotations

import contextlib
import io
import sys
from collections.abc import Callable, Mapping
from importlib import import_module
from pathlib import Path
from unittest import mock

from unitylink.cli import COMMANDS, main, module_of

SPEC = """
public plain() {
   @position = 0x12: i32 READ(UNIT="mm", PUBLISH(1, 10));
   @target = 0x1A: i32 WRITE(UNIT="mm");
   @other = 0x13: u16 READ();
}
"""
LINE_TYPED = "#RLC\n"

Url = Callable[[], str]  # returns a URL for the next command, because some URLs can be opened only once


def commands_with_a_link() -> set[str]:
    """Return the commands that take a LINK as an argument."""
    found = set()
    for name in COMMANDS:
        command = import_module(module_of(name)).command
        if any("LINK" in (parameter.metavar or "") for parameter in command.params):
            found.add(name)
    return found - {
        "serve",
        "dashboard",
        "tui",
    }  # they do not end by themselves; test_every_scheme.py starts a server, test_tui.py a terminal


def converse(
    url: Url,
    spec: Path,
    folder: Path,
    *,
    own_spec: bool = False,
    refused: Mapping[str, str] | None = None,
    items: tuple[str, str, str] = ("position", "target", "0x13"),
) -> dict[str, str]:
    """Run every command on a link, and return the output of each.

    Raises AssertionError if a command could not do its work.

    `own_spec` means that the link brings its spec, as `sim:` does. `refused` names the commands that such a
    link cannot serve, each with a part of its message. `items` are an item that is published, an item that is
    written, and a bare address.
    """
    measured, written, bare = items
    given = [] if own_spec else ["--spec", str(spec)]
    sampled = [measured, *given, "--duration", "0.3", "--out"]
    lines: dict[str, Callable[[str], list[str]]] = {
        "info": lambda link: [link, *given],
        "list": lambda link: [link, *given],
        "write": lambda link: [link, f"{written}=-7", *given],
        "read": lambda link: [link, written, bare, *given],
        "watch": lambda link: [link, measured, *given, "--count", "2"],
        "record": lambda link: [link, *sampled, str(folder / "recorded.csv")],
        "plot": lambda link: [link, *sampled, str(folder / "plotted.svg")],
        "bridge": lambda link: ["ros2", link, *([] if own_spec else [str(spec)])],
        "term": lambda link: [link, *given],
        "doctor": lambda link: [link, *given],
    }
    assert set(lines) == commands_with_a_link(), "a command that takes a LINK is tried on each"
    said = {}
    for name, words in lines.items():
        code, said[name] = run(name, *words(url()))
        expected = (refused or {}).get(name)
        # a busy machine loses some samples, and the command reports this
        if name == "record" and "samples in" in said[name]:
            code = 0
        assert (code == 0) == (expected is None), f"{name} ended with {code}: {said[name]}"
        assert expected is None or expected in said[name], said[name]
    return said


def run(*words: str) -> tuple[int, str]:
    """Run a command in this process. Return its exit code and its output."""
    told = io.StringIO()
    with (
        _bridge_that_ends(),
        contextlib.redirect_stdout(told),
        contextlib.redirect_stderr(told),
        mock.patch.object(sys, "stdin", io.StringIO(LINE_TYPED)),
    ):
        return main(words), told.getvalue()


def _bridge_that_ends() -> contextlib.AbstractContextManager[object]:
    """Let `bridge` make the robot on its link, and then end. Tests with ROS cover what it does after that."""

    def run_alone(_: object, build: Callable, connect: Callable, parameters: object, **__: object) -> int:
        with connect(parameters.link) as link:  # type: ignore[attr-defined]
            print(f"the robot has {len(list(build(link)))} values")
        return 0

    return mock.patch("unitylink.ros.ros2.run_alone", run_alone)
