# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink discover`: the ports of this machine, and what answers on them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from .output import json_option, print_json, print_table

if TYPE_CHECKING:
    from unitylink.ports import Machine, SerialPort

_BAUD_HZ = 3_000_000
_SAID = {
    "silence": "nothing",
    "garbage": "something else, or a board at another baud rate",
    "echo": "an echo of what is sent to it",
    "busy": "a board that serves another program",
    "refused": "a board that does not report its configuration",
    "checksum": "a board with another checksum",
    "line-errors": "a board that hears another baud rate or parity",
}


@click.command()
@click.option("--ask", is_flag=True, help="Ask on every free port and on the network.")
@click.option(
    "--baud",
    "baud_hz",
    type=click.IntRange(1),
    default=_BAUD_HZ,
    show_default=True,
    metavar="N",
    help="Baud rate of the question.",
)
@click.option(
    "--port",
    type=click.IntRange(1, 65535),
    default=5555,
    show_default=True,
    metavar="N",
    help="UDP port to ask.",
)
@click.option(
    "--broadcast", default="255.255.255.255", show_default=True, metavar="ADDRESS", help="Broadcast address."
)
@json_option("the ports")
def command(*, ask: bool, baud_hz: int, port: int, broadcast: str, as_json: bool) -> None:
    """List serial ports, with their kind and the program that holds them.

    With --ask, list what answers there.

    Without --ask no port is opened and no byte is sent. A motor controller on an unknown port may act on a
    byte, and some boards reset when their port is opened. --ask sends one harmless request (RLC) to each free
    serial port, at --baud, and as a broadcast over UDP. TCP has no broadcast:
    `unitylink doctor tcp://HOST:PORT` asks one host.

    \b
    Examples:
      unitylink discover
      unitylink discover --ask --baud 1000000
      unitylink discover --ask --json
    """
    from unitylink.ports import Machine
    from unitylink.ports.ftdi import ftdi_channels
    from unitylink.ports.network import broadcast as ask_everybody

    machine = Machine()
    chips = [(one.url, one.port.device or None) for one in ftdi_channels(machine)]
    spi = [f"spi:{device}" for device in machine.spi_ports()]
    entries = [_entry(machine, found, baud_hz if ask else None) for found in machine.serial_ports()]
    if ask:
        for url, answer in ask_everybody(port=port, address=broadcast):
            said = answer.decode("ascii", "replace").strip()
            entries.append({"link": url, "device": None, "identity": "", "holders": [], "answers": said})
    if as_json:
        by_chip = [{"link": url, "device": device} for url, device in chips]
        print_json({"ports": entries, "ftdi": by_chip, "spi": [{"link": link} for link in spi]})
        return
    if spi:
        click.echo(f"SPI ports, which are not asked: {', '.join(spi)}")
    if not entries:
        more = ", and no board answers on the network" if ask else "; --ask looks for boards on the network"
        click.echo("no serial ports" + more)
        return
    rows = [(e["link"], e["identity"], _held(e), _answer(e, ask)) for e in entries]
    print_table(("link", "what it is", "held by", "answers"), rows)
    if chips:
        shown = ", ".join(f"{url} ({device or 'no serial port'})" for url, device in chips)
        click.echo(f"FTDI chips, without the kernel's serial driver: {shown}")
    if not ask:
        click.echo(
            "`unitylink discover --ask` asks each free port, and the network, for a board; "
            "`unitylink doctor LINK` looks closer"
        )


def _entry(machine: Machine, port: SerialPort, baud_hz: int | None) -> dict[str, Any]:
    holders = [f"{holder.command} ({holder.pid})" for holder in machine.holders(port.device)]
    link = f"serial:{port.device}" + (f"?baud={baud_hz}" if baud_hz else "")
    answers = None
    if baud_hz is not None and not holders:
        answers = _ask(link) if machine.may_open(port.device) else "no permission"
    return {
        "link": link,
        "device": port.device,
        "identity": port.identity or "no USB device",
        "vendor_id": port.vendor_id,
        "product_id": port.product_id,
        "serial_number": port.serial_number,
        "channel": port.channel,
        "driver": port.driver,
        "latency_timer_ms": port.latency_timer_ms,
        "holders": holders,
        "answers": answers,
    }


def _ask(link: str) -> str:
    from unitylink.errors import LinkError
    from unitylink.layer0_driver import Driver
    from unitylink.ports import probe

    try:
        with Driver(link) as driver:
            answer = probe(driver)
    except LinkError as error:  # the port is gone, or another program took it, since it was listed
        return error.message
    return f"a board: {answer.fields}" if answer.kind == "configuration" else answer.kind


def _answer(entry: dict[str, Any], asked: bool) -> str:
    if not asked:
        return "not asked"
    return _SAID.get(entry["answers"], entry["answers"] or "not asked: the port is held")


def _held(entry: dict[str, Any]) -> str:
    return ", ".join(entry["holders"])
