# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink fmt`: specs in their canonical layout."""

from __future__ import annotations

import sys
from contextlib import nullcontext
from pathlib import Path

import click

from unitylink.errors import SpecError
from unitylink.output_file import replace_file


@click.command()
@click.argument("specs", metavar="SPEC...", nargs=-1, required=True)
@click.option(
    "--check", is_flag=True, help="Change nothing; exit with 1 if a file is not in its canonical layout."
)
@click.option("--stdout", is_flag=True, help="Print the result and leave the files alone.")
def command(specs: tuple[str, ...], check: bool, stdout: bool) -> int:
    """Lay specs out in the canonical way. Comments stay, and the meaning does not change.

    SPEC is a file, or - to read standard input and print the result.

    \b
    Examples:
      unitylink fmt arm.ul
      unitylink fmt --check arms/*.ul
      unitylink fmt - < arm.ul
    """
    if check and stdout:
        raise click.UsageError("--check and --stdout exclude each other")
    differing = 0
    failures: list[str] = []  # collected, so that a wrong file does not stop the others
    for spec in specs:
        try:
            text, formatted = _formatted(spec)
        except SpecError as error:
            failures.append(str(error).rstrip())
            continue
        except OSError as error:
            failures.append(f"error: {spec}: {error.strerror}")
            continue
        if check:
            if formatted != text:
                differing += 1
                click.echo(
                    f"{spec}: not in its canonical layout; `unitylink fmt {spec}` sets it right", err=True
                )
        elif stdout or spec == "-":
            sys.stdout.buffer.write(formatted.encode())
        elif formatted != text:
            replace_file(Path(spec), formatted)
            click.echo(f"{spec}: laid out anew")
        else:
            click.echo(f"{spec}: already in its canonical layout")
    if failures:
        raise SpecError("\n\n".join(failures))
    return int(differing > 0)


def _formatted(spec: str) -> tuple[str, str]:
    """Return (text, formatted text) of a file. Raises SpecError if the text is not a spec."""
    from unitylink.spec import compile_text, format_text, render
    from unitylink.spec.source import MAX_BYTES

    name = "<stdin>" if spec == "-" else spec
    with open(spec, "rb") if spec != "-" else nullcontext(sys.stdin.buffer) as file:
        data = file.read(MAX_BYTES + 1)
    try:
        text = data.decode()
    except UnicodeDecodeError:
        text = ""
    if len(data) > MAX_BYTES or (data and not text):
        # The compiler's diagnostic has the mistake and its place.
        diagnostics = compile_text(data, name).diagnostics
        raise SpecError(render(diagnostics), diagnostics)
    return text, format_text(text, name)
