# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink diff`: two specs compared by meaning."""

from __future__ import annotations

import click

from .output import json_option, print_json, print_table


@click.command()
@click.argument("old", metavar="OLD")
@click.argument("new", metavar="NEW")
@click.option("--strict", is_flag=True, help="Exit with 1 for any difference, not only for a breaking one.")
@json_option("the differences")
def command(old: str, new: str, strict: bool, as_json: bool) -> int:
    """Compare two specs by meaning: what was added, removed, renamed, moved or changed, and what breaks.

    The exit code is 0 if programs made from OLD and gateware made from NEW understand each other, else 1.
    Layout, comments and the order of items with an address make no difference.

    \b
    Examples:
      unitylink diff arm-v1.ul arm.ul
      unitylink diff arm-v1.ul arm.ul --json
    """
    from unitylink.spec import load
    from unitylink.spec.report.diff import compare

    before, after = load(old), load(new)
    changes = compare(before, after)
    breaking = sum(not change.compatible for change in changes)
    if as_json:
        sides = {
            name: {"file": file, "spec": spec.name, "hash": spec.hash}
            for name, file, spec in (("old", old, before), ("new", new, after))
        }
        print_json({**sides, "compatible": not breaking, "changes": [change.to_json() for change in changes]})
        return int(bool(changes) if strict else bool(breaking))
    if changes:
        rows = [
            (
                change.kind,
                "" if change.compatible else "breaks",
                change.path,
                change.what,
                " -> ".join(shown for shown in (change.before, change.after) if shown)
                if change.kind in ("added", "removed")
                else f"{change.before or 'none'} -> {change.after or 'none'}",
            )
            for change in changes
        ]
        print_table(("change", "", "item", "what", "old -> new"), rows)
        number = f"{len(changes):,} difference{'' if len(changes) == 1 else 's'}"
        says = f"{breaking:,} of them break" if breaking else "wire-compatible"
        click.echo(f"{number}, {says}; hash {before.hash} -> {after.hash}")
    else:
        same = "equal hashes" if before.hash == after.hash else f"hash {before.hash} -> {after.hash}"
        click.echo(f"no difference in meaning; {same}")
    return int(bool(changes) if strict else bool(breaking))
