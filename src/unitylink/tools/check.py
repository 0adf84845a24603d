# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink check`: the diagnostics of specs."""

from __future__ import annotations

import sys

import click

from .output import colours, json_option, print_json


@click.command()
@click.argument("specs", metavar="SPEC...", nargs=-1, required=True)
@json_option("the diagnostics")
def command(specs: tuple[str, ...], as_json: bool) -> int:
    """Check specs and report every mistake with its place and what to do about it.

    SPEC is a file, or - for standard input. The exit code is 0 without errors (warnings are allowed), 1 with
    errors.

    \b
    Examples:
      unitylink check scara.ul
      unitylink check arms/*.ul --json
      cat scara.ul | unitylink check -
    """
    from unitylink.spec import compile_file, compile_text, render
    from unitylink.spec.source import MAX_BYTES

    results = [
        compile_text(sys.stdin.buffer.read(MAX_BYTES + 1), "<stdin>") if spec == "-" else compile_file(spec)
        for spec in specs
    ]
    found = [diagnostic for result in results for diagnostic in result.diagnostics]
    failed = any(diagnostic.severity == "error" for diagnostic in found)
    if as_json:
        print_json({"diagnostics": [diagnostic.to_json() for diagnostic in found]})
    elif found:
        click.echo(render(found, color=colours(sys.stdout)), nl=False)
    else:
        for spec, result in zip(specs, results, strict=True):
            assert result.spec is not None
            items = sum(1 for _ in result.spec.walk())
            publics = ", ".join(root.name for root in result.spec.roots)
            click.echo(f"{spec}: no mistakes; {items:,} item{'' if items == 1 else 's'} in {publics}")
    return int(failed)
