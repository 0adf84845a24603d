# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink budget`: the cost of a spec's publishes on the line."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

import click

from unitylink.protocol import CLOCK_HZ_DEFAULT, GROUP_SIZE_2012, GROUPS_2012
from unitylink.spec import load
from unitylink.spec.isochrony.budget import DeviceBudget, budget
from unitylink.spec.isochrony.latency import BITS_PER_BYTE
from unitylink.spec.isochrony.ring import RingBudget, ring_budgets

from .output import json_option, print_fields, print_json, print_table, shown_time
from .ring_output import print_ring


@click.command()
@click.argument("spec_file", metavar="SPEC")
@click.option("--baud", "baud_hz", type=click.IntRange(1), metavar="N", help="Baud rate of the line.")
@click.option(
    "--protocol",
    type=click.Choice(("framed", "classic")),
    default="framed",
    help="Protocol of the link: framed (the default), classic.",
)
@click.option(
    "--clock-hz",
    type=click.IntRange(1),
    default=CLOCK_HZ_DEFAULT,
    metavar="N",
    help="Clock of the design (50000000).",
)
@click.option(
    "--crc", "checked", is_flag=True, help="Count publishes with a checksum, with --protocol classic."
)
@click.option(
    "--read-many",
    type=click.IntRange(1, 255),
    metavar="N",
    help="Most words of a request that may delay a publish (255).",
)
@click.option(
    "--engine",
    type=click.Choice(["fast", "small"]),
    help="Engine of the framed protocol, if not that of the spec (fast).",
)
@json_option("the budget")
def command(
    spec_file: str,
    *,
    baud_hz: int | None,
    protocol: str,
    clock_hz: int,
    checked: bool,
    read_many: int | None,
    engine: str | None,
    as_json: bool,
) -> int:
    """Show the cost of the publishes of SPEC: bytes, load, highest rates, worst delays.

    The exit code is 1 if the line (--baud, or the BAUD of the link) cannot carry them.

    \b
    Examples:
      unitylink budget arm.ul
      unitylink budget arm.ul --baud 3000000
      unitylink budget arm.ul --baud 1000000 --clock-hz 12000000 --engine small
      unitylink budget arm.ul --baud 921600 --protocol classic --crc --json
    """
    if checked and protocol == "framed":
        raise click.UsageError("--crc: frames always have their check; it is of --protocol classic")
    spec = load(spec_file)
    budgets = [
        budget(
            device,
            protocol=protocol,
            clock_hz=clock_hz,
            baud_hz=baud_hz,
            checked=checked,
            read_many=read_many,
            engine=engine,
        )
        for device in spec.devices
    ]
    rings = [
        ring_budgets(spec.root(device.root), device, one)
        for device, one in zip(spec.devices, budgets, strict=True)
    ]
    if as_json:
        reports = [_report(one, of) for one, of in zip(budgets, rings, strict=True)]
        print_json({"spec": spec.name, "hash": spec.hash, "devices": reports})
    else:
        for number, one in enumerate(budgets):
            if number:
                click.echo()
            _show(one)
            for ring in rings[number]:
                click.echo()
                print_ring(ring)
    full = [one for one in budgets if one.load is not None and one.load > 1]
    for one in full:
        click.echo(
            f"error: {one.root}: the publishes need {one.bytes_per_s * BITS_PER_BYTE:,.0f} baud, "
            f"the line has {one.baud_hz:,}; publish slower, publish less, or raise the baud rate",
            err=True,
        )
    return 1 if full else 0


def _report(one: DeviceBudget, rings: list[RingBudget]) -> dict[str, Any]:
    return {
        **asdict(one),
        "tick_bytes": one.tick_bytes,
        "bytes_per_s": one.bytes_per_s,
        "load": one.load,
        "fits_2012": one.fits_2012,
        "rings": [asdict(ring) for ring in rings],
    }


def _show(one: DeviceBudget) -> None:
    line = f"{one.baud_hz:,} baud" if one.baud_hz else "no baud rate given (--baud N)"
    gateware = f"{one.protocol}, {one.data_bits} data bits, base rate {one.base_hz:,} Hz"
    fields = [("link", f"{one.link}, {gateware}, {line}")]
    if not one.groups:
        print_fields([*fields, ("publishes", "none")], title=one.root)
        return
    fields += [
        ("bytes", f"{one.tick_bytes:,} at a tick with all groups due, {one.bytes_per_s:,.0f} a second"),
        *([("load", f"{one.load:.1%} of the line")] if one.load is not None else []),
        *([("2012 gateware", _fit(one))] if one.protocol == "classic" else []),
    ]
    if one.baud_hz:
        longest = f"requests of up to {one.read_many} words (--read-many)"
        fields.append(("in the way", f"{longest}, at {one.clock_hz / 1e6:g} MHz (--clock-hz)"))
    print_fields(fields, title=one.root)
    click.echo()
    rows = [
        (
            str(group.number),
            group.name,
            str(len(group.paths)),
            str(group.words),
            str(group.message_bytes),
            f"{group.bytes_per_s:,.0f}" if group.rate_hz else "each event",
            _time(group.sampled_s, one),
            _time(group.latency_s, one),
        )
        for group in one.groups
    ]
    titles = ("group", "when", "values", "words", "bytes", "bytes/s", "sampled within", "sent within")
    print_table(titles, rows, right=[0, 2, 3, 4, 5, 6, 7])
    if one.bytes_per_s:
        click.echo()
        lines = [
            (
                f"{baud.baud_hz:,}",
                f"{baud.load:.1%}",
                f"{baud.highest_hz:,.4g} Hz" if baud.highest_hz else "-",
            )
            for baud in one.bauds
        ]
        print_table(("baud", "load", "highest rate of all groups"), lines, right=[0, 1, 2])


def _fit(one: DeviceBudget) -> str:
    room = "enough" if one.fits_2012 else "too little, groups are divided or refused"
    return f"has {GROUPS_2012} groups of {GROUP_SIZE_2012 - 1} usable words: {room}"


def _time(latency_s: float | None, one: DeviceBudget) -> str:
    if latency_s is None:
        return "over a period" if one.baud_hz else ""
    return shown_time(latency_s)
