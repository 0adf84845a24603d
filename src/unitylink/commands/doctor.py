# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink doctor`: what keeps a user from a board, and the command that mends it."""

from __future__ import annotations

import sys
from dataclasses import asdict
from typing import TYPE_CHECKING

import click

from unitylink.connection.schemes import scheme_of

from .failure import Failure
from .link_option import link_argument, load_names, spec_option
from .output import colours, json_option, print_json

if TYPE_CHECKING:
    from unitylink.ports import Machine, SerialPort

_MARKS = {"error": ("✗", "\x1b[1;31m"), "warning": ("!", "\x1b[1;33m"), "note": ("i", "\x1b[1;36m")}


@click.command()
@link_argument
@spec_option
@click.option(
    "--install", "installing", is_flag=True, help="Write the udev rule for this board (needs sudo)."
)
@json_option("the findings")
def command(link: str, spec_file: str | None, installing: bool, as_json: bool) -> None:
    """Find what keeps you from the board at LINK. Each finding comes with the command that mends it.

    It looks at the port (permission, other programs, ModemManager, latency timer). Then it looks at the
    answer (silence, noise, another baud rate or checksum). With --spec it checks whether the board fits the
    spec. The exit code is 1 if something keeps the link from working. `unitylink explain CODE` says more
    about a finding.

    \b
    Examples:
      unitylink doctor "serial:/dev/ttyUSB0?baud=3000000"
      unitylink doctor tcp://192.168.1.10:5555 --spec arm.ul
      sudo "$(which unitylink)" doctor serial:/dev/ttyUSB0 --install
    """
    from unitylink.ports import Machine, examine
    from unitylink.ports.udev import RELOAD, install

    if installing:
        machine = Machine()
        click.echo(f"wrote {install(machine, _port_of(machine, link))}\nnow: {RELOAD}")
        return
    if scheme_of(link).virtual:
        raise Failure(
            f"{link} is a virtual board",
            "the doctor is for real ports; `unitylink info` asks a virtual board",
        )
    if scheme_of(link).open is not None:
        raise Failure(
            f"{link} is a robot on a network, not a port",
            "run the doctor where its board is; see `info`, too",
        )
    if not scheme_of(link).stream:
        raise Failure(f"{link} is memory of this machine, not a port", "`unitylink info` looks at it")
    if scheme_of(link).once:
        raise Failure(
            f"{link} can be opened only once, and the doctor opens it several times",
            "`unitylink info` asks it",
        )
    spec = load_names(link, spec_file).spec
    say = (lambda message: None) if as_json else (lambda message: click.echo(f"  {message}", err=True))
    findings = examine(link, spec=spec, say=say)
    healthy = not any(finding.severity == "error" for finding in findings)
    if as_json:
        print_json({"link": link, "healthy": healthy, "findings": [asdict(finding) for finding in findings]})
    else:
        for finding in findings:
            mark, colour = _MARKS[finding.severity]
            bold, off = (colour, "\x1b[0m") if colours(sys.stdout) else ("", "")
            click.echo(f"{bold}{mark} {finding.title}{off} [{finding.code}]\n  {finding.cause}")
            click.echo(f"  mend: {finding.remedy}")
        if findings:
            codes = " ".join(finding.code for finding in findings)
            click.echo(f"more about it: unitylink explain {codes}")
        if healthy:
            click.echo("the board answers, in time and without a fault" if not findings else "the link works")
    click.get_current_context().exit(0 if healthy else 1)


def _port_of(machine: Machine, link: str) -> SerialPort:
    """Return the USB device for which --install writes a rule."""
    from unitylink.ports.ftdi import ftdi_channels

    scheme, _, rest = link.partition(":")
    place = rest.partition("?")[0]
    if scheme == "serial":
        return machine.serial_port(place)
    chips = [one.port for one in ftdi_channels(machine) if place in ("", one.port.serial_number)]
    if scheme != "ftdi":
        raise Failure(f"{link} is no serial port", "--install is for serial:/dev/… and ftdi: links")
    if not chips:
        raise Failure(
            f"no FTDI chip {place} is plugged in".replace("  ", " "), "`unitylink discover` lists them"
        )
    return chips[0]
