# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink read`: values, once."""

from __future__ import annotations

from typing import Any

import click

from unitylink.values import plain

from .failure import Failure
from .link_option import link_argument, open_target, spec_option
from .names import Item
from .output import json_option, print_json, print_table
from .value_text import shown


@click.command()
@link_argument
@click.argument("names", metavar="NAME...", nargs=-1, required=True)
@spec_option
@click.option("--value", "value_only", is_flag=True, help="Print the values only, one a line.")
@click.option("--hex", "as_hex", is_flag=True, help="Print raw words in hexadecimal.")
@json_option("the values")
def command(
    link: str, *, names: tuple[str, ...], spec_file: str | None, value_only: bool, as_hex: bool, as_json: bool
) -> None:
    """Read items and print their values.

    NAME is a name of the spec, an instance or a group (all its items), a pattern, or a word address like
    0x88. Values are in the units of the spec. Items that fit into one message of the device are one
    consistent snapshot. An item that a read changes (READCLEAR) is read only by its full name.

    \b
    Examples:
      unitylink read sim:arm.ul x.position
      unitylink read tcp://127.0.0.1:5555 --spec arm.ul '*.position' --json
      unitylink read "serial:/dev/ttyUSB0?baud=3000000" 0x88 --hex
    """
    from unitylink.layer4_data import ValueGroup

    from .item_values import item_values

    with open_target(link, spec_file) as target:
        items = target.names.find_readable(names)
        if not items:
            raise Failure(
                f"{' '.join(names)}: a read changes the value on the device, so a pattern does not select it",
                "give its full name",
            )
        values = item_values(target.link, items)
        snapshot = ValueGroup(values).snapshot(consistent=len(items) <= target.link.configuration.read_many)
    words = [values[item.name].raw or 0 for item in items]
    texts = [
        f"0x{word:0{-(-values[i.name].codec.width // 4)}X}" if as_hex else shown(snapshot[i.name], i.quantity)
        for i, word in zip(items, words, strict=True)
    ]
    if as_json:
        print_json([_entry(item, snapshot[item.name], word) for item, word in zip(items, words, strict=True)])
    elif value_only:
        click.echo("\n".join(texts))
    elif len(items) == 1:
        click.echo(f"{items[0].name} = {texts[0]} {items[0].unit}".rstrip())
    else:
        units = any(item.unit for item in items)
        rows = [
            (item.name, text, *([item.unit] if units else []))
            for item, text in zip(items, texts, strict=True)
        ]
        print_table(("name", "value", "unit")[: 2 + units], rows, right=[1])


def _entry(item: Item, value: Any, word: int) -> dict[str, object]:
    return {
        "name": item.name,
        "address": item.address,
        "value": plain(value, item.quantity),
        "word": word,
        "unit": item.unit,
    }
