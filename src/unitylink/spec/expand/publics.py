# SPDX-License-Identifier: BSD-3-Clause
"""Which public constructors can be expanded, and what is wrong with the others."""

from __future__ import annotations

from ..meaning.graph import MAX_DEPTH, MAX_ITEMS, Size
from ..meaning.scope import Scope
from ..report.diagnostics import Reporter
from ..text.syntax import Name, Program


def report_no_public(program: Program, reporter: Reporter) -> None:
    """Report a spec that has no interface."""
    if program.constructors:
        at = program.constructors[0].name
        hint = f"write `public {at.text}(…)` for the one that is the interface"
        reporter.report("UL029", at.start, at.end, "there is no public constructor", hint)
    else:
        hint = "a spec has at least one: `public robot(ctrl,comm) { … }`"
        reporter.report("UL029", 0, 0, "there is no public constructor", hint)


def may_expand(scope: Scope, size: Size, items: int, reporter: Reporter) -> bool:
    """Can a public constructor be expanded? `items` are those of all until now, with its own."""
    at = scope.node.name
    if scope.addresses:
        message = f"public constructor `{at.text}` takes addresses, but nothing binds them"
        hint = "remove `public`, or fix each address: `@name = 0x…: …`"
        reporter.report("UL036", at.start, at.end, message, hint)
    elif items > MAX_ITEMS:
        report_too_many(at, f"{items:,}" if items < 10**9 else "more than a billion", reporter)
    elif size.depth > MAX_DEPTH:
        message = f"the expansion of `{at.text}` is {size.depth:,} constructors deep"
        reporter.report("UL039", at.start, at.end, message, f"at most {MAX_DEPTH} are allowed")
    else:
        return True
    return False


def report_too_many(at: Name, shown: str, reporter: Reporter) -> None:
    """Report an expansion that is too large."""
    message = f"with `{at.text}` the spec expands to {shown} instances, elements and group members"
    reporter.report("UL038", at.start, at.end, message, f"at most {MAX_ITEMS:,} are allowed")
