# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink new`: a project to start from."""

from __future__ import annotations

import re
from importlib.util import find_spec
from pathlib import Path

import click

from unitylink.optional import installation

from .failure import Failure
from .new_full import PROGRAMS, full_files
from .template_names import check_names

_TEMPLATES = Path(__file__).parent / "templates"
_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*")


@click.command()
@click.argument("name")
@click.option("--dir", "folder", metavar="FOLDER", help="Where to write; the default is a new folder NAME.")
@click.option("--full", is_flag=True, help="A repository: with VHDL, a board, ROS 2, tests on the VHDL, CI.")
def command(name: str, folder: str | None, *, full: bool) -> None:
    """Start a project: a spec, its generated classes, a script that moves it, a test, a README.

    With --full it is a repository of its own, whose tests pass from the first push on: it also has a
    component in VHDL with its bench, a plant, a board, a package for ROS 2, a page, and the files of
    continuous integration.

    Nothing that exists is overwritten.

    \b
    Examples:
      unitylink new arm
      unitylink new arm --dir robots/arm
      unitylink new arm --full
    """
    target = Path(folder if folder is not None else name)
    files, programs = (_full(name, target), PROGRAMS) if full else (_files(name), frozenset())
    taken = [file for file in files if (target / file).exists()]
    if taken:
        raise _taken(target / taken[0])
    for file, text in files.items():
        path = target / file
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            with open(path, "x", encoding="utf-8") as handle:
                handle.write(text)
            if file in programs:
                path.chmod(path.stat().st_mode | 0o111)
        except OSError as error:
            raise Failure(
                f"{path}: {error.strerror or error}", "name a folder that can be written to: --dir FOLDER"
            ) from None
        click.echo(f"wrote {path}")
    click.echo(f"\nNow: cd {target} && python run.py\nand: {'.ci/run' if full else 'python -m pytest'}")
    if find_spec("pytest") is None:
        click.echo(f"first, for the tests: {installation('pytest')}")


def _taken(path: Path) -> Failure:
    return Failure(
        f"{path} exists and is not overwritten", "give another folder: --dir FOLDER, or another NAME"
    )


def _full(name: str, target: Path) -> dict[str, str]:
    """Return the files of a repository. It gets a folder of its own, or one that is empty."""
    _check_name(name)
    if target.exists() and (not target.is_dir() or any(target.iterdir())):
        raise _taken(target)
    return full_files(name)


def _files(name: str) -> dict[str, str]:
    """Return {file name: text} of the project. A wrong `name` is a usage error."""
    from unitylink.generate import generate_python
    from unitylink.spec import compile_text

    _check_name(name)
    spec_text = _template("project.ul").replace("NAME", name)
    result = compile_text(spec_text, f"{name}.ul")
    if result.spec is None or result.diagnostics:
        raise click.UsageError(f"'{name}' means something else in a spec; did you mean {name}_robot?")
    generated = generate_python(result.spec)
    classes = re.findall(r"^class (\w+)\(", generated[f"{name}.py"], re.M)  # the public class comes first
    check_names(name, classes[0], _TEMPLATES.glob("*.py.txt"))

    def filled(template: str) -> str:
        return _template(template).replace("NAME", name).replace("CLASS", classes[0])

    return {
        f"{name}.ul": spec_text,
        **generated,
        "run.py": filled("run.py.txt"),
        f"test_{name}.py": filled("test.py.txt"),
        "README.md": filled("README.md.txt"),
    }


def _template(file: str) -> str:
    return (_TEMPLATES / file).read_text(encoding="utf-8")


def _check_name(name: str) -> None:
    from unitylink.generate.python.modules import module_name

    if not _NAME.fullmatch(name):
        meant = re.sub(r"\W+", "_", name, flags=re.ASCII).strip("_")
        hint = f"; did you mean {meant}?" if _NAME.fullmatch(meant) else ""
        raise click.UsageError(
            f"'{name}' is not a valid name: use letters, digits and _, and begin with a letter{hint}"
        )
    if module_name(name) != name or name == "run":
        raise click.UsageError(f"'{name}' means something else in Python; did you mean {name}_robot?")
