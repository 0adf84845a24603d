# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink check`: the diagnostics of specs, and their fixes."""

from __future__ import annotations

import sys
from difflib import unified_diff
from pathlib import Path
from typing import TYPE_CHECKING

import click

from .output import colours, json_option, print_json

if TYPE_CHECKING:
    from unitylink.spec import Result


@click.command()
@click.argument("specs", metavar="SPEC...", nargs=-1, required=True)
@json_option("the diagnostics")
@click.option("--sarif", "as_sarif", is_flag=True, help="Print the diagnostics as SARIF 2.1.0.")
@click.option("--fix", is_flag=True, help="Make the fixes that diagnostics offer, and show them.")
@click.option("--diff", is_flag=True, help="Show what --fix would change, and change nothing.")
def command(specs: tuple[str, ...], as_json: bool, as_sarif: bool, fix: bool, diff: bool) -> int:
    """Check specs. Report every mistake with its place and remedy.

    SPEC is a file, or - for standard input. The exit code is 0 without errors (warnings are allowed), 1 with
    errors. A fix is made only if fewer mistakes are left after it. The report is about the remaining ones.

    \b
    Examples:
      unitylink check arm.ul
      unitylink check --diff arm.ul
      unitylink check --fix arm.ul
      unitylink check arms/*.ul --json
      cat arm.ul | unitylink check -
    """
    from unitylink.spec import render

    if as_json and as_sarif:
        raise click.UsageError("--json and --sarif exclude each other")
    if fix and "-" in specs:
        raise click.UsageError("--fix writes into a file, and - is not a file; --diff shows the fixes")
    quiet = as_json or as_sarif
    results = [_fixed(spec, fix, quiet) if fix or diff else _compiled(spec) for spec in specs]
    found = [diagnostic for result in results for diagnostic in result.diagnostics]
    failed = any(diagnostic.severity == "error" for diagnostic in found)
    if as_json:
        print_json({"diagnostics": [diagnostic.to_json() for diagnostic in found]})
    elif as_sarif:
        from .sarif import sarif

        print_json(sarif(found))
    elif found:
        click.echo(render(found, color=colours(sys.stdout)), nl=False)
    else:
        for spec, result in zip(specs, results, strict=True):
            assert result.spec is not None
            items = sum(1 for _ in result.spec.walk())
            publics = ", ".join(root.name for root in result.spec.roots)
            click.echo(f"{spec}: no mistakes; {items:,} item{'' if items == 1 else 's'} in {publics}")
    return int(failed)


def _compiled(spec: str) -> Result:
    from unitylink.spec import compile_file, compile_text
    from unitylink.spec.source import MAX_BYTES

    if spec == "-":
        return compile_text(sys.stdin.buffer.read(MAX_BYTES + 1), "<stdin>")
    return compile_file(spec)


def _fixed(spec: str, write: bool, quiet: bool) -> Result:
    """Make or show the fixes of one spec. Return the diagnostics that are left."""
    from unitylink.output_file import replace_file
    from unitylink.spec import compile_file, compile_text
    from unitylink.spec.fix import fix_text
    from unitylink.spec.source import MAX_BYTES

    name = "<stdin>" if spec == "-" else spec
    try:
        data = sys.stdin.buffer.read(MAX_BYTES + 1) if spec == "-" else Path(spec).read_bytes()
        text = data.decode()
    except UnicodeDecodeError:
        return compile_text(data, name)  # it is no text, so there is nothing to fix; the compiler reports why
    except (OSError, ValueError):
        return compile_file(spec)
    if len(data) > MAX_BYTES:
        return compile_text(data, name)
    fixed = fix_text(text, name)
    if fixed.made:
        if not quiet:
            _show(name, text, fixed.text)
        if write:
            replace_file(Path(spec), fixed.text)
            fixes = f"{len(fixed.made)} fix{'' if len(fixed.made) == 1 else 'es'}"
            click.echo(f"{spec}: {fixes} made", err=True)
    return fixed.result


def _show(name: str, before: str, after: str) -> None:
    lines = unified_diff(before.splitlines(), after.splitlines(), name, f"{name} (fixed)", lineterm="", n=1)
    coloured = colours(sys.stdout)
    for line in lines:
        shown = "".join(c if c.isprintable() or c == "\t" else "\ufffd" for c in line)
        colour = {"+": "\x1b[32m", "-": "\x1b[31m"}.get(line[:1], "") if coloured else ""
        click.echo(f"{colour}{shown}\x1b[0m" if colour else shown)
