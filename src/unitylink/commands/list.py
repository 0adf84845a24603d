# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink list`: the items of a spec."""

from __future__ import annotations

from typing import Any

import click

from unitylink.protocol import ADDRESS_BITS_MAX
from unitylink.values import format_value

from .failure import Failure
from .link_option import is_link, load_names, open_target, spec_option
from .names import Item
from .output import json_option, print_json, print_table

_BASE_HZ = 1000  # the base publish frequency of the first published gateware; a device tells its own
_BY = {1: "hardware", 2: "software"}


@click.command()
@click.argument("words", metavar="[LINK] [NAME...]", nargs=-1)
@spec_option
@json_option("the items")
def command(words: tuple[str, ...], spec_file: str | None, as_json: bool) -> None:
    """List the items of a spec: name, address, access, type, how it publishes.

    With a LINK, the device is asked, too. Then the publish rates are those of the device, and items that it
    cannot reach are marked. NAME is a name, an instance, a group or a pattern.

    \b
    Examples:
      unitylink list --spec arm.ul
      unitylink list sim:arm.ul '*.position'
      unitylink list tcp://127.0.0.1:5555 --spec arm.ul --json
    """
    link, patterns = (words[0], words[1:]) if words and is_link(words[0]) else (None, words)
    if link is None and spec_file is None:
        meant = f"; did you mean --spec {words[0]}?" if words and words[0].endswith(".ul") else ""
        raise click.UsageError(f"give a spec (--spec FILE.ul) or a link that brings one (sim:FILE.ul){meant}")
    names = load_names(link, spec_file)
    spec = names.spec
    if spec is None:
        raise Failure(f"{link} has no names of its own", "add --spec FILE.ul")
    base_hz, address_bits = _BASE_HZ, ADDRESS_BITS_MAX
    if link is not None:
        with open_target(link, spec_file) as target:
            names, configuration = target.names, target.link.configuration
            base_hz, address_bits = configuration.base_hz, configuration.address_bits
    items = names.find(patterns) if patterns else names.all()
    entries = [entry(item, base_hz, address_bits) for item in items]
    if as_json:
        listed = {item.name for item in items}
        groups = [
            {"name": name, "items": items} for name, items in names.groups.items() if listed.issuperset(items)
        ]
        told = {"spec": spec.name, "file": names.source, "hash": spec.hash}
        print_json({**told, "items": entries, "groups": groups})
        return
    columns = list(
        zip(
            ("name", "address", "access", "type", "publish", "unit", "limits", "id"),
            *map(_row, entries),
            strict=True,
        )
    )
    used = [column for column in columns if any(column[1:])]
    headers, *rows = zip(*used, strict=True)
    print_table(headers, rows)
    if not patterns:
        for name, members in names.groups.items():
            click.echo(f"group {name}: {', '.join(members)}")


def entry(item: Item, base_hz: int, address_bits: int) -> dict[str, Any]:
    """Return the JSON of an item of the spec."""
    element = item.element
    assert element is not None
    publish = element.publish
    return {
        "name": item.name,
        "address": element.address,
        "access": element.access,
        "type": element.type.text,
        "publish": None
        if publish is None
        else {
            "by": _BY.get(publish.mode, f"mode {publish.mode}"),
            "divisor": publish.divisor,
            "rate_hz": base_hz / publish.divisor if publish.divisor else None,
            "on": None if publish.trigger == "rate" else publish.event or publish.trigger,
            "group": publish.group,
        },
        "unit": element.unit,
        "words": element.words,
        "minimum": element.minimum,
        "maximum": element.maximum,
        "initial": element.initial,
        "safe": element.safe,
        "id": element.display,
        "checked": element.checked,
        "link": element.link.kind,
        "reachable": element.address >> address_bits == 0,
        "documentation": element.documentation,
    }


def _row(e: dict[str, Any]) -> tuple[str, ...]:
    publish = _published(e["publish"]) if e["publish"] else ""
    if not e["reachable"]:
        publish = "beyond the address bus of the device"
    shown_id = e["id"] if e["id"] != e["name"] else ""
    low, high = (format_value(e[end]) if e[end] is not None else "" for end in ("minimum", "maximum"))
    limits = f"{low} to {high}" if low and high else f">= {low}" if low else f"<= {high}" if high else ""
    return e["name"], f"0x{e['address']:04X}", e["access"], e["type"], publish, e["unit"], limits, shown_id


def _published(publish: dict[str, Any]) -> str:
    when = f"on {publish['on']}" if publish["on"] else f"{publish['rate_hz']:g} Hz"
    return f"{when}, {publish['by']}" + (f", {publish['group']}" if publish["group"] else "")
