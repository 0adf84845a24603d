# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink explain`: the meaning of the codes of diagnostics and of the doctor's findings."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

import click

from .failure import Failure
from .output import colours, json_option, plain_table, print_json

if TYPE_CHECKING:
    from unitylink.ports.findings import Finding


@click.command()
@click.argument("codes", metavar="[CODE]...", nargs=-1)
@json_option("the explanations")
def command(codes: tuple[str, ...], as_json: bool) -> None:
    """Explain the codes of `check` and `doctor`.

    For a diagnostic it says why this is a mistake, with a wrong and a mended example. For a finding of the
    doctor it gives the cause. Without a CODE all codes are listed.

    \b
    Examples:
      unitylink explain UL013
      unitylink explain no-port
      unitylink explain
    """
    from dataclasses import asdict

    from unitylink.ports.findings import FINDINGS, example
    from unitylink.spec import CODES
    from unitylink.spec.report.explain import explain
    from unitylink.spec.report.suggest import nearest

    known = {code.upper(): code for code in (*CODES, *FINDINGS)}
    for code in codes:
        if code.upper() not in known:
            near = nearest(code.upper(), known)
            help_line = f"did you mean {known[near]}? " if near else ""
            raise Failure(f"there is no code {code!r}", help_line + "`unitylink explain` lists all")
    wanted = [known[code.upper()] for code in codes]
    if as_json:
        every = wanted or known.values()
        findings = {
            code: {**asdict(shown), "more": more} for code in FINDINGS for shown, more in [example(code)]
        }
        print_json([asdict(explain(c)) if c in CODES else findings[c] for c in every])
        return
    if not wanted:
        rows = [(code, kind.severity, kind.title) for code, kind in CODES.items()]
        rows += [(code, kind.severity, kind.title) for code, kind in FINDINGS.items()]
        click.echo("\n".join(plain_table(("code", "severity", "title"), rows)))
        return
    bold, off = ("\x1b[1m", "\x1b[0m") if colours(sys.stdout) else ("", "")
    parts = []
    for code in wanted:
        if code in FINDINGS:
            parts.append(_finding(*example(code), bold, off))
            continue
        one = explain(code)
        part = f"{bold}{one.code}, {one.severity}: {one.title}{off}\n\n{one.text}\n"
        if one.wrong:
            part += f"\n{bold}Wrong:{off}\n\n{_indented(one.marked)}"
            part += f"\n{bold}Right:{off}\n\n{_indented(one.mended)}"
        parts.append(part)
    click.echo("\n".join(parts), nl=False)


def _finding(shown: Finding, more: str, bold: str, off: str) -> str:
    title = f"{bold}{shown.code}, {shown.severity}: {shown.title}{off}"
    behind = f"\n{more}\n" if more else ""
    return f"{title}\n\nFor example: {shown.cause}\n\n    {shown.remedy}\n{behind}"


def _indented(text: str) -> str:
    return "".join(f"    {line}" for line in text.splitlines(keepends=True))
