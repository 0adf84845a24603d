# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink decode`: the messages in a capture of a link."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator

import click

from unitylink.capture import CaptureMessage, Packet, PcapngWriter, messages, read_packets
from unitylink.resources import resource_folder

from .link_option import load_names, spec_option
from .names import Names
from .output import colours, force_option, json_option, print_json
from .wire_reader import wire_reader

_KINDS = ("request", "reply", "publish", "error", "damaged")
_ARROWS = {"sent": ">", "received": "<"}
_COLOURS = {"publish": "\x1b[2m", "error": "\x1b[31m", "damaged": "\x1b[31m"}


def _print_dissector(ctx: click.Context, parameter: click.Parameter, wanted: bool) -> None:
    if wanted and not ctx.resilient_parsing:
        click.echo(
            (resource_folder("tools/wireshark") / "unitylink.lua").read_text(encoding="utf-8"), nl=False
        )
        ctx.exit()


@click.command()
@click.argument("capture", metavar="FILE")
@spec_option
@click.option("--only", metavar="KIND[,KIND]", help=f"Only these: {', '.join(_KINDS)}.")
@click.option("--not", "without", metavar="KIND[,KIND]", help="All but these.")
@click.option("--match", metavar="REGEX", help="Only messages with this in their bytes or meaning.")
@click.option("--raw", is_flag=True, help="Print the transfers as they were, not as messages.")
@click.option(
    "--pcapng", metavar="FILE", help="Write the messages to a capture for Wireshark, one in each packet."
)
@force_option
@click.option(
    "--address-bytes",
    type=click.IntRange(1, 4),
    metavar="N",
    help="Bytes of an address, if the capture has no configuration.",
)
@click.option(
    "--data-bytes",
    type=click.IntRange(1, 4),
    metavar="N",
    help="Bytes of a data word, if the capture has no configuration.",
)
@click.option(
    "--dissector",
    is_flag=True,
    is_eager=True,
    expose_value=False,
    callback=_print_dissector,
    help="Print the dissector for Wireshark (Lua), and do nothing else.",
)
@json_option("one object a line")
def command(
    capture: str,
    *,
    spec_file: str | None,
    only: str | None,
    without: str | None,
    match: str | None,
    raw: bool,
    pcapng: str | None,
    force: bool,
    address_bytes: int | None,
    data_bytes: int | None,
    as_json: bool,
) -> None:
    """Print what went over a link: time, direction, bytes and meaning.

    `?trace=FILE` on a link's URL has written FILE. Times are in seconds since its first byte. With --spec,
    words have their names. Wireshark opens the same file, with the dissector that --dissector prints.

    \b
    Examples:
      unitylink read 'tcp://127.0.0.1:5555?trace=arm.pcapng' x.position --spec arm.ul
      unitylink decode arm.pcapng --spec arm.ul
      unitylink decode arm.pcapng --not publish --match x.target
      unitylink decode arm.pcapng --only error,damaged --json
      unitylink decode arm.pcapng --pcapng messages.pcapng
    """
    wanted = _kinds(only, set(_KINDS)) - _kinds(without, set())
    try:
        pattern = re.compile(match) if match else None
    except re.error as error:
        raise click.UsageError(f"--match {match}: {error}") from error
    packets = read_packets(capture)
    if raw:
        found = _transfers(packets)
    else:
        names = load_names(None, spec_file) if spec_file else Names(None)
        found = messages(packets, wire_reader(names, address_bytes=address_bytes, data_bytes=data_bytes))
    chosen = (
        message
        for message in found
        if (raw or message.kind in wanted)
        and (pattern is None or pattern.search(message.text) or pattern.search(message.meaning))
    )
    if pcapng is not None:
        _rewrite(chosen, pcapng, force=force)
    elif not _print(chosen, as_json):
        click.echo(f"note: {capture} has no message to show", err=True)


def _kinds(text: str | None, default: set[str]) -> set[str]:
    if text is None:
        return default
    kinds = set(text.split(","))
    if unknown := kinds - set(_KINDS):
        raise click.UsageError(f"no kind '{min(unknown)}'; there are: {', '.join(_KINDS)}")
    return kinds


def _transfers(packets: Iterator[Packet]) -> Iterator[CaptureMessage]:
    for packet in packets:
        meaning = f"{len(packet.data)} bytes"
        yield CaptureMessage(packet.time_s, packet.direction, packet.data, "transfer", meaning)


def _print(found: Iterator[CaptureMessage], as_json: bool) -> int:
    """Print the messages. Return how many there were."""
    count = 0
    coloured = colours(sys.stdout) and not as_json
    start_s: float | None = None
    for message in found:
        start_s = message.time_s if start_s is None else start_s
        since_s = message.time_s - start_s
        count += 1
        if as_json:
            print_json(
                {
                    "time_s": round(since_s, 9),
                    "direction": message.direction,
                    "kind": message.kind,
                    "text": message.text,
                    "meaning": message.meaning,
                },
                indent=None,
            )
            continue
        line = f"{since_s:12.6f} {_ARROWS[message.direction]} {message.text:<24}  {message.meaning}"
        colour = _COLOURS.get(message.kind, "") if coloured else ""
        click.echo(f"{colour}{line}\x1b[0m" if colour else line)
    return count


def _rewrite(found: Iterator[CaptureMessage], path: str, *, force: bool) -> None:
    count = 0
    with PcapngWriter(path, force=force) as writer:
        for message in found:
            writer.write(Packet(message.time_s, message.direction, message.data, message.meaning))
            count += 1
    click.echo(f"{path}: {count} messages")
