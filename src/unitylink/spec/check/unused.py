# SPDX-License-Identifier: BSD-3-Clause
"""Report parts of a spec that have no effect. The spec has no errors."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence

from ..meaning.scope import Scope, Scopes
from ..model import Instance
from ..report.diagnostics import Reporter
from ..text.lexer import Tokens
from ..text.syntax import ConstantNode, LinkNode, Name


def check_notes(tokens: Tokens, reporter: Reporter) -> None:
    """Report `///` comments that are beside no declaration. The parser has already taken the others."""
    for start, end in tokens.comments if tokens.documentation or tokens.trailing else ():
        if reporter.sources.first.text.startswith("///", start):
            after = bisect_right(tokens.starts, start)
            if after in tokens.documentation or after - 1 in tokens.trailing:
                message = "this documents nothing"
                hint = "put `///` before a declaration, or after it on the same line; other comments are `//`"
                reporter.report("UL075", start, end, message, hint)


def check_unused(scopes: Scopes, roots: Sequence[Instance], own: int, reporter: Reporter) -> None:
    """Report parts without effect.

    Call it only for a spec without errors. In such a spec, nothing is unused by accident.

    Only the first `own` constructors belong to the main file. An imported file need not be used as a whole.
    """
    for root in roots:
        _check_groups(root, reporter)
    _check_declarations(scopes, reporter)
    expanded = {e.callee.text for scope in scopes.all for e in scope.expansions}
    for scope in scopes.all[:own]:
        name = scope.node.name
        if not scope.node.public and name.text not in expanded:
            message = f"constructor `{name.text}` is never expanded"
            reporter.report(
                "UL070", name.start, name.end, message, "make it `public`, expand it, or remove it"
            )
            continue
        _check_parameters(scope, reporter)
        for address in scope.node.addresses:
            if address.text not in scope.used_addresses and address.text[0] != "_":
                _report_unused(reporter, "UL072", "address", address)


def _check_declarations(scopes: Scopes, reporter: Reporter) -> None:
    declared = scopes.declared
    last = len(reporter.sources.first.text)
    for node in declared.nodes:
        name = node.name
        if isinstance(node, LinkNode) or name.text in declared.used or name.text[0] == "_" or name.end > last:
            continue
        what = "constant" if isinstance(node, ConstantNode) else "type"
        _report_unused(reporter, "UL076", what, name)


def _check_groups(instance: Instance, reporter: Reporter) -> None:
    for group in instance.groups:
        if not group.elements:
            message = f"group `{group.path}` has no elements"
            hint = "what its paths lead to is empty: remove it, or list elements"
            reporter.report("UL074", group.span.start, group.span.end, message, hint)
    for inner in instance.instances:
        _check_groups(inner, reporter)


def _check_parameters(scope: Scope, reporter: Reporter) -> None:
    for parameter in scope.node.parameters:
        if parameter.text not in scope.used_parameters:
            if parameter.text[0] != "_":
                _report_unused(reporter, "UL071", "parameter", parameter)
        elif scope.node.public and parameter.text not in scope.runtime and parameter.default is None:
            message = (
                f"nothing gives public constructor `{scope.node.name.text}` its string `{parameter.text}`"
            )
            hint = f'its value is its own name, "{parameter.text}"; write the text itself instead'
            reporter.report("UL073", parameter.start, parameter.end, message, hint)


def _report_unused(reporter: Reporter, code: str, what: str, name: Name) -> None:
    message = f"{what} `{name.text}` is never used"
    reporter.report(
        code, name.start, name.end, message, f"remove it, or call it `_{name.text}` if it is meant so"
    )
