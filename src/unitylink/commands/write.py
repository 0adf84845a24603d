# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink write`: values, once."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from unitylink.values import plain

from .failure import Failure
from .link_option import Target, link_argument, open_target, spec_option
from .names import Item, Names
from .output import json_option, print_json
from .value_text import parse_value, shown

if TYPE_CHECKING:
    from collections.abc import Sequence


@click.command()
@link_argument
@click.argument("assignments", metavar="NAME=VALUE...", nargs=-1, required=True)
@spec_option
@json_option("what was written")
def command(link: str, assignments: tuple[str, ...], spec_file: str | None, as_json: bool) -> None:
    """Write items. Several writes in one go take effect together if the hardware can do that.

    NAME is a WRITE item of the spec, a group or pattern of such items (all get VALUE), or a word address such
    as 0x8C. An address is written after the named items, as a raw unsigned word and without a commit.

    VALUE is in the unit of the spec, or in another unit of the same quantity: 30, -0.5, 0x1E, 30deg. It can
    also be the name of an enumeration's member, true or false, or {ready=1, mode=run} for packed values. A
    PULSE is written once, a W1C clears the given flags. Every value is checked against its item's range
    before anything is sent.

    \b
    Examples:
      unitylink write sim:arm.ul x.target=-30
      unitylink write tcp://127.0.0.1:5555 --spec arm.ul x.target=30 y.target=60 '*.speed_limit=1000'
      unitylink write serial:/dev/ttyUSB0 0x8C=100
    """
    parsed = [_split(assignment) for assignment in assignments]
    with open_target(link, spec_file) as target:
        wanted = _resolve(target.names, parsed)
        sent = _write(target, wanted)
    wanted = [(item, sent.get(item.name, value)) for item, value in wanted]
    if as_json:
        print_json(
            [{"name": i.name, "address": i.address, "value": plain(value, i.quantity)} for i, value in wanted]
        )
    else:
        for item, value in wanted:
            click.echo(f"{item.name} = {shown(value, item.quantity)} {item.unit}".rstrip())


def _split(assignment: str) -> tuple[str, str]:
    name, equals, value = assignment.partition("=")
    if not equals or not name:
        raise click.UsageError(f"'{assignment}' is not NAME=VALUE; write for example x.target=30")
    return name, value


def _resolve(names: Names, parsed: Sequence[tuple[str, str]]) -> list[tuple[Item, Any]]:
    """Return (item, value) in the order of the command line.

    Refuse READ items, and an item that is given twice.
    """
    wanted: dict[str, tuple[Item, Any]] = {}
    for word, text in parsed:
        for item in names.find([word]):
            if item.element is not None and not item.element.writable:
                raise Failure(
                    f"{item.name} is a {item.element.access} item: the gateware writes it, the PC reads it",
                    f"`unitylink list --spec {names.source}` shows what can be written",
                )
            if item.name in wanted:
                raise click.UsageError(f"{item.name} is given two values; give it one")
            wanted[item.name] = (item, parse_value(text, item))
    return list(wanted.values())


def _write(target: Target, wanted: Sequence[tuple[Item, Any]]) -> dict[str, Any]:
    """Write the values.

    Return, by name, the values that the device has now. They are the nearest that its words can hold.
    """
    from unitylink.errors import ValueRangeError
    from unitylink.layer4_data import ClearValue, PulseValue, ValueGroup, load_spec_objects

    from .item_values import check_bare

    named = {item.name: value for item, value in wanted if item.element is not None}
    bare = {item: value for item, value in wanted if item.element is None}
    sent: dict[str, Any] = {}
    configuration = target.link.configuration
    check_bare(target.link, list(bare))
    for item, value in bare.items():
        if not 0 <= value < 1 << configuration.data_bits:
            limit = (1 << configuration.data_bits) - 1
            raise ValueRangeError(f"{item.name}: {value} is not in 0 to {limit}; nothing was sent")
    if named and target.spec is not None:
        # The whole tree, because a TosNet proxy must know all outputs of the spec to commit some of them.
        tree = load_spec_objects(target.spec, target.link)
        values = {value.path: value for value in tree if value.path in named}
        for path, value in values.items():
            # all are encoded before anything is sent
            sent[path] = value.codec.decode(value.codec.encode(named[path]))
        kept = {path: value for path, value in values.items() if value.writable}
        if kept:
            ValueGroup(kept, "write").write({path: named[path] for path in kept})
        for path, value in values.items():
            if isinstance(value, PulseValue):
                value.pulse(named[path])
            elif isinstance(value, ClearValue):
                value.clear(named[path])
    if bare:
        target.link.write_many([item.address for item in bare], list(bare.values()))
    return sent
