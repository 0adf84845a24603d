# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink explain`: what a diagnostic code means."""

from __future__ import annotations

import sys

import click

from .failure import Failure
from .output import colours, json_option, plain_table, print_json


@click.command()
@click.argument("codes", metavar="[CODE]...", nargs=-1)
@json_option("the explanations")
def command(codes: tuple[str, ...], as_json: bool) -> None:
    """Explain diagnostic codes: why it is a mistake, an example of it, and the example mended.

    Without a CODE all of them are listed.

    \b
    Examples:
      unitylink explain UL013
      unitylink explain
    """
    from dataclasses import asdict

    from unitylink.spec import CODES
    from unitylink.spec.explain import explain
    from unitylink.spec.suggest import nearest

    wanted = [code.upper() for code in codes]
    for code in wanted:
        if code not in CODES:
            near = nearest(code, CODES)
            help_line = f"did you mean {near}? " if near else ""
            raise Failure(f"there is no code {code!r}", help_line + "`unitylink explain` lists all")
    if as_json:
        print_json([asdict(explain(code)) for code in wanted or CODES])
        return
    if not wanted:
        rows = [(code, kind.severity, kind.title) for code, kind in CODES.items()]
        click.echo("\n".join(plain_table(("code", "severity", "title"), rows)))
        return
    bold, off = ("\x1b[1m", "\x1b[0m") if colours(sys.stdout) else ("", "")
    parts = []
    for code in wanted:
        one = explain(code)
        part = f"{bold}{one.code}, {one.severity}: {one.title}{off}\n\n{one.text}\n"
        if one.wrong:
            part += f"\n{bold}Wrong:{off}\n\n{_indented(one.marked)}"
            part += f"\n{bold}Right:{off}\n\n{_indented(one.mended)}"
        parts.append(part)
    click.echo("\n".join(parts), nl=False)


def _indented(text: str) -> str:
    return "".join(f"    {line}" for line in text.splitlines(keepends=True))
