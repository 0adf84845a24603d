# SPDX-License-Identifier: BSD-3-Clause
"""What readers of mutated inputs share: a spec, a command in this process, the allowed errors."""

import io
import os
from contextlib import redirect_stderr, redirect_stdout
from functools import cache
from pathlib import Path

from unitylink.cli import main
from unitylink.commands.names import Names
from unitylink.simulate import BoardComponents
from unitylink.spec import Spec, load

ROOT = Path(__file__).resolve().parents[3]
TYPED = ROOT / "tests" / "unit" / "generate" / "typed.ul"


@cache
def typed() -> Spec:
    return load(TYPED)


@cache
def elements() -> Names:
    return Names(typed())


class Registers(dict[int, int]):
    """The part of a board's registers that a plant uses."""

    data_bits = 32
    components = BoardComponents(None, ())  # type: ignore[arg-type]  # without any


def command(words: list[str], folder: Path) -> None:
    """Run a command in this process.

    An exception that leaves `main` would be a traceback, and so is a printed one.
    """
    before = Path.cwd()
    os.chdir(folder)
    out, err = io.StringIO(), io.StringIO()
    try:
        with redirect_stdout(out), redirect_stderr(err):
            main(words)
    finally:
        os.chdir(before)
    assert "Traceback" not in err.getvalue(), err.getvalue()


class allowed:
    """The errors that a wrong input may raise: an error of ours, or a usage error of a command."""

    def __init__(self, *more: type[Exception]) -> None:
        import click

        from unitylink.errors import UnityLinkError

        self.kinds = (UnityLinkError, click.ClickException, *more)

    def __enter__(self) -> None: ...

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, _: object) -> bool:
        return isinstance(error, self.kinds)
