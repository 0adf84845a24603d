# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink write`: values, once."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from .failure import Failure
from .link_option import Target, link_argument, open_target, spec_option
from .names import Item, Names, parse_number
from .output import json_option, print_json

if TYPE_CHECKING:
    from collections.abc import Sequence


@click.command()
@link_argument
@click.argument("assignments", metavar="NAME=VALUE...", nargs=-1, required=True)
@spec_option
@json_option("what was written")
def command(link: str, assignments: tuple[str, ...], spec_file: str | None, as_json: bool) -> None:
    """Write items; several in one go take effect together where the hardware can do that.

    NAME is a WRITE item of the spec, a group or pattern of them (all get VALUE), or a word address such as
    0x8C, which is written after the named ones, as a raw unsigned word and without a commit. VALUE is an
    integer: 30, -30, 0x1E. Every value is checked against its item's range before anything is sent.

    \b
    Examples:
      unitylink write sim:scara.ul j1.pos_sp=-30
      unitylink write tcp://127.0.0.1:5555 --spec scara.ul j1.pos_sp=30 j2.pos_sp=60 'j*.spd_sp=1000'
      unitylink write serial:/dev/ttyUSB0 0x8C=100
    """
    parsed = [_split(assignment) for assignment in assignments]
    with open_target(link, spec_file) as target:
        wanted = _resolve(target.names, parsed)
        _write(target, wanted)
    if as_json:
        print_json([{"name": item.name, "address": item.address, "value": value} for item, value in wanted])
    else:
        for item, value in wanted:
            click.echo(f"{item.name} = {value} {item.unit}".rstrip())


def _split(assignment: str) -> tuple[str, int]:
    name, equals, value = assignment.partition("=")
    if not equals or not name:
        raise click.UsageError(f"'{assignment}' is no NAME=VALUE; write for example j1.pos_sp=30")
    return name, parse_number(value, name)


def _resolve(names: Names, parsed: Sequence[tuple[str, int]]) -> list[tuple[Item, int]]:
    """Return (item, value) in the order typed; refuse READ items and an item that is given twice."""
    wanted: dict[str, tuple[Item, int]] = {}
    for word, value in parsed:
        for item in names.find([word]):
            if item.element is not None and item.element.access != "WRITE":
                raise Failure(
                    f"{item.name} is a {item.element.access} item: the gateware writes it, the PC reads it",
                    f"`unitylink list --spec {names.source}` shows what can be written",
                )
            if item.name in wanted:
                raise click.UsageError(f"{item.name} is given two values; give it one")
            wanted[item.name] = (item, value)
    return list(wanted.values())


def _write(target: Target, wanted: Sequence[tuple[Item, int]]) -> None:
    from unitylink.errors import ValueRangeError
    from unitylink.layer4_data import ValueGroup, load_spec_objects

    from .readable import check_bare

    named = {item.name: value for item, value in wanted if item.element is not None}
    bare = {item: value for item, value in wanted if item.element is None}
    configuration = target.link.configuration
    check_bare(target.link, list(bare))
    for item, value in bare.items():
        if not 0 <= value < 1 << configuration.data_bits:
            limit = (1 << configuration.data_bits) - 1
            raise ValueRangeError(f"{item.name}: {value} is not in 0 to {limit}; nothing was sent")
    if named and target.spec is not None:
        # The whole tree: a TosNet proxy has to know all outputs of the spec to commit some of them.
        tree = load_spec_objects(target.spec, target.link)
        ValueGroup({v.path: v for v in tree if v.path in named}, "write").write(named)
    if bare:
        target.link.write_many([item.address for item in bare], list(bare.values()))
